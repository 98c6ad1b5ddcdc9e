"""The sections of a mechanism's page for its designer: motion, drive, Jeq, forces, links, published figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Link
from analytic.errors import printable
from comparisons.designer.curves import TIME
from comparisons.designer.sheet import JOINT, ROUNDING, Sheet
from reports.charts import draw
from reports.charts.draw import FULL_WIDTH, PALETTE, Array, Host, drawn, wrap
from reports.charts.scheme import scheme_figure
from reports.charts.symbols import unit as unit_vector
from reports.document.numbers import ABSENT, printed
from reports.document.parts import (
    Bullets,
    Card,
    Cards,
    Facts,
    FigureGroup,
    Fold,
    PageFigure,
    Paragraph,
    Part,
    Section,
    Table,
)
from reports.document.templates import plain, sentence
from reports.mechanism.fact_words import mechanism_words
from reports.mechanism.shown import figures_table, jeq, words

OUTPUT: Final = ("S", "v", "a")
DRIVE: Final = ("Mkr", "Peq", "Teq")
# Before the reason why a part of a sheet is missing, where the part has its place on the page.
WORDS: Final = {"values": "There is no motion to show: "}
TALL: Final = 3.9  # inches, of panels one under the other
MOST_HODOGRAPHS, PER_ROW = 12, 4
CONSTANT: Final = 1e-6  # share of its largest value that a link's Jeq varies by at least, else it is a constant
ACTS: Final = "A joint's force acts on the link named; directions count from x."
DOTS, QUARTERS = 30, 90  # degrees of the crank between dots of a hodograph, and between those that are named


def sections(sheet: Sheet) -> tuple[Section, ...]:
    """The sections of the page that the sheet has data for, in a designer's order: drive, forces, links."""
    every = (_drive_section(sheet), _forces_section(sheet), _links_section(sheet))
    return tuple(section for section in every if section.parts)


def sentences(sheet: Sheet, *keys: str) -> tuple[Part, ...]:
    """Paragraphs, in small print, with the reasons why the parts ``keys`` of the sheet are missing; () if none is."""
    reasons = {key: sheet.missing[key] for key in keys if key in sheet.missing}
    words = {key: f"{WORDS.get(key, f'There is no {key}: ')}{reason}" for key, reason in reasons.items()}
    return tuple(Paragraph(f"{text.removesuffix('.')}.", "small") for text in words.values())


def page_figure(sheet: Sheet, name: str, caption: str, what: str, drawing: Callable[[], Figure]) -> PageFigure:
    """A figure of the page, its file called ``name``; its text without pictures is title, variant and ``what``.

    ``drawing`` is called when the page is written, and returns the figure.
    """
    return PageFigure(name, caption, f"{sheet.linkage.title} ({sheet.variant}): {what}", drawing)


def finish(axes: Axes, sheet: Sheet, y_label: str, *, is_last: bool = True) -> None:
    """Set labels and limits of axes with curves over the sheet's motion.

    ``y_label`` has the quantity and its unit; only the last of a column, ``is_last``, names the axis of the motion.
    """
    name = "time" if sheet.axis == TIME else "travel" if sheet.is_linear else "crank angle φ"
    draw.finish(axes, f"{name}, {sheet.axis_unit.on_page}" if is_last else "", y_label, turn=sheet.is_turn)


def plot_stacked(sheet: Sheet, names: Sequence[str], host: Host) -> list[Axes]:
    """Draw signals, by name, one below the other over the motion into ``host``, each with its peak marked.

    Returns their axes, the uppermost first. Raises KeyError for a signal that the sheet lacks.
    """
    column = [*host.subplots(len(names), sharex=True, squeeze=False)[:, 0]]
    for row, (axes, name) in enumerate(zip(column, names, strict=True)):
        colour, peak, unit = PALETTE[row % len(PALETTE)], sheet.peaks[name], sheet.unit(name)
        axes.plot(sheet.x, sheet.y(name), color=colour)
        at = sheet.place_of(peak)
        if peak.value is not None and at is not None:
            along = (at % FULL_TURN if sheet.is_turn else at) / sheet.axis_unit.size
            axes.plot([along], [peak.value / unit.size], "o", color=colour, clip_on=False)
        label = f"{'force' if name == 'Mkr' and sheet.is_linear else name}, {unit.on_page}"
        finish(axes, sheet, label, is_last=row == len(names) - 1)
    return column


