"""What there is to say of a thread: its total feed, its contour, where its eyes turn round."""

from __future__ import annotations

from analytic.description.schema import EyeReference
from analytic.description.thread_path import ThreadPath
from analytic.turn.thread_feed import EyeTravel, FeedDiagram, eye_travel, feed_diagram
from reports.document.templates import sentence
from reports.records.views import View

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
    return sentence("thread", path=thread_of(view), diagram=diagram(view), travels=travels(view))
