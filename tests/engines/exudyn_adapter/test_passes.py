"""The estimate of what an extrapolation leaves, on errors that are known."""

from itertools import pairwise

import numpy as np
import pytest

from engines.exudyn_adapter.passes import estimated_error
from engines.stepping.richardson import weights

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
    assert HALF * error <= estimated_error(changes, DIVISIONS) <= TWICE * error


def test_two_passes_only_square_the_error_of_the_first():
    assert estimated_error([1e-2], DIVISIONS) == pytest.approx(4.0 / 9.0 * 1e-4)


def test_passes_that_do_not_converge_are_taken_at_their_change():
    assert estimated_error([1e-3, 1e-2], DIVISIONS) == pytest.approx(2.0 * 1e-2 * (3.0 / 5.0) ** 2)
    assert np.isnan(estimated_error([1e-3, np.nan], DIVISIONS))


def test_nothing_that_changes_leaves_nothing():
    assert estimated_error([0.0], DIVISIONS) == 0.0
    assert estimated_error([0.0, 0.0], DIVISIONS) == 0.0
