"""Extrapolation over the step: which error terms go, and what it refuses."""

import numpy as np
import pytest

from engines.contract import History, Signal
from engines.stepping.richardson import Pass, extrapolate

ROUNDING = 1e-12
TIME = np.linspace(0.0, 1.0, 11)
TRUTH = np.sin(3.0 * TIME)


def _run(step, error):
    """A history whose every sample is off by ``error(step, samples)``."""
    values = TRUTH + error(step, np.arange(len(TIME)) * round(0.1 / step))
    body = np.repeat(values[:, None, None], 3, axis=2)
    history = History(
        position=Signal(TIME, body),
        torque=Signal(TIME[1:], values[1:]),
        joint_force={"A": Signal(TIME, np.stack([values, -values], axis=-1))},
    )
    return Pass(step, history)


def _even_powers(step, _number):
    return 3.0 * step**2 - 5.0 * step**4 + 7.0 * step**6


def _worst(history):
    return np.abs(history.torque.values - TRUTH[1:]).max()


@pytest.mark.parametrize("count", [2, 4])
def test_enough_steps_leave_only_the_orders_not_named(count):
    steps = [0.1 / k for k in (1, 3, 5, 7)[:count]]
    error = _worst(extrapolate([_run(step, _even_powers) for step in steps]))
    powers = [3.0, 5.0, 7.0]
    left = [0.1 ** (2 * k + 2) * powers[k] for k in range(count - 1, 3)]
    assert error <= sum(left) + ROUNDING


def test_orders_can_be_an_engines_own():
    runs = [_run(0.1 / k, lambda step, _: 2.0 * step + 4.0 * step**3) for k in (1, 2, 4)]
    assert _worst(extrapolate(runs, orders=(1, 3))) <= ROUNDING


def test_an_alternating_error_goes_with_odd_divisions_and_stays_with_even_ones():
    def ringing(step, number):
        return step**2 * np.where(number % 2, -1.0, 1.0)

    assert _worst(extrapolate([_run(0.1 / k, ringing) for k in (1, 3)])) <= ROUNDING
    assert _worst(extrapolate([_run(0.1 / k, ringing) for k in (1, 2)])) > 0.1**2 / 2.0


def test_every_channel_is_combined_and_absent_ones_stay_absent():
    history = extrapolate([_run(0.1 / k, lambda step, _: step**2) for k in (1, 3)])
    assert np.abs(history.position.values[:, 0, 1] - TRUTH).max() <= ROUNDING
    assert np.abs(history.joint_force["A"].values[:, 1] + TRUTH).max() <= ROUNDING
    assert len(history.torque.time) == len(TIME) - 1
    assert history.velocity is None
    assert history.acceleration is None


def test_clocks_that_differ_are_refused():
    coarse = _run(0.1, _even_powers).history
    fine = History(torque=Signal(TIME, TRUTH))
    with pytest.raises(ValueError, match="same sample times"):
        extrapolate([Pass(0.1, History(torque=coarse.torque)), Pass(0.1 / 3.0, fine)])
