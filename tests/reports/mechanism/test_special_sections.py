"""The thread and released cranks on their pages."""

from dataclasses import replace

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.datasheet.building import usual_sheet
from reports.mechanism.page import feed_chart, released_section
from tests.reports.designs.samples import released_sheet


@pytest.mark.parametrize("name", ["fork-takeup", "slotted-takeup"])
def test_feed_and_contour_are_those_of_the_summary_and_eyes_turn_where_it_says(name):
    shown = usual_sheet(load(name))
    thread, told = shown.thread, shown.facts["thread"]
    feed, length = feed_chart(shown, thread, wide=False).panels
    assert np.ptp(feed.curves[0].y) == pytest.approx(1e3 * told["feed"]["total"], rel=1e-3)
    assert np.min(length.curves[0].y) == pytest.approx(1e3 * told["contour"]["min"], rel=1e-3)
    ends = [eye[end] for eye in told["eyes"].values() for end in ("top", "bottom")]
    assert sorted(mark.place for mark in feed.marks) == pytest.approx(sorted(ends))


@pytest.fixture(scope="module")
def driven():
    return released_sheet()


def test_a_regime_is_told_in_sentences_and_shown_to_its_last_turn(driven):
    found = released_section(driven)
    (regime,) = found.parts
    sentences_of, figures = regime.parts
    assert "Runge-Kutta steps" in sentences_of.items[-1]
    assert [one.name for one in figures.figures] == ["released-driven", "released-driven-last-turn"]


def test_what_a_motion_lacks_has_no_sentence(driven):
    one = driven.released["driven"]
    nothing = {"rests": [], "ending": None, "settled": None, "coarse": None, "error_bound": None}

    def words(**changes):
        bare = replace(one, facts={**one.facts, **nothing, **changes})
        (regime,) = released_section(replace(driven, released={"driven": bare})).parts
        return regime.parts[0].items

    (line,) = words()
    assert line.endswith("the crank can rest at no angle.")
    assert "changes with time" in words(over="time")[0]
