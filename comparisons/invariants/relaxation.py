"""Errors of a damped motion: what damping forgets of them, and speeds that decay within a sample or less."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from comparisons.observation.interpolation import POINTS

Array = NDArray[np.float64]

TINY = float(np.finfo(float).tiny)
ERROR_SHARE = 0.25  # of the distance from every other sample: fourth order leaves a fifteenth, if it converges
SLOW = 0.5  # of a relaxation time: within so long a step the ends' slopes still improve a quadrature


def carried(start: float, shares: Array, added: Array) -> Array:
    """The series y with y₀ = ``start`` and yₙ₊₁ = keptₙ yₙ + addedₙ, (n + 1,)."""
    if np.all(shares == 1.0):
        return start + np.concatenate([[0.0], np.cumsum(added)])
    result, value = [start], start
    for share, more in zip(shares.tolist(), added.tolist(), strict=True):
        value = value * share + more
        result.append(value)
    return np.array(result)


def forgotten(gained: Array, rate: Array, time: Array) -> Array:
    """The rest of an energy error that dampers dissipate at a rate, 1/s: h' = δE' − rate · h.

    More speed is damped more: a power D taken of the kinetic energy T takes D/T of any error in it.
    """
    decay = np.diff(time) * 0.5 * (rate[1:] + rate[:-1])
    spread = -np.expm1(-decay) / np.maximum(decay, TINY)
    return carried(float(gained[0]), np.exp(-decay), np.diff(gained) * np.where(decay > 0.0, spread, 1.0))


def speed_errors(time: Array, speed: Array, acceleration: Array, rate: Array, start: float) -> Array:
    """|ω − what the claimed acceleration makes of it|, rad/s, beyond the error of coarse samples.

    ``rate`` is b/Jeq, 1/s, with which a speed relaxes; ``start`` is the first sample's own error. Between samples the
    drive and loads, ε + rate · ω, are taken to be smooth, not ε itself, which may be over within a fraction of a step.
    """
    errors = carried(start, *_steps(time, speed, acceleration, rate))
    if len(time) < 4 * POINTS:
        return np.zeros(len(time))
    coarse = carried(start, *_steps(time[::2], speed[::2], acceleration[::2], rate[::2]))
    converging = bool(np.all(np.diff(time) * np.maximum(rate[1:], rate[:-1]) < SLOW))
    unsure = (ERROR_SHARE if converging else 1.0) * np.maximum.accumulate(np.abs(coarse - errors[::2]))
    return np.maximum(np.abs(errors) - unsure[np.arange(len(time)) // 2], 0.0)


def _steps(time: Array, speed: Array, acceleration: Array, rate: Array) -> tuple[Array, Array]:
    """The share of a speed error that each step keeps, and the error that it adds."""
    push, step = acceleration + rate * speed, np.diff(time)
    decay = step * 0.5 * (rate[1:] + rate[:-1])
    shares = np.exp(-decay)
    safe = np.maximum(decay, 1e-6)
    weight = np.where(decay > 1e-6, -np.expm1(-safe) / safe, 1.0 - 0.5 * decay)
    late = np.where(decay > 1e-3, (1.0 - weight) / safe, 0.5 - decay / 6.0)
    change = step * ((weight - late) * push[:-1] + late * push[1:])
    slope = np.gradient(push, time, edge_order=2)
    change += np.where(decay < SLOW, step**2 * (slope[:-1] - slope[1:]) / 12.0, 0.0)
    return shares, speed[1:] - shares * speed[:-1] - change
