"""The thread on a mechanism's page: its contour in the plane and in space, and what it feeds over a turn."""

from __future__ import annotations

import numpy as np

from comparisons.datasheet.sheet import ThreadSheet
from reports.document.chart import Chart, Curve, Mark, Panel
from reports.document.parts import Figure, Figures, Section
from reports.mechanism.shown import ShownSheet


def thread_section(shown: ShownSheet, thread: ThreadSheet) -> Section:
    """Contour and feed."""
    about = f"{shown.sheet.linkage.title} ({shown.sheet.variant})"
    figures = [
        Figure(
            "feed",
            "Feed Pd, and beneath it the length of the contour; uprights mark where an eye turns round.",
            f"{about}: thread feed and contour length over the crank angle",
            feed_chart(shown, thread),
        ),
    ]
    return Section("thread", "Thread", (Figures(tuple(figures)),))


def feed_chart(shown: ShownSheet, thread: ThreadSheet) -> Chart:
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
    return Chart(panels, 3.6, axis="phi" if shown.is_turn else "")
