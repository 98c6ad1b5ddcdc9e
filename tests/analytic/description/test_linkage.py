"""What a linkage knows of its own size."""

import pytest

from analytic.description.loading import load
from tests.analytic.linkages import from_text, mechanism, text_of


def test_the_shortest_length_is_between_two_points_of_one_moving_link():
    assert mechanism("juki-mf7923d").linkage.shortest_length() == pytest.approx(0.0155)
    assert mechanism("rimoldi-164").linkage.shortest_length() == pytest.approx(0.012)


def test_a_linkage_of_single_points_has_its_drawing_for_a_scale():
    text = text_of("scotch-yoke").replace("points  = { O = [0, 0], A = [20, 0] }", "points = { O = [-20, 0] }")
    text = text.replace('{ point = "A", on = "yoke", through', '{ point = "Y", on = "crank", through')
    text = text.replace("through = [0, 0], along = [0, 1]", "through = [7, 0], along = [0, 1]")
    linkage = from_text(text).linkage
    assert linkage.shortest_length() == linkage.extent() == pytest.approx(0.02)


def test_the_extent_is_the_largest_coordinate():
    assert mechanism("rimoldi-164").linkage.extent() == pytest.approx(0.175)


def test_points_are_looked_up_by_body():
    linkage = mechanism("rimoldi-164").linkage
    assert linkage.local("O2", "ground") == pytest.approx((0.016, 0.175))
    assert linkage.local("O2", "rocker") == (0.0, 0.0)


def test_a_slot_bears_the_name_of_its_pin_and_host():
    assert [slot.name for slot in mechanism("shaper").linkage.slots] == ["A in rocker", "F in rocker"]


def test_lengths_are_written_in_the_units_of_the_file():
    assert load("juki-mf7923d").written(0.0155) == "15.5 mm"
    assert (
        from_text(text_of("spring-and-damper").replace('length = "mm"', 'length = "in"')).linkage.written(0.0254)
        == "1 in"
    )
