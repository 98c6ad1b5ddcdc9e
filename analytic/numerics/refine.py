"""The true highest values of many sampled curves at once, refined between the neighbours of their highest samples.

The one refinement of extremes: over the turn of a crank, the time of a motion, or the turns of many designs. A curve
may jump between two samples: it is followed on either side of the jump, never across it. A top narrower than two steps
of the samples may be missed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.law import FULL_TURN
from analytic.numerics.arrays import Array
from analytic.numerics.roots import roots

Integers = NDArray[np.int64]
# Heights (n, 3) of the tops of some numbers (n,) at places (n, 3).
Heights = Callable[[Integers, Array], Array]
Curves = Callable[[Array], Array]
SomeCurves = Callable[[Integers, Array], Array]

ROUNDING: Final = 1e-12  # of a curve's largest value: of tops that differ by less the first is taken, on every machine

MOST: Final = 8  # tops of a curve that are looked at: of more, those that may be highest between the samples
# Three places about the top of a parabola, a share NEAR of the bracket apart. Where that leaves a wide bracket, as the
# curve is no parabola yet, the next three divide it evenly. Brackets FINE of the first ones leave a parabola through
# them with an error below rounding: the third power of what is left of the distance of two samples.
NEAR: Final = 1.0 / 32.0
FINE: Final = 1.0 / 2000.0
# A top that is still above its points by the share MISSED is sharper than the samples show it: it is closed in on
# further; one that stays above them then is a corner, whose highest point is taken. One that is above them by JUMP is
# no top but the side of a jump.
MISSED, SHARP, JUMP = 1e-13, 1e-3, 1e-6
LOOKS: Final = 12  # rounds of closing in on a top
BESIDE: Final = 1e-3  # points so close beside each other, as either side of a jump, give a slope of rounding alone


class Tops(NamedTuple):
    """Sampled tops of curves: the curve of each (n,), three neighbouring places (n, 3), ascending, and heights there.

    The highest is in the middle, or at an end where the curve ends.
    """

    curve: Integers
    places: Array
    heights: Array


class SampledTops(NamedTuple):
    """Samples that are tops: the curve of each (n,), the sample's index, three neighbours with it, (n, 3)."""

    curve: Integers
    best: Integers
    near: Integers

    def bounds(self, last: int) -> tuple[Integers, Integers]:
        """Indices (n,) of the samples before and after each top, within 0 and the last sample's index, ``last``."""
        return np.maximum(self.best - 1, 0), np.minimum(self.best + 1, last)


def highest(curves: Curves, grid: Array, values: Array) -> tuple[Array, Array]:
    """The highest value of every curve between the ends of the grid, and its place: two arrays (k,).

    Of equal ones it is the first; of a curve that is not finite it is the sample. ``curves(places)`` gives all k curves
    at places (m,) as (k, m); ``values`` (k, n) are theirs on the ascending ``grid`` (n,) of at least three places.
    """
    return highest_each(lambda rows, places: curves(places)[rows], grid, values)


def highest_each(curves: SomeCurves, grid: Array, values: Array) -> tuple[Array, Array]:
    """Highest values and places as from ``highest``, two arrays (k,), of curves that can be computed one by one.

    ``curves(rows, places)`` gives only the curves numbered ``rows`` (r,) at places (m,), as (r, m).
    """
    sampled = tops(values)
    result = Tops(sampled.curve, grid[sampled.near], values[sampled.curve[:, None], sampled.near])

    def heights(top: Integers, places: Array) -> Array:
        """Heights of the curves on which tops lie, (tops, n), for the tops' numbers and places (tops, n)."""
        rows, row = np.unique(result.curve[top], return_inverse=True)
        seen = curves(rows, places.ravel()).reshape(len(rows), *places.shape)
        return np.asarray(seen[row, np.arange(len(top))])

    climbed, where = climb(result, heights)
    first = first_highest(result, climbed, len(values), np.max(np.abs(values), axis=1))
    best = np.argmax(values, axis=1)
    most, places = values[np.arange(len(values)), best], grid[best]
    most[result.curve[first]], places[result.curve[first]] = climbed[first], where[first]
    return most, places


