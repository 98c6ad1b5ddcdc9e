"""Speeds that relax within a step, and energy errors that damping forgets."""

import numpy as np
import pytest

from comparisons.invariants.relaxation import carried, forgotten, speed_errors
from comparisons.judging.limits import limit


def test_a_carried_value_is_the_recursion_it_says():
    kept, added = np.array([0.5, 1.0, 0.25]), np.array([1.0, -2.0, 3.0])
    np.testing.assert_allclose(carried(4.0, kept, added), [4.0, 3.0, 1.0, 3.25])
    np.testing.assert_allclose(carried(4.0, np.ones(3), added), [4.0, 5.0, 3.0, 6.0])


@pytest.mark.parametrize("rate", [0.0, 0.3, 40.0, 1e6])
def test_an_energy_error_decays_at_its_rate(rate):
    """A steady source s against a decay r makes s/r (1 − e^{−rt}): known at every sample, however coarse."""
    time = np.linspace(0.0, 2.0, 41)
    left = forgotten(3.0 * time, np.full(41, rate), time)
    exact = 3.0 * time if rate == 0.0 else 3.0 / rate * -np.expm1(-rate * time)
    np.testing.assert_allclose(left, exact, rtol=1e-10)


@pytest.mark.parametrize("rate", [0.0, 1.0, 30.0, 3e3, 1e9])
@pytest.mark.parametrize("excess", [0.0, 0.1])
def test_a_speed_is_held_against_its_acceleration_however_stiff(rate, excess):
    """ω' = g − r ω from rest, over within 1/r. A wrong speed obeys that equation too, but is not what it leads to."""
    time = np.linspace(0.0, 1.0, 201)
    speed = 2.0 * time if rate == 0.0 else 2.0 / rate * -np.expm1(-rate * time)
    claimed = speed * (1.0 + excess * np.exp(-time / 0.3))
    found = speed_errors(time, claimed, 2.0 - rate * claimed, np.full(201, rate), 0.0)
    peak = np.max(speed)
    if excess:
        assert np.max(found) > 5.0 * limit("closure", "tuned", "own").value * peak
    else:
        assert np.max(found) < 1e-6 * peak


def test_a_wrong_start_is_an_error_from_the_first_sample_on():
    time = np.linspace(0.0, 1.0, 101)
    found = speed_errors(time, np.full(101, 5.0), np.zeros(101), np.zeros(101), 0.5)
    np.testing.assert_allclose(found, 0.5)
