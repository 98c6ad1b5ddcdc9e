"""Dead centres and strokes of motions whose dead centres are known."""

import numpy as np
import pytest

from analytic.errors import LinkproofError
from analytic.kinematics.dead_centres import bottom_dead_centre, dead_centres, stroke, top_dead_centre
from tests.analytic.linkages import IN_LINE, from_text, mechanism, text_of
from tests.analytic.tolerances import EPS


def test_dead_centres_of_the_juki_needle_bar_and_its_stroke():
    sample = mechanism("juki-mf7923d")
    top, bottom = top_dead_centre(sample), bottom_dead_centre(sample)
    assert (top.angle, bottom.angle) == pytest.approx((0.5 * np.pi, 1.5 * np.pi), rel=4 * EPS)
    assert (top.coordinate, bottom.coordinate) == pytest.approx((-0.039, -0.070), rel=4 * EPS)
    assert stroke(sample) == pytest.approx(0.031, rel=4 * EPS)


def test_dead_centres_of_an_offset_slider_crank_lie_off_the_grid():
    # Crank and rod in one line: from the pivot the slider's pin is rod ± crank away, at the height of the offset.
    offset, crank, rod = 0.007, 0.02, 0.06
    text = IN_LINE.replace("A = [0.03, 0]", f"A = [{crank}, 0]").replace("B = [0.11, 0]", f"B = [{rod}, 0]")
    text = text.replace("through = [0, 0]", f"through = [0, {offset}]").replace(
        "B = [0.14, 0]", f"B = [0.08, {offset}]"
    )
    top, bottom = top_dead_centre(from_text(text)), bottom_dead_centre(from_text(text))
    assert top.angle == pytest.approx(np.arcsin(offset / (rod + crank)), rel=8 * EPS)
    assert top.coordinate == pytest.approx(np.sqrt((rod + crank) ** 2 - offset**2), rel=4 * EPS)
    assert bottom.angle == pytest.approx(np.pi + np.arcsin(offset / (rod - crank)), rel=8 * EPS)
    assert bottom.coordinate == pytest.approx(np.sqrt((rod - crank) ** 2 - offset**2), rel=4 * EPS)


def test_an_output_that_does_not_move_is_refused():
    text = text_of("scotch-yoke").replace('{ point = "Y" }', '{ point = "Y", along = [0, 1] }')
    with pytest.raises(LinkproofError, match=r"expected a point that moves along its direction, got 'Y'"):
        dead_centres(from_text(text))