def tops(heights: Array, least: Array | float = -np.inf) -> SampledTops:
    """The sampled tops of curves (k, m), m ≥ 3, that may be highest between the samples, and reach ``least``.

    ``least`` is one number or (k,). They are at most eight of a curve, ordered by curve and place.
    """
    walled = np.pad(heights, ((0, 0), (1, 1)), constant_values=-np.inf)
    with np.errstate(invalid="ignore"):  # infinity less infinity
        bend = np.abs(np.diff(heights, 2, axis=1))  # a parabola rises above its samples by an eighth of it at most
    reach = heights + np.concatenate([bend[:, :1], bend, bend[:, -1:]], axis=1)
    is_top = (heights > walled[:, :-2]) & (heights >= walled[:, 2:])
    is_top &= reach >= np.maximum(np.max(heights, axis=1), least)[:, None]
    many = np.flatnonzero(np.count_nonzero(is_top, axis=1) > MOST)
    for row in many:  # a curve that is flat but for rounding
        places, step = np.flatnonzero(is_top[row]), ROUNDING * np.max(np.abs(heights[row]))
        is_top[row] = False
        levels = np.round(reach[row, places] / (step or 1.0))
        is_top[row, places[np.argsort(-levels, kind="stable")[:MOST]]] = True
    curve, best = np.nonzero(is_top)
    return SampledTops(curve, best, np.clip(best, 1, heights.shape[1] - 2)[:, None] + np.array([-1, 0, 1]))


def highest_tops(sampled: Tops, signs: Array, heights: Heights, count: int) -> tuple[Array, Array]:
    """The highest top of each of ``count`` curves, refined between its samples by ``heights``, and its sign.

    Both are (count,), nan for a curve without tops. ``heights(top, places)`` gives the heights (r, 3) of tops numbered
    (r,) at places (r, 3). ``signs`` (n,) are those of the sampled tops: 1, or -1 where the curve is a signal's negative
    (of a minimum or a magnitude). Of tops that are equal but for rounding the first counts.
    """
    climbed, _ = climb(sampled, heights)
    first, result = first_highest(sampled, climbed, count), np.full((2, count), np.nan)
    result[:, sampled.curve[first]] = climbed[first], signs[first]
    return result[0], result[1]


def first_highest(sampled: Tops, climbed: Array, count: int, sizes: Array | float = 0.0) -> Integers:
    """For each of the ``count`` curves that has tops, the index of its highest top, the first of those that are equal.

    The indices are in the order of the curves. ``climbed`` (n,) are the tops' heights. They are equal where they differ
    by the rounding of their height, or of a curve's size, ``sizes`` (count,).
    """
    most = np.full(count, -np.inf)
    np.maximum.at(most, sampled.curve, climbed)
    least = most - ROUNDING * np.maximum(np.abs(most), sizes)
    order = np.lexsort((sampled.places[:, 1], sampled.curve))
    order = order[~(climbed[order] < least[sampled.curve[order]])]
    return np.asarray(order[np.unique(sampled.curve[order], return_index=True)[1]])


def climb(sampled: Tops, heights: Heights) -> tuple[Array, Array]:
    """The height of each sampled top, refined, and its place: two arrays (n,).

    ``heights(top, places)`` gives the heights (r, 3) of tops numbered (r,) at places (r, 3). A corner has the height of
    its highest point, a top that is not finite that of its samples.
    """
    result = np.empty((2, len(sampled.curve)))
    x, y = sampled.places, sampled.heights
    left: Integers = np.arange(len(x))
    low, high = _bounds(x, np.argmax(y, axis=1))
    fine = FINE * (high - low)
    share = np.full(len(x), NEAR)
    for _ in range(LOOKS):
        if not len(left):
            break
        reach = share * (high - low)
        top, _ = _parabola(x, y)
        top = np.where(np.isfinite(top), top, 0.5 * (low + high))
        top = np.clip(top, low + 1.5 * reach, high - 1.5 * reach)
        top = np.where(np.abs(top - x[:, 1]) < 0.125 * reach, x[:, 1] + 0.25 * reach, top)  # not the same place twice
        near = top[:, None] + reach[:, None] * np.array([-1.0, 0.0, 1.0])
        x, y = np.concatenate([x, near], axis=1), np.concatenate([y, heights(left, near)], axis=1)
        order = np.argsort(x, axis=1)
        x, y = np.take_along_axis(x, order, 1), np.take_along_axis(y, order, 1)
        best = np.argmax(y, axis=1)
        was = high - low
        low, high = _bounds(x, best)
        share = np.where(high - low < 0.4 * was, NEAR, 0.25)
        three = np.clip(best, 1, x.shape[1] - 2)[:, None] + np.array([-1, 0, 1])
        x, y = np.take_along_axis(x, three, 1), np.take_along_axis(y, three, 1)
        row, peak = np.arange(len(x)), np.argmax(y, axis=1)
        seen, place = y[row, peak], x[row, peak]
        top = _predicted_height(x, y, low, high, seen)
        missed = top - seen > MISSED * np.abs(top)
        wide = high - low > np.where(missed, SHARP * fine, fine)
        is_corner = (missed & ~wide) | (top - seen > JUMP * np.abs(top))
        result[:, left] = np.where(is_corner, seen, top), place
        on = wide & np.isfinite(seen)
        left, x, y = left[on], x[on], y[on]
        low, high, fine, share = low[on], high[on], fine[on], share[on]
    return result[0], result[1]


