"""The page of one mechanism: what its designer wants, then how the engines did."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from analytic.description.crank_motion import RPM
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from comparisons.designer.sheet import Positions, Released, Sheet, ThreadSheet
from comparisons.trials.campaign.results import CampaignResults
from reports.charts import draw
from reports.charts.draw import PALETTE, WIDTH, Array, drawn
from reports.charts.scheme import thread_figure
from reports.document.parts import (
    Bullets,
    Card,
    Cards,
    FigureGroup,
    Page,
    PageFigure,
    Paragraph,
    Part,
    Section,
)
from reports.document.templates import lines, sentence
from reports.live import live_widget, model_of
from reports.mechanism import designer
from reports.mechanism.designer import finish, page_figure
from reports.mechanism.engines import engines_section, errors_chart, is_imported
from reports.mechanism.published import published_section
from reports.mechanism.shown import figures_table, key_table, open_end_note, required_table
from reports.records import View, anchor, views

# Sections of a mechanism's page that some linkages have: the thread, and released cranks.


def thread_section(sheet: Sheet, thread: ThreadSheet, positions: Positions) -> Section:
    """The section on the thread: its contour in the plane, its feed, and the required feed, if there is one."""
    angle = f"{np.degrees(thread.reference_angle) % 360.0:.2f}°"
    caption = f"Contour at φ_ref = {angle}, where the feed counts from; rings are guides, dashed lines paths of eyes."
    drawing = partial(thread_figure, sheet.linkage, positions, thread)
    contour = page_figure(sheet, "contour", caption, "the thread's contour with the linkage", drawing)
    feed = partial(drawn, WIDTH, 3.2, partial(_plot_feed, sheet))
    figures = FigureGroup((contour, page_figure(sheet, "feed", "Feed Pd of the thread.", "thread feed", feed)))
    tables = [figures_table(sheet, "thread"), *([required_table(sheet)] if sheet.required else [])]
    return Section("thread", "Thread", (figures, *tables))


def _plot_feed(sheet: Sheet, figure: Figure) -> None:
    """Draw the thread's feed over the motion into a figure.

    The required feed is drawn too, as dots, if the file has it and φ is the axis.
    """
    unit, axes = sheet.file_unit_of("m"), figure.subplots()
    axes.plot(sheet.x, sheet.y("thread_feed"), color=PALETTE[1], label="feed")
    if sheet.required and sheet.axis == "phi":
        along = sheet.required["phi"] % FULL_TURN if sheet.is_turn else sheet.required["phi"]
        axes.plot(along / sheet.axis_unit.size, sheet.required["required"] / unit.size, "o", label="required")
        axes.legend()
    finish(axes, sheet, f"Pd, {unit.on_page}")


def released_section(sheet: Sheet) -> Section:
    """The section on released regimes, a part each: where the crank can rest, how it settles, figures of its speed."""
    parts: list[Part] = []
    for regime, motion in sheet.released.items():
        figures = tuple(_released_figures(sheet, regime, motion))
        words = Bullets(tuple(lines("released_sheet", one=motion.facts, rpm=RPM)))
        parts.append(Section(anchor("released", regime), regime, (words, FigureGroup(figures))))
    return Section("released", "Released crank", tuple(parts))


def _released_figures(sheet: Sheet, regime: str, motion: Released) -> Iterator[PageFigure]:
    """Yield a figure of the crank's speed over time, and one of the last whole turn, if it makes one.

    That has speed and acceleration over φ. ``regime`` is the name of that of the ``motion``.
    """
    name, words = anchor("released", regime), f"Crank speed under {regime}."
    speed = {"n, rpm": motion.motion["omega"] / RPM}
    drawing = partial(_plot_panels, motion.motion["time"], "time, s", speed)
    yield page_figure(sheet, name, words, words, partial(drawn, WIDTH, 2.8, drawing))
    if turn := motion.last_turn:
        panels = {"n, rpm": turn["omega"] / RPM, "ε, rad/s²": turn["epsilon"]}
        drawing = partial(_plot_panels, np.degrees(turn["phi"]), "crank angle φ, °", panels, turn=True)
        caption = f"Its last turn, which ends at φ = {np.degrees(motion.facts['end']):.1f}°."
        words = f"last turn under {regime}"
        yield page_figure(sheet, f"{name}-last-turn", caption, words, partial(drawn, WIDTH, 2.8, drawing))


def _plot_panels(x: Array, label: str, panels: Mapping[str, Array], figure: Figure, *, turn: bool = False) -> None:
    """Draw values by their labels over the same ``x``, one below the other, into a figure; ``label`` is that of ``x``.

    All values are as shown. ``turn`` is an axis of a turn in degrees.
    """
    column = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    for axes, (y_label, values), colour in zip(column, panels.items(), PALETTE, strict=False):
        axes.plot(x, values, color=colour)
        draw.finish(axes, label if axes is column[-1] else "", y_label, turn=turn)


# The page of one mechanism: what its designer wants, then how the engines did.

FOLDER = "mechanisms"


def file_of(linkage: Sheet | Linkage) -> str:
    """The page's path within a report's folder, mechanisms/NAME.VARIANT.html.

    Signs that an address would quote become dashes.
    """
    name, variant = (re.sub(r"[^\w+-]+", "-", word) for word in (linkage.name, linkage.variant))
    return f"{FOLDER}/{name}.{variant}.html"


def page(sheet: Sheet, results: CampaignResults | None = None) -> Page:
    """The page of a mechanism.

    ``results`` are those of the campaign that its engines ran in, or of a file that was judged; None for neither, or if
    they lack this mechanism, leaves the engines out.
    """
    linkage, view = sheet.linkage, _view(sheet, results)
    of = f" (of {', '.join(linkage.variants)})" if len(linkage.variants) > 1 else ""
    source = f" Source: {linkage.source}." if linkage.source else ""
    return Page(
        file=file_of(sheet),
        title=f"{sheet.name} ({sheet.variant})" if len(linkage.variants) > 1 else sheet.name,
        heading=linkage.title or sheet.name,
        subtitle=f"{sheet.name}, variant {sheet.variant}{of}.{source}",
        parts=(*(_verdict(view) if view else ()), *_first_look(sheet)),
        sections=tuple(_sections(sheet, view)),
        charts=view is not None,
    )


def _view(sheet: Sheet, results: CampaignResults | None) -> View | None:
    """The view of the results on a sheet's linkage; None without one."""
    mine = sheet.name, sheet.variant
    every = views(results) if results else ()
    return next((view for view in every if (view.linkage.name, view.linkage.variant) == mine), None)


