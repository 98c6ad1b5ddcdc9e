"""Tops held apart: their heights and derivatives against the refined figures and differences of them."""

from itertools import pairwise

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.designs.results import design_figures
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import named_figures, steady_motion
from comparisons.designs.problem import LocalMaxima, sides

NUMBERS = {"rod.B.x": 0.1743, "rocker.mass": 0.6}


@pytest.fixture(scope="module")
def rimoldi():
    return Mechanism(load("rimoldi-164"))


@pytest.mark.parametrize("name", ["Mkr.min", "joint_force:A.max"])
def test_the_highest_top_is_the_figure_and_its_slope_is_a_difference(rimoldi, name):
    (one, *_), motion = named_figures(rimoldi, [name]), steady_motion(rimoldi, 100.0)
    (side,) = sides(one.figure)
    maxima = LocalMaxima(rimoldi, motion, (side,))
    heights, slopes = maxima.heights(NUMBERS, maxima.windows(NUMBERS))
    best = int(np.argmax(heights))

    def refined(numbers):
        arrays = {key: np.array([value]) for key, value in numbers.items()}
        return float(design_figures(rimoldi, arrays, [one.figure], motion.places, speed=100.0, refine=True)[0, 0])

    assert side.way * heights[best] == pytest.approx(refined(NUMBERS), rel=1e-12)
    for column, key in enumerate(NUMBERS):
        ends = [refined({**NUMBERS, key: NUMBERS[key] * (1.0 + step)}) for step in (-1e-4, 1e-4)]
        difference = (ends[1] - ends[0]) / (2e-4 * NUMBERS[key])
        assert side.way * slopes[best, column] == pytest.approx(difference, rel=1e-4, abs=1e-6 * abs(heights[best]))


def test_windows_cover_a_turn_once_and_each_has_one_top(rimoldi):
    (one,) = named_figures(rimoldi, ["Mkr.peak"])
    maxima = LocalMaxima(rimoldi, steady_motion(rimoldi, 100.0), sides(one.figure))
    windows = maxima.windows(NUMBERS)
    for side in maxima.sides:
        own = [window for window in windows if window.side == side]
        assert own[0].first + len(maxima.grid) == own[-1].last
        assert all(left.last == right.first for left, right in pairwise(own))
    assert len(windows) > 2
