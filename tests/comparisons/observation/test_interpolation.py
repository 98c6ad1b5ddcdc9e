"""Interpolation is exact for quintics and of sixth order on any clock."""

import numpy as np
import pytest

from comparisons.observation.interpolation import resample
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


def test_the_same_clock_gives_the_same_values():
    signal = Signal(np.arange(6.0), np.array([3.0, 1.0, 4.0, 1.0, 5.0, 9.0]))
    assert resample(signal, np.arange(6.0)) is signal.values


def test_too_few_samples_are_refused():
    with pytest.raises(ValueError, match="at least 6 samples"):
        resample(Signal(np.arange(3.0), np.arange(3.0)), np.array([0.5]))