def _drive_section(sheet: Sheet) -> Section:
    """The section on the inertia behind the torque, and on the reasons why there is no output or torque.

    Without parts if there is nothing to say.
    """
    words = [] if sheet.linkage.output else ["The file names no output: there is no S, v and a."]
    if not any(name in sheet.values for name in DRIVE):
        words += ["No link has mass and there are no loads: there is no torque, power or joint force."]
    parts: list[Part] = [Paragraph(text, "small") for text in words]
    if "Jeq" in sheet.facts:
        ends = {end: jeq(sheet, end) for end in ("min", "max", "mean")}
        parts.append(Paragraph(sentence("sheet_inertia", facts=sheet.facts["Jeq"], **ends)))
    figures = _inertia(sheet) if sheet.shares else ()
    return Section("drive", "Drive and inertia", (*parts, *([FigureGroup(figures)] if figures else [])))


def _inertia(sheet: Sheet) -> tuple[PageFigure, ...]:
    """The figure of Jeq by group, stacked, and by link, as the only member; () without inertia."""
    unit = sheet.unit("Jeq")
    groups, links = (
        {name: sheet.sorted_by_axis(values) / unit.size for name, values in sheet.shares.get(kind, {}).items()}
        for kind in ("groups", "links")
    )
    whole = sum((float(np.mean(values)) for values in links.values()), 0.0)
    if not whole:
        return ()
    constant = [plain(name) for name, values in links.items() if float(np.ptp(values)) <= CONSTANT * np.max(values)]
    varying = {name: values for name, values in links.items() if plain(name) not in constant}
    caption = "Share of each group in Jeq (stacked)"
    caption += "; below, each moving link alone" if varying else ""
    caption += f". Constant and not drawn: {', '.join(constant)}" if constant else ""
    caption += ". Per cent are of the mean."

    def place(figure: Figure) -> None:
        """Draw Jeq by group, stacked, and below it that of each link that varies."""
        stacked, *alone = figure.subplots(1 + bool(varying), sharex=True, squeeze=False)[:, 0]
        names = [_share(name, values, whole) for name, values in groups.items()]
        stacked.stackplot(sheet.x, *groups.values(), labels=names, alpha=0.75)
        finish(stacked, sheet, f"Jeq, {unit.on_page}", is_last=not varying)
        for axes in alone:
            for name, values in varying.items():
                axes.plot(sheet.x, values, label=_share(name, values, whole))
            finish(axes, sheet, f"Jeq of a link, {unit.on_page}")
        for axes in (stacked, *alone):
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), reverse=axes is stacked)

    drawing = partial(drawn, FULL_WIDTH, TALL, place)
    return (page_figure(sheet, "inertia", caption, "Jeq by Assur group and by link", drawing),)


def _share(name: str, values: Array, whole: float) -> str:
    """A part's name with its share of the ``whole`` mean, in per cent, as text: "needle bar, 12.3 %"."""
    return f"{plain(name)}, {100.0 * float(np.mean(values)) / whole:.1f} %"


def _forces_section(sheet: Sheet) -> Section:
    """The section on the forces in every joint and on the frame, hodographs and figures.

    Without parts if there are none.
    """
    joints = sheet.joints
    if not joints:
        return Section("forces", "Forces in the joints and on the frame", ())
    table = figures_table(sheet, "forces", plain)
    parts = (
        _hodographs(sheet, joints),
        Fold("Largest force of every joint, in figures", (replace(table, caption=ACTS),)),
    )
    return Section("forces", "Forces in the joints and on the frame", parts)


def _dots_in_words(sheet: Sheet) -> str:
    """The end of a hodograph's caption, on the distance of its dots; "" unless the motion is a full turn."""
    return f": dots are {DOTS}° of the crank apart, quarters named where there is room" if sheet.is_turn else ""