def _bounds(x: Array, best: Integers) -> tuple[Array, Array]:
    """The places (n,) before and after the best of each row of ``x`` (n, m); an end has itself.

    ``best`` (n,) are indices.
    """
    row = np.arange(len(x))
    return x[row, np.maximum(best - 1, 0)], x[row, np.minimum(best + 1, x.shape[1] - 1)]


def _parabola(x: Array, y: Array) -> tuple[Array, Array]:
    """Place and height, (n,) each, of the top of the parabola through three points, ``x`` and ``y`` (n, 3).

    They are infinite or nan without a reliable top.
    """
    before, after = x[:, 1] - x[:, 0], x[:, 2] - x[:, 1]
    with np.errstate(divide="ignore", invalid="ignore"):  # two of the places may be the same
        rise, fall = (y[:, 1] - y[:, 0]) / before, (y[:, 2] - y[:, 1]) / after
        bend = (fall - rise) / (before + after)
        slope = (rise * after + fall * before) / (before + after)
    bend = np.where((bend < 0.0) & (np.minimum(before, after) > BESIDE * (before + after)), bend, np.nan)
    return x[:, 1] - 0.5 * slope / bend, y[:, 1] - 0.25 * slope * slope / bend


def _predicted_height(x: Array, y: Array, low: Array, high: Array, seen: Array) -> Array:
    """The top (n,) of the parabola through three points (n, 3), or the highest point ``seen`` (n,) if that is higher.

    It is ``seen`` also where the top's place is not between ``low`` and ``high``, and nan where that is nan.
    """
    place, top = _parabola(x, y)
    return np.asarray(np.where((place > low) & (place < high), np.fmax(top, seen), seen))


# Mean, extremes and zeros of a periodic quantity of the crank angle, refined between the samples of a grid.

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
        """(max − min) / (2 mean), as in article 003; 0 for a constant, also for zero.

        Raises ZeroDivisionError for another quantity whose mean is 0.
        """
        if self.maximum == self.minimum:
            return 0.0
        return (self.maximum - self.minimum) / (2.0 * self.mean)


def grid(points: int = GRID) -> Array:
    """Evenly spaced crank angles over one turn, rad, from 0 on, the end left out."""
    return np.linspace(0.0, FULL_TURN, points, endpoint=False)


def in_turn(angle: ArrayLike) -> Array:
    """Crank angles, rad, brought into [0, 2π), as a new array.

    The remainder of one just below zero rounds to 2π, which becomes 0.
    """
    remainder = np.mod(angle, FULL_TURN)
    return np.where(remainder < FULL_TURN, remainder, 0.0)


def periodic_mean(values: Array) -> float:
    """Mean over a turn of samples on ``grid``: the trapezoid rule, exponentially accurate for smooth functions."""
    return float(np.mean(values))


def extremes(quantity: Quantity, points: int = GRID) -> Extremes:
    """Mean, maximum and minimum of a periodic quantity over a turn, sampled at ``points`` and refined between them.

    ``quantity`` gives values (n,) at crank angles (n,), rad.
    """
    angle = grid(points)
    values = quantity(angle)

    def both(phi: Array) -> Array:
        """The quantity and its negative at crank angles (n,), rad: two curves (2, n) whose tops are its extremes."""
        return np.stack([seen := quantity(phi), -seen])

    closed = np.append(values, values[0])  # the turn's end, where a top may lie just before its start
    (top, bottom), places = highest(both, np.append(angle, FULL_TURN), np.stack([closed, -closed]))
    return Extremes(periodic_mean(values), float(top), -float(bottom), *in_turn(places).tolist())


def zeros(quantity: Quantity, points: int = GRID, turns: int = 1) -> Array:
    """Crank angles in [0, 2π), rad, ascending, where a periodic quantity changes sign; none where it does not.

    ``quantity`` gives values (n,) at crank angles (n,), rad; ``points`` are the samples of a turn, between which one
    change of sign is found. For a quantity whose period is several ``turns`` the angles are in [0, 2π ``turns``).
    """
    angle = np.arange(float(points * turns)) * (FULL_TURN / points)
    values = quantity(angle)
    following = np.roll(values, -1)
    changes = np.flatnonzero(np.signbit(values) != np.signbit(following))
    left, right = angle[changes], angle[changes] + FULL_TURN / points
    places = roots(quantity, left, np.where(values[changes] == 0.0, left, right), right)
    return np.sort(in_turn(places) if turns == 1 else np.mod(places, turns * FULL_TURN))
