"""Links that do not meet, and positions in which they cannot move: at which angle, which link, by how much."""

import numpy as np
import pytest

from analytic.errors import AssemblyError, LinkproofError
from tests.analytic.linkages import from_text, mechanism, text_of

SHORT_ROD = (
    r"'sample' cannot be assembled at 180°: 'coupler' \(47 mm\) and 'rocker' \(25 mm\) together are 3 mm shorter than "
    r"the gap of 75 mm between 'A' and 'O2'; lengthen one of them, shorten the crank or move the pivots closer together"
)
LONG_ROD = (
    r"'sample' cannot be assembled at 0°: 'coupler' \(90 mm\) and 'rocker' \(40 mm\) differ by 10 mm more than the gap "
    r"of 40 mm between 'A' and 'O2'; shorten 'coupler', lengthen 'rocker' or move the pivots apart"
)


def _four_bar(frame, crank, coupler, rocker):
    text = text_of("parallelogram").replace('"parallelogram"', '"sample"')
    text = text.replace("O2 = [60, 0]\n", f"O2 = [{frame}, 0]\n").replace("A = [25, 0]", f"A = [{crank}, 0]")
    return text.replace("B = [60, 0]", f"B = [{coupler}, 0]").replace("B = [25, 0]", f"B = [{rocker}, 0]")


@pytest.mark.parametrize(
    ("lengths", "message"), [((50, 25, 47, 25), SHORT_ROD), ((60, 20, 90, 40), LONG_ROD)], ids=["short", "long"]
)
def test_rods_that_do_not_reach(lengths, message):
    with pytest.raises(AssemblyError, match=message):
        from_text(_four_bar(*lengths)).check_full_turn()


def test_a_rod_that_does_not_reach_its_guide():
    text = text_of("force-over-angle").replace("D = [-70, 12]", "D = [-20, 0]")
    message = (
        r"'sample' cannot be assembled at [\d.]+°: 'rod' \(20 mm\) is [\d.]+ mm too short to reach the guide of "
        r"'piston', [\d.]+ mm away from 'A'; lengthen it or move the guide closer"
    )
    with pytest.raises(AssemblyError, match=message):
        from_text(text).check_full_turn()


def test_the_length_that_is_missing_is_right():
    # Centric: the rod of 0.04 m has to reach across the crank's 0.05 m.
    text = text_of("centric-slider-crank").replace("D = [0.2, 0] }", "D = [0.04, 0] }").replace("0.25", "0.09")
    with pytest.raises(
        AssemblyError, match=r"at (90|270)°: 'rod' \(0.04 m\) is 0.01 m too short .* 0.05 m away from 'A'"
    ):
        from_text(text).check_full_turn()


def test_a_slide_whose_offset_is_too_large():
    text = text_of("slot-without-mass").replace("through = [6, 4]", "through = [6, 40]")
    message = (
        r"the slide between 'A in rocker' and 'rocker' is offset by [\d.]+ mm, [\d.]+ mm more than the distance "
        r"between 'A' and 'O2'; lessen the offset or move the pivot away"
    )
    with pytest.raises(AssemblyError, match=message):
        from_text(text).check_full_turn()


def test_a_slide_without_offset_that_passes_through_its_pivot():
    text = text_of("shaper").replace("O2 = [0, -50]", "O2 = [0, -22]")
    sample = from_text(text)
    with pytest.raises(
        AssemblyError,
        match=r"'sample' is undetermined at 270°: 'A' and 'O2' coincide, so the direction of the slide .* undefined",
    ):
        sample.sweep(np.radians(270.0) + np.array([0.1, 0.0])).poses("rocker")


def test_parallel_guides():
    text = text_of("scotch-yoke").replace("along = [0, 1]", "along = [1, 0]")
    with pytest.raises(
        AssemblyError,
        match=r"'sample' is undetermined at [\d.]+°: the guides of 'A in yoke' and 'yoke' are parallel",
    ):
        from_text(text).check_full_turn()


def test_pivots_on_top_of_each_other():
    text = _four_bar(25, 25, 40, 40).replace("angle  = 90", "angle = 45").replace("B = [60, 25]", "B = [60, 1]")
    with pytest.raises(
        AssemblyError,
        match=r"is undetermined at 0°: .* have their outer pins on top of each other; move one of the pivots",
    ):
        from_text(text).sweep(np.array([0.3, 0.0])).poses("rocker")


def test_the_sketch_itself_may_be_out_of_reach():
    with pytest.raises(AssemblyError, match=r"'sample' cannot be assembled at 90°: "):
        from_text(_four_bar(60, 25, 30, 25))


def test_links_that_just_touch_are_assembled():
    sweep = mechanism("parallelogram").sweep(np.radians([0.0, 180.0]))
    assert np.all(sweep.closure_error() <= 1e-16)


@pytest.mark.parametrize("angle", [np.nan, np.inf])
def test_an_angle_that_is_none(angle):
    with (
        np.errstate(invalid="ignore"),
        pytest.raises(LinkproofError, match="crank angle: expected finite numbers, got nan or infinity"),
    ):
        mechanism("juki-mf7923d").sweep(np.array([0.0, angle])).poses("coupler")