def _hodographs(sheet: Sheet, joints: list[str]) -> PageFigure:
    """The figure of the hodographs of the joints' forces, twelve at most, and of that on the frame.

    ``joints`` are names, those with the largest forces first.
    """
    vectors = [f"{JOINT}{name}" for name in joints[:MOST_HODOGRAPHS]]
    vectors += ["shaking_force"] if "shaking_force:x" in sheet.values else []
    which = f"the {MOST_HODOGRAPHS} joints with the largest forces" if len(joints) > MOST_HODOGRAPHS else "every joint"
    caption = f"Fx against Fy of {which} and on the frame, each to its own scale{_dots_in_words(sheet)}."
    drawing = partial(drawn, FULL_WIDTH, 2.5 * -(-len(vectors) // PER_ROW), partial(plot_hodographs, sheet, vectors))
    return page_figure(sheet, "hodographs", caption, "hodographs of the joint forces", drawing)


def plot_hodographs(sheet: Sheet, vectors: Sequence[str], host: Host) -> None:
    """Draw each vector's Fy over Fx into ``host``, to its own scale; over a turn a dot every 30° and named quarters.

    ``vectors`` are names of signals without component, "joint_force:A". Each is entitled with its name and its peak.
    """
    columns = min(PER_ROW, len(vectors))
    rows = -(-len(vectors) // columns)
    grid = host.subplots(rows, columns, squeeze=False).ravel()
    for n, (axes, vector) in enumerate(zip(grid, vectors, strict=False)):
        unit, colour = sheet.unit(f"{vector}:x").on_page, PALETTE[n % len(PALETTE)]
        force = [sheet.y(f"{vector}:{component}") for component in "xy"]
        axes.plot(*force, color=colour)
        if sheet.is_turn:
            degrees = np.arange(0, 360, DOTS)
            dots = [np.interp(degrees, sheet.x, values, period=360.0) for values in force]
            axes.plot(*dots, "o", color=colour)
            named: list[list[float]] = []
            nearest = 0.15 * np.max(np.ptp(dots, axis=1))  # at which two names would overlap
            for at, *place in zip(degrees, *dots, strict=True):
                if not at % QUARTERS and all(math.dist(place, other) >= nearest for other in named):
                    named.append(place)
                    away = 11.0 * unit_vector(np.array(place) - np.mean(dots, axis=1))  # points
                    axes.annotate(f"{at}°", place, away, textcoords="offset points", ha="center", va="center")
        peak = words(sheet, sheet.peaks[f"{vector}:magnitude"]).replace(" ", "\N{NO-BREAK SPACE}")
        title = f"{printable(plain(vector.partition(':')[2] or vector))}, {peak}"
        axes.set_title(wrap(title, FULL_WIDTH / PER_ROW - 0.6), pad=14.0)  # points, above the names of quarters
        axes.margins(0.15, 0.3)
        axes.locator_params(nbins=4)
        draw.finish(axes, f"Fx, {unit}", f"Fy, {unit}", equal=True)
    for axes in grid[len(vectors) :]:
        axes.remove()


def _links_section(sheet: Sheet) -> Section:
    """The section on the links: a scheme, their data in the file's units, notes, what is missing."""
    linkage = sheet.linkage
    units = [sheet.file_unit_of(si) for si in ("kg", "kg m²", "m")]
    head = ("link", *(f"{word}, {unit.on_page}" for word, unit in zip(("m", "J", "mass centre"), units, strict=True)))
    rows = [_link_row(link, [unit.size for unit in units]) for link in linkage.links.values()]
    note = f"Mass centres in the link's own frame; J about the mass centre, {ABSENT} where the link cannot turn."
    table = Table("The moving links as described.", head, tuple(rows), note=note)
    notes = (Bullets(linkage.notes),) if linkage.notes else ()
    cards = (*_scheme(sheet), Card("Links", (table, *notes)))
    return Section(
        "made-of", "What it is made of", (Cards(cards, wide=True), *sentences(sheet, *(sheet.missing.keys() - WORDS)))
    )


def _scheme(sheet: Sheet) -> tuple[Card, ...]:
    """The card with the linkage drawn to scale in several positions as the only member; () without positions."""
    positions = sheet.positions
    if positions is None:
        return ()
    output = f"; the blue line is the path of {sheet.linkage.output.point}" if sheet.linkage.output else ""
    caption = f"To scale in twelve positions, one of them drawn out; quartered discs are mass centres{output}."
    drawing = partial(scheme_figure, sheet.linkage, positions)
    return (Card("Positions", (page_figure(sheet, "scheme", caption, "kinematic scheme", drawing),)),)


def _link_row(link: Link, sizes: list[float]) -> tuple[str, ...]:
    """The cells of a link as texts: name, mass, inertia and mass centre.

    ``sizes`` are the file's units of mass, inertia and length, SI.
    """
    mass, inertia, length = sizes
    least = ROUNDING * max(map(abs, link.centre))
    places = (0.0 if abs(value) <= least else value / length for value in link.centre)
    centre = ", ".join(f"{place:.4g}".replace("-", "−") for place in places)
    turning = ABSENT if link.inertia is None else printed(link.inertia / inertia)
    return plain(link.name), printed(link.mass / mass), turning, f"({centre})"


def facts(sheet: Sheet) -> Facts:
    """The facts on a mechanism that hold for every motion, in words: structure, range, output, rest."""
    pairs = [(name, words) for name, words in mechanism_words(sheet.facts) if name != "Jeq"]
    structure = sheet.facts.get("structure", "").replace("->", "→").replace("_", " ")
    return Facts((("structure", structure), *pairs))
