"""The tops of signals of one design: exact peaks with their derivatives, each over a window of the motion of its own.

The highest of several tops has a kink wherever two of them are equally high, which is where most least peaks lie. Each
top for itself is smooth, and an optimiser of smooth problems can hold them all. A polynomial through a few crank angles
about a top gives its height and its derivatives from one look at the design; the single highest top of
``analytic.designs.derivatives`` takes several, and holds for angles that are far apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.designs.derivatives import signal_gradients
from analytic.designs.figures import Figure, Reduction, SignalExtreme
from analytic.errors import AssemblyError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import MAGNITUDE
from comparisons.designs.steady_motion import SteadyMotion

Array = NDArray[np.float64]

FEWEST: Final = 360  # crank angles among which tops are looked for
MOST: Final = 12  # tops of one signal that are told apart; of more the lowest share the window of a neighbour
DEGREE: Final = 8  # of the polynomial in whose highest place a top lies, over two steps of the grid
NODES: Final = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
FINE: Final = np.linspace(-1.0, 1.0, 201)


class Window(NamedTuple):
    """Samples ``first`` to ``last`` of the grid, those beyond its ends a turn on, on a side of a signal."""

    side: SignalExtreme
    first: int
    last: int


def reduction(figure: Figure) -> Reduction:
    """How a figure is made of a signal; S counts from its farthest place, so that its largest is its range."""
    is_range = figure.signal == "S" and figure.reduction in (Reduction.PEAK, Reduction.MAX)
    return Reduction.RANGE if is_range else figure.reduction


def sides(figure: Figure) -> tuple[SignalExtreme, ...]:
    """The sides of a signal, highest and lowest, whose tops make a figure: a range and a peak have both, means none.

    A peak is the highest top of both, and the tops of a range's sides add up.
    """
    name, how = figure.signal, reduction(figure)
    if (name.startswith("link:") and name.endswith(":angle")) or (name == "S" and how is Reduction.MIN):
        return ()  # they count from the other angles that are asked for
    up, down = SignalExtreme(name, 1), SignalExtreme(name, -1)
    if how is Reduction.PEAK:
        return (up,) if name.endswith(MAGNITUDE) else (up, down)
    return replace(figure, reduction=how).extremes


@dataclass(frozen=True)
class SeparateTops:
    """Where the tops of some ``signals`` of a mechanism's designs are looked for."""

    mechanism: Mechanism
    motion: SteadyMotion
    sides: tuple[SignalExtreme, ...]

    @property
    def grid(self) -> Array:
        """Evenly spaced crank angles, rad or m."""
        count = max(FEWEST, len(self.motion.places))
        if self.motion.is_full_turn:
            return np.linspace(0.0, FULL_TURN, count, endpoint=False)
        return np.linspace(self.motion.places[0], self.motion.places[-1], count)

    def windows(self, numbers: Mapping[str, float]) -> tuple[Window, ...]:
        """The motion of a design cut at the bottoms between its tops, for every side."""
        values, _ = self._read(numbers, self.grid)
        return tuple(one for side in self.sides for one in self._cut(side, side.way * values[side.signal]))

    def heights(self, numbers: Mapping[str, float], windows: Sequence[Window]) -> tuple[Array, Array]:
        """The highest in each window, SI, and its derivatives with respect to the numbers: (windows, parameters).

        Raises AssemblyError where the design cannot be assembled at every angle.
        """
        grid = self.grid
        values, _ = self._read(numbers, grid)
        ends = np.array([self._between(one, one.side.way * values[one.side.signal]) for one in windows]).reshape(-1, 2)
        step = grid[1] - grid[0]
        nodes = grid[0] + step * (np.mean(ends, axis=1)[:, None] + 0.5 * np.ptp(ends, axis=1)[:, None] * NODES)
        values, slopes = self._read(numbers, nodes.ravel())
        heights, gradients = np.empty(len(windows)), np.empty((len(windows), len(numbers)))
        for row, one in enumerate(windows):
            here = slice(row * len(NODES), (row + 1) * len(NODES))
            name = one.side.signal
            curves = one.side.way * np.vstack([values[name][here], slopes[name][:, here]])
            heights[row], *gradients[row] = _highest(curves)
        return heights, gradients

    def _read(self, numbers: Mapping[str, float], angle: Array) -> tuple[dict[str, Array], dict[str, Array]]:
        """Signals and their derivatives (parameters, angles), by name."""
        names = tuple(dict.fromkeys(side.signal for side in self.sides))
        values, slopes = signal_gradients(self.mechanism, numbers, names, angle, speed=self.motion.speed)
        if not (np.all(np.isfinite(values)) and np.all(np.isfinite(slopes))):
            raise AssemblyError(f"'{self.mechanism.linkage.name}' stands in a dead position")
        return dict(zip(names, values, strict=True)), dict(zip(names, slopes, strict=True))

    def _cut(self, side: SignalExtreme, values: Array) -> list[Window]:
        count, cyclic = len(values), self.motion.is_full_turn
        before, after = np.roll(values, 1), np.roll(values, -1)
        if not cyclic:
            before[0] = after[-1] = -np.inf
        tops = np.flatnonzero((values > before) & (values >= after))
        tops = np.sort(tops[np.argsort(-values[tops], kind="stable")][:MOST])
        if len(tops) == 0:
            return [Window(side, 0, count - 1)]
        ends = [*tops, tops[0] + count] if cyclic else tops
        cuts = [low + int(np.argmin(values[np.arange(low, high + 1) % count])) for low, high in pairwise(ends)]
        edges = [cuts[-1] - count, *cuts] if cyclic else [0, *cuts, count - 1]
        return [Window(side, int(low), int(high)) for low, high in pairwise(edges)]

    def _between(self, window: Window, values: Array) -> tuple[float, float]:
        """The neighbours of the highest sample within a window, in steps of the grid."""
        samples = np.arange(window.first, window.last + 1)
        top = int(samples[int(np.argmax(values[samples % len(values)]))])
        return max(top - 1, window.first), min(top + 1, window.last)


def _highest(curves: Array) -> Array:
    """Curves over ``NODES`` where the first of them is highest, by the polynomials through them."""
    coefficients = chebyshev.chebfit(NODES, curves.T, DEGREE)
    first = coefficients[:, 0]
    best = float(FINE[int(np.argmax(chebyshev.chebval(FINE, first)))])
    slope, bend = chebyshev.chebder(first), chebyshev.chebder(first, 2)
    for _ in range(4):  # Newton's method towards where the slope is zero
        down = float(chebyshev.chebval(best, bend))
        if not down < 0.0:
            break
        best = float(np.clip(best - chebyshev.chebval(best, slope) / down, -1.0, 1.0))
    return np.asarray(chebyshev.chebval(best, coefficients))
