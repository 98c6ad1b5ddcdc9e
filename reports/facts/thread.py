"""What there is to say of a thread: its total feed, its contour, where its eyes turn round."""

from __future__ import annotations

import math

from analytic.description.thread_path import EyeReference, ThreadPath
from analytic.turn.thread_feed import EyeTravel, FeedDiagram, eye_travel, feed_diagram
from reports.facts.views import View
from reports.text.numbers import figure

MM = 1e3


def thread_of(view: View) -> ThreadPath:
    """The linkage's thread, which it must have."""
    thread = view.linkage.thread
    assert thread is not None, "a linkage without a thread has no such part"
    return thread


def diagram(view: View) -> FeedDiagram:
    """The feed diagram in steps fit for drawing and to the last digit in its extremes."""
    return feed_diagram(view.mechanism, thread_of(view))


def travels(view: View) -> dict[str, EyeTravel]:
    """Where eyes turn round, by point: the eye the feed is counted from, else every eye of its own path."""
    thread = thread_of(view)
    if isinstance(thread.reference, EyeReference):
        names = [thread.reference.eye]
    else:
        names = list(dict.fromkeys(eye.point for eye in thread.eyes))
    return {name: eye_travel(view.mechanism, name) for name in names}


def lead(view: View) -> str:
    """The thread in words."""
    found, thread = diagram(view), thread_of(view)
    counted = "a shortening contour gives thread" if thread.feed == "shortening" else "a lengthening contour counts"
    eyes = "; ".join(
        f"eye {name} is highest at φ_top = {math.degrees(one.top_angle):.2f}° and lowest at φ_bottom = "
        f"{math.degrees(one.bottom_angle):.2f}°"
        for name, one in travels(view).items()
    )
    ends = found.length_extremes
    return (
        f"The total feed is {figure(found.total_feed * MM)} mm a turn: the contour is between "
        f"{figure(ends.minimum * MM)} mm long at {math.degrees(ends.minimum_angle):.2f}° and "
        f"{figure(ends.maximum * MM)} mm at {math.degrees(ends.maximum_angle):.2f}°. Pd counts from φ_ref = "
        f"{math.degrees(found.reference_angle):.2f}°, where it is the stretch of {thread.stretch * MM:g} mm; "
        f"{counted}; {eyes}."
    )
