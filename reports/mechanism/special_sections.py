"""Sections of a mechanism's page that some linkages have: the thread, and released cranks."""

from __future__ import annotations

from functools import partial

import numpy as np

from analytic.description.crank_motion import RPM
from comparisons.datasheet.sheet import Positions, Released, Sheet, ThreadSheet
from reports.charts import thread as drawings
from reports.document.chart import Chart, Curve, Mark, Panel
from reports.document.parts import Bullets, FigureGroup, PageFigure, Part, Section
from reports.document.templates import lines
from reports.mechanism.shown import page_figure
from reports.records.views import anchor


def thread_section(sheet: Sheet, thread: ThreadSheet, positions: Positions) -> Section:
    """The contour in the plane and in space, and what the thread feeds over a turn."""
    linkage = sheet.linkage
    angle = f"{np.degrees(thread.reference_angle) % 360.0:.2f}°"
    is_spatial = drawings.is_spatial(thread)
    caption = f"Contour at φ_ref = {angle}, where the feed counts from; rings are guides, dashed lines paths of eyes."
    drawing = partial(drawings.plane_figure, linkage, positions, thread)
    figures = [page_figure(sheet, "contour", caption, "the thread's contour with the linkage", drawing)]
    if is_spatial:
        caption = "The contour in space: z runs along the main shaft and is drawn to a larger scale."
        drawing = partial(drawings.space_figure, linkage, positions, thread)
        figures.append(page_figure(sheet, "contour-in-space", caption, "the thread in space", drawing))
    caption = "Feed Pd, and beneath it the length of the contour; uprights mark where an eye turns round."
    chart = feed_chart(sheet, thread, wide=is_spatial)
    figures.append(page_figure(sheet, "feed", caption, "thread feed and contour length", chart))
    return Section("thread", "Thread", (FigureGroup(tuple(figures)),))


def feed_chart(sheet: Sheet, thread: ThreadSheet, *, wide: bool) -> Chart:
    """Feed above, contour below, over a turn from 0° to 360°."""
    unit = sheet.own("m")
    degrees = np.degrees(thread.angle)
    eyes = sheet.facts.get("thread", {}).get("eyes", {})
    several = len(eyes) > 1
    uprights = [
        Mark(eyes[name][word] % 360.0, "x", f"{word} {name}" if several else word, number)
        for number, name in enumerate(eyes)
        for word in ("top", "bottom")
    ]
    plain = tuple(Mark(mark.place, "x", "", mark.ink) for mark in uprights)
    feed, length = (Curve(degrees, values / unit.size, ink=1) for values in (thread.feed, thread.length))
    panels = (
        Panel((feed,), "", f"Pd, {unit.on_page}", tuple(uprights), turn=True),
        Panel((length,), "crank angle φ, °", f"contour L, {unit.on_page}", plain, turn=True),
    )
    return Chart(panels, 3.6, wide=wide, axis="phi" if sheet.is_turn else "")


def released_section(sheet: Sheet) -> Section:
    """Where a released crank rests, how it settles and its speed, regime by regime of the linkage's own."""
    parts: list[Part] = []
    for regime, motion in sheet.released.items():
        figures = (_speed(sheet, regime, motion), *_last_turn(sheet, regime, motion))
        parts.append(
            Section(anchor("released", regime), regime, (Bullets(tuple(sentences(motion))), FigureGroup(figures)))
        )
    return Section("released", "Released crank", tuple(parts))


def sentences(motion: Released) -> list[str]:
    """Sentences about a released crank, in this order: rest, rotation, own error, the articles' integrator."""
    return lines("released_sheet", one=motion.facts, rpm=RPM)


def _speed(sheet: Sheet, regime: str, motion: Released) -> PageFigure:
    """The crank's speed over time."""
    curve = Curve(motion.motion["time"], motion.motion["omega"] / RPM)
    chart = Chart((Panel((curve,), "time, s", "n, rpm"),), 2.8)
    words = f"Crank speed under {regime}."
    return page_figure(sheet, anchor("released", regime), words, words, chart)


def _last_turn(sheet: Sheet, regime: str, motion: Released) -> tuple[PageFigure, ...]:
    """Speed and acceleration over the last whole turn, where the crank ends in one."""
    if not motion.last_turn:
        return ()
    degrees = np.degrees(motion.last_turn["phi"])
    speed, acceleration = motion.last_turn["omega"] / RPM, motion.last_turn["epsilon"]
    panels = (
        Panel((Curve(degrees, speed),), "", "n, rpm", turn=True),
        Panel((Curve(degrees, acceleration, ink=1),), "crank angle φ, °", "ε, rad/s²", turn=True),
    )
    caption = f"Its last turn, which ends at φ = {np.degrees(motion.facts['end']):.1f}°."
    name = anchor("released", regime, "last-turn")
    return (page_figure(sheet, name, caption, f"last turn under {regime}", Chart(panels, 2.8)),)
