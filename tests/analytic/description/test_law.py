"""Loads over the crank angle: through their points, periodic and smooth, with exact derivatives."""

import numpy as np
import pytest

from analytic.description.law import FULL_TURN, Law
from tests.analytic.tolerances import DIFFERENCED, FEW_ROUNDINGS

ANGLES = np.radians([-40.0, 15.0, 80.0, 170.0, 250.0])
VALUES = np.array([[1.0, -3.0], [2.5, 0.0], [-1.0, 4.0], [0.5, 1.0], [2.0, -2.0]])
LAW = Law(VALUES, ANGLES)


def test_a_constant_is_itself_everywhere():
    law = Law(np.array([3.0, -1.0]))
    assert law.is_constant
    assert np.array_equal(law(np.zeros((2, 3)))[:, 1, 2], [3.0, -1.0])
    assert np.all(law([0.1, 0.2], order=1) == 0.0)
    assert law(0.3).shape == (2,)


def test_a_spline_passes_through_its_points_on_every_turn_and_joins_itself_smoothly():
    assert not LAW.is_constant
    for turns in (0, 1, -3):
        assert LAW(ANGLES + turns * FULL_TURN) == pytest.approx(VALUES.T, abs=FEW_ROUNDINGS * FULL_TURN)
    for order in range(3):
        before, after = LAW(ANGLES[0] + np.array([-1e-12, 1e-12]), order).T
        assert before == pytest.approx(after, abs=1e-9)
    angle, step = np.linspace(0.3, 5.9, 17), 1e-5
    slope = (LAW(angle + step) - LAW(angle - step)) / (2.0 * step)
    assert LAW(angle, 1) == pytest.approx(slope, abs=DIFFERENCED * 100)


@pytest.mark.parametrize("periodic", [True, False])
def test_straight_lines_join_the_values_of_a_linear_law(periodic):
    law = Law(VALUES, ANGLES, FULL_TURN if periodic else None, linear=True)
    angle, step = np.linspace(-7.0, 9.0, 161), 1e-6
    for part, values in enumerate(VALUES.T):
        true = lambda phi, v=values: np.interp(phi, ANGLES, v, period=FULL_TURN if periodic else None)  # noqa: E731
        assert law(angle)[part] == pytest.approx(true(angle), abs=FEW_ROUNDINGS * FULL_TURN)
        slope = (true(angle + step) - true(angle - step)) / (2.0 * step)
        assert law(angle, 1)[part] == pytest.approx(slope, abs=1e-7)
        assert not law(angle, 2).any()
