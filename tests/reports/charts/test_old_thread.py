"""The thread's part of a section."""

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.turn.thread_feed import contour_length, reference_angle
from reports.campaign.parts import thread_part
from reports.charts import old_thread as thread
from reports.facts import thread as thread_facts
from reports.records.views import views
from tests.reports.made_up_results import made_up_results


def view_of(name):
    return views(made_up_results([load(name)], samples=21, quantities=("Jeq",)))[0]


@pytest.fixture(scope="module")
def flat():
    return view_of("slotted-takeup")


@pytest.fixture(scope="module")
def spatial():
    return view_of("fork-takeup")


def test_total_feed_and_turning_points_are_told(flat):
    text = thread_facts.lead(flat)
    assert "total feed is 50.47 mm" in text
    assert "φ_top = 117.97°" in text
    assert "φ_bottom = 352.35°" in text


def test_every_eye_is_told_where_the_feed_counts_from_none(spatial):
    assert list(thread_facts.travels(spatial)) == ["P6", "P5"]


def test_a_contour_out_of_the_plane_is_drawn_in_space(flat, spatial):
    assert not thread.is_spatial(flat)
    assert len(thread_part(flat).figures) == 2
    assert len(thread_part(spatial).figures) == 3
    (axes,) = thread.space_figure(spatial).axes
    assert axes.name == "3d"
    assert [text.get_text().strip() for text in axes.texts] == ["N1", "P6", "P5", "N2"]


def test_the_contour_drawn_is_as_long_as_the_closed_form_says(flat):
    (axes,) = thread.plane_figure(flat).axes
    corners = next(line for line in axes.lines if line.get_color() == thread.THREAD and len(line.get_xdata()) == 3)
    length = np.hypot(np.diff(corners.get_xdata()), np.diff(corners.get_ydata())).sum()
    path = flat.linkage.thread
    truth = contour_length(flat.mechanism.sweep(reference_angle(flat.mechanism, path)), path)
    assert length == pytest.approx(1e3 * float(truth), rel=1e-12)
    assert axes.get_aspect() == 1.0


def test_guides_stand_inside_the_picture(flat):
    (axes,) = thread.plane_figure(flat).axes
    names = [text for text in axes.texts if text.get_text().startswith("NN")]
    assert len(names) == 2
    for text in names:
        x, y = text.get_position()
        assert axes.get_xlim()[0] < x < axes.get_xlim()[1]
        assert axes.get_ylim()[0] < y < axes.get_ylim()[1]


def test_the_feed_closes_over_the_turn_and_its_marks_are_named(flat, spatial):
    upper, lower = thread.feed_figure(flat).axes
    curve = upper.lines[1].get_ydata()
    assert curve[0] == curve[-1]
    assert np.ptp(curve) == pytest.approx(np.ptp(lower.lines[0].get_ydata()))
    assert [text.get_text() for text in upper.texts] == ["φ_top", "φ_bottom"]
    assert "φ_top P5" in [text.get_text() for text in thread.feed_figure(spatial).axes[0].texts]
