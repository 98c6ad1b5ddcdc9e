"""The thread on its page."""

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.datasheet.building import usual_sheet
from reports.mechanism.thread_section import feed_chart, thread_section


@pytest.mark.parametrize("name", ["fork-takeup", "slotted-takeup"])
def test_feed_and_contour_are_those_of_the_summary_and_eyes_turn_where_it_says(name):
    shown = usual_sheet(load(name))
    thread, told = shown.thread, shown.facts["thread"]
    feed, length = feed_chart(shown, thread, wide=False).panels
    assert np.ptp(feed.curves[0].y) == pytest.approx(1e3 * told["feed"]["total"], rel=1e-3)
    assert np.min(length.curves[0].y) == pytest.approx(1e3 * told["contour"]["min"], rel=1e-3)
    ends = [eye[end] for eye in told["eyes"].values() for end in ("top", "bottom")]
    assert sorted(mark.place for mark in feed.marks) == pytest.approx(sorted(ends))


def test_a_thread_out_of_the_plane_is_drawn_in_space_too():
    shown = usual_sheet(load("fork-takeup"))
    (figures,) = thread_section(shown, shown.thread).parts
    assert [one.name for one in figures.figures] == ["contour", "contour-in-space", "feed"]
