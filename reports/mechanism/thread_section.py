"""The thread on a mechanism's page: its contour in the plane and in space, and what it feeds over a turn."""

from __future__ import annotations

from functools import partial

import numpy as np

from comparisons.datasheet.sheet import ThreadSheet
from reports.charts import thread as drawings
from reports.document.chart import Chart, Curve, Mark, Panel
from reports.document.parts import FigureGroup, Section
from reports.mechanism.shown import ShownSheet


def thread_section(shown: ShownSheet, thread: ThreadSheet) -> Section:
    """Contour and feed."""
    linkage, positions = shown.sheet.linkage, shown.sheet.positions
    angle = f"{np.degrees(thread.reference_angle) % 360.0:.2f}°"
    figures = []
    is_spatial = positions is not None and drawings.is_spatial(thread)
    if positions is not None:
        caption = (
            f"Contour at φ_ref = {angle}, where the feed counts from; rings are guides, dashed lines paths of eyes."
        )
        drawing = partial(drawings.plane_figure, linkage, positions, thread)
        figures.append(shown.figure("contour", caption, "the thread's contour with the linkage", drawing))
    if positions is not None and is_spatial:
        caption = "The contour in space: z runs along the main shaft and is drawn to a larger scale."
        drawing = partial(drawings.space_figure, linkage, positions, thread)
        figures.append(shown.figure("contour-in-space", caption, "the thread in space", drawing))
    caption = "Feed Pd, and beneath it the length of the contour; uprights mark where an eye turns round."
    chart = feed_chart(shown, thread, wide=is_spatial)
    figures.append(shown.figure("feed", caption, "thread feed and contour length", chart))
    return Section("thread", "Thread", (FigureGroup(tuple(figures)),))


def feed_chart(shown: ShownSheet, thread: ThreadSheet, *, wide: bool) -> Chart:
    """Feed above, contour below, over a turn from 0° to 360°."""
    unit = shown.own("m")
    degrees = np.degrees(thread.angle)
    several = len(thread.eyes) > 1
    uprights = [
        Mark(float(np.degrees(angle)) % 360.0, "x", f"{word} {name}" if several else word, number)
        for number, (name, eye) in enumerate(thread.eyes.items())
        for word, angle in (("top", eye["top_angle"]), ("bottom", eye["bottom_angle"]))
        if angle is not None
    ]
    plain = tuple(Mark(mark.place, "x", "", mark.ink) for mark in uprights)
    feed, length = (Curve(degrees, values / unit.size, ink=1) for values in (thread.feed, thread.length))
    panels = (
        Panel((feed,), "", f"Pd, {unit.name}", tuple(uprights), turn=True),
        Panel((length,), "crank angle φ, °", f"contour L, {unit.name}", plain, turn=True),
    )
    return Chart(panels, 3.6, wide=wide, axis="phi" if shown.is_turn else "")
