"""The thread and released cranks on their pages."""

from dataclasses import replace

import numpy as np
import pytest

from analytic.description.loading import load, parse
from comparisons.datasheet.building import usual_sheet
from reports.charts.scheme import THREAD, thread_figure
from reports.mechanism.page import released_section, thread_section
from tests.reports.designs.samples import released_sheet

REQUIRED = "[[0, 7.0], [60, 40.0], [-60, 14.0]]"


@pytest.fixture(scope="module")
def fed():
    text = load("slotted-takeup").text.replace("[thread]", f"[thread]\nrequired = {REQUIRED}")
    return usual_sheet(parse(text, "slotted-takeup", "slotted-takeup.toml"))


def test_the_section_of_a_thread_has_its_contour_feed_and_tables(fed):
    section = thread_section(fed, fed.thread, fed.positions)
    pictures, table, required = section.parts
    curve, points = pictures.figures[1].drawing.panels[0].curves
    assert points.x.tolist() == pytest.approx([0.0, 60.0, 300.0])
    assert points.y.tolist() == pytest.approx([7.0, 40.0, 14.0])
    assert np.ptp(curve.y) == pytest.approx(50.469, abs=1e-3)
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["range of the feed"][0] == "50.47"
    assert [rows[what][-1] for what in ("P7 highest", "P7 lowest")] == ["117.97", "352.35"]
    assert rows["farthest from required"] == ("-3.593", "–", "60.00")
    assert required.rows[1] == ("60.00", "40.00", "36.41", "-3.593")


def test_the_picture_of_a_thread_passes_through_its_stops(fed):
    (axes,) = thread_figure(fed.linkage, fed.positions, fed.thread).axes
    line = next(line for line in axes.lines if line.get_color() == THREAD)
    np.testing.assert_allclose(line.get_xydata(), 1e3 * fed.thread.contour)
    assert {"NN1", "P7", "NN2"} <= {text.get_text() for text in axes.texts}


@pytest.fixture(scope="module")
def driven():
    return released_sheet()


def test_a_regime_is_told_in_sentences_and_shown_to_its_last_turn(driven):
    found = released_section(driven)
    (regime,) = found.parts
    sentences_of, figures = regime.parts
    assert "energy and work balance" in sentences_of.items[-1]
    assert [one.name for one in figures.figures] == ["released-driven", "released-driven-last-turn"]


def test_what_a_motion_lacks_has_no_sentence(driven):
    one = driven.released["driven"]
    nothing = {"rests": [], "ending": None, "settled": None, "error_bound": None}

    def words(**changes):
        bare = replace(one, facts={**one.facts, **nothing, **changes})
        (regime,) = released_section(replace(driven, released={"driven": bare})).parts
        return regime.parts[0].items

    (line,) = words()
    assert line.endswith("the crank can rest at no angle.")
    assert "changes with time" in words(over="time")[0]
