"""Mean, extremes and zeros of a periodic quantity of the crank angle, refined between the samples of a grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.law import FULL_TURN
from analytic.numerics.refine import highest
from analytic.numerics.roots import roots

Array = NDArray[np.float64]
Quantity = Callable[[Array], Array]

GRID = 720  # half a degree: finer than any extremum of a linkage of a few groups


@dataclass(frozen=True)
class Extremes:
    """Mean and extremes of a quantity over one turn, in its unit, and the crank angles of the extremes, rad."""

    mean: float
    maximum: float
    minimum: float
    maximum_angle: float
    minimum_angle: float

    @property
    def relative_pulsation(self) -> float:
        """(max − min) / (2 mean), as in article 003; 0 for a constant, also for zero."""
        if self.maximum == self.minimum:
            return 0.0
        return (self.maximum - self.minimum) / (2.0 * self.mean)


def grid(points: int = GRID) -> Array:
    """Crank angles over one turn, rad, the end left out."""
    return np.linspace(0.0, FULL_TURN, points, endpoint=False)


def in_turn(angle: ArrayLike) -> Array:
    """Crank angles brought into [0, 2π): the remainder of one just below zero rounds to 2π, which is 0."""
    remainder = np.mod(angle, FULL_TURN)
    return np.where(remainder < FULL_TURN, remainder, 0.0)


def periodic_mean(values: Array) -> float:
    """Mean over a turn of samples on ``grid``: the trapezoid rule, exponentially accurate for smooth functions."""
    return float(np.mean(values))


def extremes(quantity: Quantity, points: int = GRID) -> Extremes:
    """Mean, maximum and minimum of a periodic quantity over a turn."""
    angle = grid(points)
    values = quantity(angle)

    def both(phi: Array) -> Array:
        return np.stack([seen := quantity(phi), -seen])

    closed = np.append(values, values[0])  # the turn's end, where a top may lie just before its start
    (top, bottom), places = highest(both, np.append(angle, FULL_TURN), np.stack([closed, -closed]))
    return Extremes(periodic_mean(values), float(top), -float(bottom), *in_turn(places).tolist())


def largest(quantity: Quantity, points: int = GRID) -> float:
    """Largest magnitude of a periodic quantity over a turn."""
    result = extremes(quantity, points)
    return max(result.maximum, -result.minimum)


def zeros(quantity: Quantity, points: int = GRID, turns: int = 1) -> Array:
    """Crank angles in [0, 2π), rad, where a periodic quantity changes sign.

    For a quantity whose period is several ``turns`` they are in [0, 2π ``turns``).
    """
    angle = np.arange(float(points * turns)) * (FULL_TURN / points)
    values = quantity(angle)
    following = np.roll(values, -1)
    changes = np.flatnonzero(np.signbit(values) != np.signbit(following))
    left, right = angle[changes], angle[changes] + FULL_TURN / points
    places = roots(quantity, left, np.where(values[changes] == 0.0, left, right), right)
    return np.sort(in_turn(places) if turns == 1 else np.mod(places, turns * FULL_TURN))
