"""More designs than a picture has pixels: the least and the largest of each pixel are kept, and what fails there.

Values are read and thinned piece by piece, so that memory does not grow with the number of designs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
# Values of a range of places, first and last + 1, along the first dimension.
Read = Callable[[int, int], Array]

AT_ONCE = 1 << 20  # values
FAR = 3.0  # times the span of eight tenths of the values: beyond, these are shown and the others cut off


@dataclass(frozen=True)
class PixelCells:
    """Neighbours among ``places`` (n,), ascending, that are drawn together, at most ``most`` groups of equal width."""

    places: Array
    most: int

    @property
    def are_thin(self) -> bool:
        """Whether a cell may hold more than one place."""
        return len(self.places) > self.most

    @cached_property
    def starts(self) -> Indices:
        """The first place of every cell, (cells,)."""
        if not self.are_thin:
            return np.arange(len(self.places))
        ends = np.linspace(self.places[0], self.places[-1], self.most, endpoint=False)
        return np.unique(np.searchsorted(self.places, ends))

    @cached_property
    def edges(self) -> Array:
        """Where cells end, (cells + 1,): half-way between neighbours."""
        places = self.places
        if len(places) == 1:
            return places + 0.5 * (abs(places[0]) or 1.0) * np.array([-1.0, 1.0])
        middles = 0.5 * (places[self.starts[1:]] + places[self.starts[1:] - 1])
        first, last = 1.5 * places[[0, -1]] - 0.5 * places[[1, -2]]
        return np.concatenate([[first], middles, [last]])

    def curve(self, kept: Kept) -> tuple[Array, Array]:
        """Points of a curve: where places are drawn together, from their least to their largest value."""
        if not self.are_thin:
            return self.places, kept.low
        places = np.repeat(0.5 * (self.edges[1:] + self.edges[:-1]), 2)
        places[[0, -1]] = self.places[[0, -1]]
        return places, np.stack([kept.low, kept.high], axis=1).ravel()

    def failing(self, kept: Kept) -> Array:
        """Stretches (m, 2) of cells in which a design fails."""
        changes = np.flatnonzero(np.diff(np.concatenate([[False], kept.fails, [False]])))
        return self.edges[changes].reshape(-1, 2)


@dataclass(frozen=True)
class Kept:
    """What is kept of the values of many designs.

    ``low``, ``high`` and ``fails`` are the least and the largest value of every cell, and whether one is nan there;
    ``failing`` counts what is nan. Of the least value of all, the largest and the one nearest to a target there are
    the index, in the order of the dimensions, and the value, (3,) each; -1 and nan where all are nan.
    """

    low: Array
    high: Array
    fails: NDArray[np.bool_]
    failing: int
    indices: Indices
    extremes: Array

    @property
    def best(self) -> list[int]:
        """The index of the value nearest to the target; nothing where all are nan."""
        return [int(one) for one in self.indices[2:] if one >= 0]

    def surface(self) -> Array:
        """A value for every cell: the one farthest from the middle of all, nan where a design fails."""
        middle = 0.5 * (self.extremes[0] + self.extremes[1])
        return np.where(self.fails, np.nan, np.where(self.high - middle > middle - self.low, self.high, self.low))

    @cached_property
    def span(self) -> tuple[float, float] | None:
        """What to show where few values lie so far out that the others could not be told apart, as near dead positions.

        Twice the span of eight tenths of all cells, and the value nearest to the target; None where all can be shown.
        """
        there = np.concatenate([self.low.ravel(), self.high.ravel()])
        there = there[np.isfinite(there)]
        if not len(there):
            return None
        low, high = np.quantile(there, [0.1, 0.9])
        least, largest, nearest = self.extremes
        if largest - least <= FAR * (high - low) or high == low:
            return None
        half = 0.5 * (high - low)
        return float(max(least, min(low - half, nearest))), float(min(largest, max(high + half, nearest)))


def evenly(places: int, most: int) -> Indices:
    """The first of so many places of each of at most ``most`` equal parts."""
    return np.unique(np.arange(most) * places // most)


def keep(read: Read, shape: Sequence[int], starts: Sequence[Indices], target: float = 0.0) -> Kept:
    """Thin out values of a shape over one or two dimensions, whose cells begin at ``starts``; the others vanish."""
    tables: list[tuple[Any, ...]] = []
    indices, extremes, failing = np.full(3, -1), np.full(3, np.nan), 0
    each = math.prod(shape[1:])
    for first, last, part in _pieces(starts[0], shape[0], each):
        values = read(first, last)
        fails = np.isnan(values)
        failing += int(np.count_nonzero(fails))
        how = ((np.fmin, values), (np.fmax, values), (np.logical_or, fails))
        tables.append(tuple(_reduced(one, table, starts[0][part] - first, starts[1:]) for one, table in how))
        away = np.abs(values - target)
        ends = np.fmin.reduce(tables[-1][0], axis=None), np.fmax.reduce(tables[-1][1], axis=None)
        nearest = np.fmin.reduce(away, axis=None)
        better = ends[0] < extremes[0], ends[1] > extremes[1], nearest < abs(extremes[2] - target)
        for number, (table, value) in enumerate(zip((values, values, away), (*ends, nearest), strict=True)):
            if better[number] or (indices[number] < 0 and not np.isnan(value)):
                place = int(np.argmax(table == value))
                indices[number], extremes[number] = first * each + place, values.flat[place]
    low, high, fails = (np.concatenate(part) for part in zip(*tables, strict=True))
    return Kept(low, high, fails, failing, indices, extremes)


def _pieces(starts: Indices, places: int, each: int) -> Iterator[tuple[int, int, slice]]:
    """Ranges of whole cells: the first place, the last + 1, the cells; a place has ``each`` values."""
    per = max(1, AT_ONCE * len(starts) // (places * each))
    bounds = [*starts[::per].tolist(), places]
    for number, (first, last) in enumerate(pairwise(bounds)):
        yield first, last, slice(number * per, (number + 1) * per)


def _reduced(how: Any, values: Array, starts: Indices, across: Sequence[Indices]) -> Any:  # noqa: ANN401  of numpy's functions
    rows = how.reduceat(values if values.ndim == 1 else values.reshape(len(values), -1), starts, axis=0)
    if across:
        return how.reduceat(rows, across[0], axis=1)
    return rows if rows.ndim == 1 else how.reduce(rows, axis=1)


def sample(count: int, most: int, always: Collection[int]) -> Indices:
    """At most so many of ``count`` designs, ascending: at random with seed 0, and those that are always among them."""
    if count <= most:
        return np.arange(count)
    rng = np.random.default_rng(0)
    rest = np.setdiff1d(rng.choice(count, most, replace=False), list(always))
    return np.union1d(rng.permutation(rest)[: most - len(always)], list(always))


def picked(read: Read, shape: Sequence[int], chosen: Indices) -> Array:
    """The values of chosen designs, ascending, of values of a shape."""
    each, found = math.prod(shape[1:]), []
    step = max(1, AT_ONCE // each)
    for first in range(0, shape[0], step):
        last = min(first + step, shape[0])
        here = chosen[(chosen >= first * each) & (chosen < last * each)]
        if len(here):
            found.append(read(first, last).ravel()[here - first * each])
    return np.concatenate(found)