def _verdict(view: View) -> Iterator[Part]:
    """Yield of a judged file the verdict and its causes, then the chart of all errors, if there are any."""
    first, *others = view.results.document.get("judgement", [""])
    if first:
        yield from (Paragraph(first, "verdict"), Bullets(tuple(others)))
    if any(map(view.shown_setting, view.regimes)):
        yield errors_chart(view)


def _first_look(sheet: Sheet) -> Iterator[Part]:
    """Yield the parts at the top: the linkage in motion, to pull at where it can be computed, and key figures.

    Without a motion there are the reason and the facts.
    """
    if sheet.positions is None:
        yield Cards((Card("The mechanism", (*designer.sentences(sheet, "values"), designer.facts(sheet))),), wide=True)
        return
    model, table, facts = model_of(sheet), key_table(sheet), designer.facts(sheet)
    yield live_widget(sheet, model, (table,))
    if isinstance(model, str):
        why = Paragraph(sentence("not_live", reason=model), "small")
        yield Cards((Card("Key figures", (table,)), Card("The mechanism", (facts, why))), wide=True)
        return
    note = [Paragraph(f"{open_end_note(sheet)}.", "small")] if sheet.open_end_warning else []
    yield Cards((Card("The mechanism as in its file", (facts, *note)),), wide=True)


def _sections(sheet: Sheet, view: View | None) -> Iterator[Section]:
    """Yield the designer's sections, then the engines'; for a judged file its errors come first."""
    engines = [engines_section(view)] if view else []
    is_judged = view is not None and is_imported(view)
    yield from engines if is_judged else ()
    yield from designer.sections(sheet)
    if sheet.thread and sheet.positions and "thread_feed" in sheet.values:
        yield thread_section(sheet, sheet.thread, sheet.positions)
    if sheet.released:
        yield released_section(sheet)
    if sheet.published:
        yield published_section(sheet.published)
    yield from () if is_judged else engines
