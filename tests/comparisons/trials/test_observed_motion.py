"""Interpolation and integrals over samples: sixth order between jumps, with an error estimate."""

import numpy as np
import pytest

from comparisons.trials.observed_motion import error_bound, error_estimate, integral, peak, resample
from engines.contract import Signal


def test_quintics_come_back_exactly_even_on_an_uneven_clock():
    time = np.cumsum(np.random.default_rng(1).uniform(0.5, 1.5, 30))
    signal = Signal(time, np.stack([1e-4 * time**5 - time, 2.0 * time**2], axis=-1))
    asked = np.linspace(time[0], time[-1], 77)
    expected = np.stack([1e-4 * asked**5 - asked, 2.0 * asked**2], axis=-1)
    np.testing.assert_allclose(resample(signal, asked), expected, rtol=1e-11, atol=1e-9)


def test_order_is_six():
    errors = []
    for count in (100, 200):
        time = np.linspace(0.0, 6.0, count)
        asked = np.linspace(0.0, 6.0, 999)
        errors.append(np.abs(resample(Signal(time, np.sin(time)), asked) - np.sin(asked)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(6.0, abs=0.3)


def test_the_peak_is_the_higher_of_two_tops_where_it_lies_between_samples_and_the_lower_on_one():
    time = np.linspace(0.0, 1.0, 41)
    fine = np.linspace(0.0, 1.0, 400_001)
    low, high = (np.cos((4.0 * np.pi + 0.3) * (at - 0.25)) + 1e-5 * at for at in (time, fine))
    assert np.argmax(low) == 10  # the lower top
    assert peak(Signal(time, low)) == pytest.approx(high.max(), abs=1e-7)


def test_an_integral_crosses_a_jump_without_losing_its_order():
    time = np.linspace(0.0, 2.0, 201)
    values = np.where(time < 1.0, np.cos(time), 5.0 + time)
    exact = np.where(time < 1.0, np.sin(time), np.sin(1.0) + 5.0 * (time - 1.0) + (time**2 - 1.0) / 2.0)
    found = integral(Signal(time, values), (0.0, 1.0))
    np.testing.assert_allclose(found, exact, atol=1e-11)


def test_the_error_estimate_is_nearer_to_the_error_and_still_larger():
    per_turn = 20
    time = np.linspace(0.0, 3.0, 3 * per_turn + 1)
    values = np.exp(np.sin(2.0 * np.pi * time)) * time
    fine = np.linspace(0.0, 3.0, 300 * per_turn + 1)
    exact = integral(Signal(fine, np.exp(np.sin(2.0 * np.pi * fine)) * fine), ())[::100]
    found = integral(Signal(time, values), ())
    estimate = error_estimate(Signal(time, values), found, ())
    assert np.max(np.abs(found - exact)) < estimate[-1] < error_bound(Signal(time, values), found, ())[-1] + 1e-4


def test_a_peak_of_a_few_samples_is_not_believed_to_be_resolved():
    """A torque spike beside a toggle: one sample in three of its width."""
    time = np.linspace(0.0, 1.0, 201)
    width = 1.2 * (time[1] - time[0])
    x = (time - 0.5012) / width
    found = integral(Signal(time, -2.0 * x * np.exp(-(x**2)) / width), ())
    error = np.abs(found - np.exp(-(x**2)))
    assert np.max(error) > 1e-2
    assert np.all(error <= error_bound(Signal(time, -2.0 * x * np.exp(-(x**2)) / width), found, ()) + 1e-12)
