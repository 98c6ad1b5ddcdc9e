"""The estimate of what an extrapolation leaves, on errors that are known."""

from itertools import pairwise

import numpy as np
import pytest

from engines.contract import History, Signal
from engines.stepping.error_estimate import change, estimated_error, remaining_error
from engines.stepping.richardson import Pass, weights

DIVISIONS = (1, 3, 5, 7)
ORDERS = (2, 4, 6, 8)
HALF, TWICE = 0.5, 4.0  # of the true error that the estimate may be


def _left(count, decay):
    """Error of the extrapolation of the first passes, whose terms are decay, decay², ... times hᵏ."""
    terms = [decay ** (1 + number) for number in range(12)]
    steps = 1.0 / np.array(DIVISIONS[:count])
    errors = sum(term * steps ** (2 * number + 2) for number, term in enumerate(terms))
    return float(weights(steps, ORDERS) @ errors)


@pytest.mark.parametrize("decay", [0.02, 0.1, 0.3])
@pytest.mark.parametrize("count", [3, 4])
def test_the_estimate_is_near_the_error_of_terms_that_shrink_evenly(decay, count):
    left = [_left(passes, decay) for passes in range(1, count + 1)]
    changes = [abs(later - former) for former, later in pairwise(left)]
    error = abs(left[-1])
    assert HALF * error <= remaining_error(changes, DIVISIONS[count - 2] / DIVISIONS[count - 1]) <= TWICE * error


def test_two_passes_only_square_the_error_of_the_first():
    assert remaining_error([1e-2], 1.0 / 3.0) == pytest.approx(4.0 / 9.0 * 1e-4)


def test_passes_that_do_not_converge_are_taken_at_their_change():
    assert remaining_error([1e-3, 1e-2], 3.0 / 5.0) == pytest.approx(2.0 * 1e-2 * (3.0 / 5.0) ** 2)
    assert np.isnan(remaining_error([1e-3, np.nan], 3.0 / 5.0))


def test_nothing_that_changes_leaves_nothing():
    assert remaining_error([0.0], 1.0 / 3.0) == 0.0
    assert remaining_error([0.0, 0.0], 3.0 / 5.0) == 0.0


TIME = np.linspace(0.0, 1.0, 11)


def _passes(error):
    """Passes whose torque, 4 N m at its peak, is off by ``error`` times the square of the step."""
    steps = [0.1 / division for division in DIVISIONS]
    return [Pass(step, History(torque=Signal(TIME, 4.0 * TIME + error * step**2))) for step in steps]


def test_an_error_of_the_leading_order_alone_is_estimated_to_be_gone():
    passes = _passes(error=5.0)
    assert estimated_error(passes[:1], ORDERS) == np.inf
    assert estimated_error(passes[:2], ORDERS) < 1e-3
    assert estimated_error(passes[:3], ORDERS) < 1e-12


def test_change_is_relative_to_the_peak_of_each_component():
    torque = Signal(TIME, np.full(11, 4.0))
    assert change(History(torque=Signal(TIME, torque.values + 1.0)), History(torque=torque)) == pytest.approx(0.25)
    force = Signal(TIME, np.tile([10.0, 0.1], (11, 1)))
    other = Signal(TIME, np.tile([10.0, 0.2], (11, 1)))
    assert change(History(joint_force={"A": force}), History(joint_force={"A": other})) == pytest.approx(0.5)
    assert change(History(), History()) == 0.0
