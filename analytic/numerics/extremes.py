"""Mean, extremes and zeros of a periodic quantity of the crank angle, refined beyond the grid they show up on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.law import FULL_TURN

Array = NDArray[np.float64]
Quantity = Callable[[Array], Array]

GRID = 720  # half a degree: finer than any extremum of a linkage of a few groups
# Each look at a bracket shrinks it 16-fold, half a degree to 1e-9 rad in six looks; at a smooth extremum the value is
# then exact, for it errs by the square of that.
LOOK, LOOKS = 33, 6
NEWTON_STEPS = 50


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
        """(max − min) / (2 mean), as in article 003; 0 of a constant, though it be zero."""
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
    """Mean over a turn of samples on ``grid``: the trapezoid rule, exponentially accurate for what is smooth."""
    return float(np.mean(values))


def extremes(quantity: Quantity, points: int = GRID) -> Extremes:
    """Mean, maximum and minimum of a periodic quantity over a turn."""
    angle = grid(points)
    values = quantity(angle)
    highest, top = _highest(quantity, angle, values)
    lowest, bottom = _highest(lambda phi: -quantity(phi), angle, -values)
    return Extremes(periodic_mean(values), highest, -lowest, top, bottom)


def largest(quantity: Quantity, points: int = GRID) -> float:
    """Largest magnitude of a periodic quantity over a turn."""
    found = extremes(quantity, points)
    return max(found.maximum, -found.minimum)


def _highest(quantity: Quantity, angle: Array, values: Array) -> tuple[float, float]:
    """The highest value and its angle; every peak of the grid is looked at, since a lower one may hide the highest."""
    step = FULL_TURN / len(angle)
    peaks = angle[(values >= np.roll(values, 1)) & (values >= np.roll(values, -1))]
    if len(peaks) > len(angle) // 4:  # a constant: every sample is a peak
        peaks = angle[[int(np.argmax(values))]]
    for _ in range(LOOKS):
        near = peaks[:, None] + step * np.linspace(-1.0, 1.0, LOOK)
        seen = quantity(near)
        best = np.argmax(seen, axis=1)
        rows = np.arange(len(peaks))
        peaks, heights = near[rows, best], seen[rows, best]
        step *= 2.0 / (LOOK - 1)
    first = int(np.argmax(heights))
    return float(heights[first]), float(in_turn(peaks[first]))


def zeros(quantity: Quantity, slope: Quantity, points: int = GRID, turns: int = 1) -> Array:
    """Crank angles in [0, 2π), rad, where a periodic quantity changes sign: Newton with the bracket as a safeguard.

    In [0, 2π ``turns``) of what has as many turns for a period.
    """
    angle = np.arange(float(points * turns)) * (FULL_TURN / points)
    values = quantity(angle)
    changes = np.flatnonzero(np.signbit(values) != np.signbit(np.roll(values, -1)))
    left, right = angle[changes], angle[changes] + FULL_TURN / points
    left_negative = np.signbit(values[changes])
    root = 0.5 * (left + right)
    for _ in range(NEWTON_STEPS):
        height, steepness = quantity(root), slope(root)
        before = np.signbit(height) == left_negative
        left, right = np.where(before, root, left), np.where(before, right, root)
        with np.errstate(divide="ignore", invalid="ignore"):
            moved = root - height / steepness
        moved = np.where((moved >= left) & (moved <= right), moved, 0.5 * (left + right))
        done = np.all(np.abs(moved - root) <= 4.0 * np.finfo(float).eps * FULL_TURN)
        root = moved
        if done:
            break
    return np.sort(in_turn(root) if turns == 1 else np.mod(root, turns * FULL_TURN))
