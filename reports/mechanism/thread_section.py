"""The thread on a mechanism's page: its contour in the plane and in space, and what it feeds over a turn."""

from __future__ import annotations

from functools import partial

import numpy as np

from comparisons.datasheet.sheet import Sheet, ThreadSheet
from reports.charts import thread as drawings
from reports.document.chart import Chart, Curve, Mark, Panel
from reports.document.parts import FigureGroup, Section
from reports.mechanism.shown import page_figure


def thread_section(sheet: Sheet, thread: ThreadSheet) -> Section:
    """Contour and feed."""
    linkage, positions = sheet.linkage, sheet.positions
    angle = f"{np.degrees(thread.reference_angle) % 360.0:.2f}°"
    figures = []
    is_spatial = positions is not None and drawings.is_spatial(thread)
    if positions is not None:
        caption = (
            f"Contour at φ_ref = {angle}, where the feed counts from; rings are guides, dashed lines paths of eyes."
        )
        drawing = partial(drawings.plane_figure, linkage, positions, thread)
        figures.append(page_figure(sheet, "contour", caption, "the thread's contour with the linkage", drawing))
    if positions is not None and is_spatial:
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
