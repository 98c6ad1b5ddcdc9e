"""The root of a function of one number within a bracket, or of many at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from analytic.numerics.arrays import Array, Booleans

MOST_STEPS: Final = 200
SETTLED: Final = 2e-13  # of a function's larger value at the ends: smaller ones are zero but for rounding


def root(function: Callable[[float], float], left: float, right: float) -> float:
    """The place, between ``left`` and ``right``, where a continuous function changes sign, to the last digits.

    It is an end where the function is exactly zero, and ``left`` without a change of sign.
    """
    for end in (left, right):
        if function(end) == 0.0:
            return end
    ends = np.array([left]), np.array([right])
    return float(roots(lambda place: np.array([function(float(place[0]))]), ends[0], *ends, settled=0.0)[0])


def roots(
    function: Callable[[Array], Array], left: Array, middle: Array, right: Array, settled: float = SETTLED
) -> Array:
    """Where each of many continuous functions is zero within its bracket, (m,).

    ``function`` takes places (m,), one for each of the functions, and gives their values there, (m,). A root is as
    exact as the last digits of its place, or a value below ``settled`` of the larger one at the ends. A function that
    does not change sign between its ``left`` and ``right`` (m,) has its ``middle`` (m,) for an answer. The Illinois
    method: false position, with the value at the end that stays halved, so that neither end is stuck.
    """
    low, high = function(left), function(right)
    least = settled * np.maximum(np.abs(low), np.abs(high))
    sought = (low > 0.0) != (high > 0.0)
    best = np.where(sought, np.where(np.abs(low) < np.abs(high), left, right), middle)
    for _ in range(MOST_STEPS):
        if not np.any(sought):
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            place = right - high * (right - left) / (high - low)
        inside = (place > np.minimum(left, right)) & (place < np.maximum(left, right))
        place = np.where(sought, np.where(inside, place, 0.5 * (left + right)), best)
        value = function(place)
        sought &= (np.abs(value) > least) & (np.abs(right - left) > 2.0 * np.spacing(np.abs(best)))
        same = (value > 0.0) == (high > 0.0)
        left, low = np.where(same, left, right), np.where(same, 0.5 * low, high)
        right, high, best = place, value, place
    return best


def may_touch_zero(values: Array, rounding: float) -> Booleans:
    """Which inner samples, last axis, are local minima beside which a function may come down to zero and turn.

    The answer's last axis lacks the two outer samples. About a double root, or the tip of a magnitude, a sample is at
    most as high as both neighbours together are above it; of a smooth function that stays away it is higher, the more
    so the finer the samples. Where one neighbour is infinite the other one has to be that much higher; beside nan, or
    between two infinite ones, no sample counts, nor does one below zero by more than ``rounding``.
    """
    here, beside = values[..., 1:-1], np.stack([values[..., :-2], values[..., 2:]])
    with np.errstate(invalid="ignore"):
        rise = np.sum(np.where(np.isfinite(beside), beside - here, 0.0), axis=0)
        return np.asarray((here <= beside[0]) & (here < beside[1]) & (here >= -rounding) & (here <= rise))


def find_lowest(
    function: Callable[[Array], Array],
    left: Array,
    right: Array,
    looks: int,
    *,
    points: int = 33,
    enough: float = -np.inf,
) -> tuple[Array, Array]:
    """Where each of many functions is lowest within its bracket, and its values there: two arrays (m,).

    The brackets are from ``left`` to ``right``, (m,). ``function`` gives the values of each at its own places, both (m,
    points). Each of at most ``looks`` looks, one or more, is a comb of ``points`` places over the bracket, and the next
    bracket reaches from the lowest of them to its neighbours. It ends when all are below ``enough``.
    """
    rows, comb = np.arange(len(left)), np.linspace(0.0, 1.0, points)
    for _ in range(looks):
        places = left[:, None] + (right - left)[:, None] * comb
        values = function(places)
        best = np.argmin(values, axis=1)
        spot, height = places[rows, best], values[rows, best]
        if np.all(height < enough):
            break
        step = (right - left) / (points - 1)
        left, right = spot - step, spot + step
    return spot, height
