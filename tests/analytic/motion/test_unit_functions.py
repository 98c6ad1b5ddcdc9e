"""Unit functions and dead centres: article 003's deviations, and motions whose dead centres are known."""

import numpy as np
import pytest

from analytic.errors import LinkproofError
from analytic.motion import unit_functions
from tests.analytic.linkages import IN_LINE, from_text, mechanism, text_of
from tests.analytic.tolerances import EPS, FEW_ROUNDINGS, FOUR_DIGITS

# Mean absolute deviations of S, v and a from harmonics, per cent: the specification's closed form.
DEVIATIONS = {"juki-mf7923d": (3.611, 9.053, 18.506), "rimoldi-164": (2.059, 5.870, 12.760)}


@pytest.mark.parametrize("name", DEVIATIONS)
@pytest.mark.parametrize("clockwise", [False, True])
def test_deviations_of_the_needle_mechanisms(name, clockwise):
    result = unit_functions.unit_functions(mechanism(name), clockwise=clockwise).deviations
    assert result == pytest.approx([percent / 100.0 for percent in DEVIATIONS[name]], rel=FOUR_DIGITS)


def test_unit_functions_stay_in_their_range_and_displacement_grows_away_from_top_dead_centre():
    functions = unit_functions.unit_functions(mechanism("rimoldi-164"))
    assert functions.displacement[0] == 0.0
    assert functions.displacement.min() >= -EPS
    assert functions.displacement.max() == pytest.approx(1.0, abs=1e-6)  # within half a grid step of the dead centre
    for curve in (functions.velocity, functions.acceleration):
        assert 1.0 - 1e-6 < np.max(np.abs(curve)) <= 1.0 + FEW_ROUNDINGS
    juki = unit_functions.unit_functions(mechanism("juki-mf7923d"))
    rising = juki.phase < np.pi
    assert np.all(juki.velocity[rising & (juki.phase > 0.0)] > 0.0)
    assert np.all(np.diff(juki.displacement[rising]) > 0.0)


def test_a_scotch_yoke_is_its_own_harmonic():
    functions = unit_functions.unit_functions(mechanism("scotch-yoke"))
    assert functions.deviations == pytest.approx([0.0, 0.0, 0.0], abs=FEW_ROUNDINGS)


def test_dead_centres_of_the_juki_needle_bar_and_its_stroke():
    sample = mechanism("juki-mf7923d")
    top, bottom = unit_functions.top_dead_centre(sample), unit_functions.bottom_dead_centre(sample)
    assert (top.angle, bottom.angle) == pytest.approx((0.5 * np.pi, 1.5 * np.pi), rel=4 * EPS)
    assert (top.coordinate, bottom.coordinate) == pytest.approx((-0.039, -0.070), rel=4 * EPS)
    assert unit_functions.stroke(sample) == pytest.approx(0.031, rel=4 * EPS)


def test_dead_centres_of_an_offset_slider_crank_lie_off_the_grid():
    # Crank and rod in one line: from the pivot the slider's pin is rod ± crank away, at the height of the offset.
    offset, crank, rod = 0.007, 0.02, 0.06
    text = IN_LINE.replace("A = [0.03, 0]", f"A = [{crank}, 0]").replace("B = [0.11, 0]", f"B = [{rod}, 0]")
    text = text.replace("through = [0, 0]", f"through = [0, {offset}]").replace(
        "B = [0.14, 0]", f"B = [0.08, {offset}]"
    )
    top, bottom = unit_functions.top_dead_centre(from_text(text)), unit_functions.bottom_dead_centre(from_text(text))
    assert top.angle == pytest.approx(np.arcsin(offset / (rod + crank)), rel=8 * EPS)
    assert top.coordinate == pytest.approx(np.sqrt((rod + crank) ** 2 - offset**2), rel=4 * EPS)
    assert bottom.angle == pytest.approx(np.pi + np.arcsin(offset / (rod - crank)), rel=8 * EPS)
    assert bottom.coordinate == pytest.approx(np.sqrt((rod - crank) ** 2 - offset**2), rel=4 * EPS)


def test_an_output_that_is_missing_or_does_not_move_is_refused():
    text = text_of("scotch-yoke").replace('output  = { point = "Y" }', "")
    with pytest.raises(LinkproofError, match="names no output"):
        unit_functions.unit_functions(from_text(text))
    text = text_of("scotch-yoke").replace('{ point = "Y" }', '{ point = "Y", along = [0, 1] }')
    with pytest.raises(LinkproofError, match=r"expected a point that moves along its direction, got 'Y'"):
        unit_functions.dead_centres(from_text(text))
