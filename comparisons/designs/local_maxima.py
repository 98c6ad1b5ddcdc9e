"""Local maxima of signals of one design, with derivatives, each over a window of the motion of its own.

The highest of several maxima has a kink where two of them tie, which is where most least peaks lie. Each
maximum for itself is smooth, so that an optimiser of smooth problems can bound them all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.designs.derivatives import signal_gradients, signal_values
from analytic.designs.figures import Figure, Reduction, SignalExtreme
from analytic.errors import AssemblyError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.refine import Integers, Tops, climb
from analytic.signals import MAGNITUDE, OUTPUT_COORDINATE, is_angle
from comparisons.designs.parameters import SteadyMotion

Array = NDArray[np.float64]

FEWEST_ANGLES: Final = 360  # crank angles at which signals are sampled
MOST_WINDOWS: Final = (
    12  # local maxima of one signal with separate windows; beyond these the lowest share a neighbour's window
)


class Window(NamedTuple):
    """Samples ``first`` to ``last`` of the grid, those beyond its ends a turn on, on a side of a signal."""

    side: SignalExtreme
    first: int
    last: int


def effective_reduction(figure: Figure) -> Reduction:
    """The reduction that an optimiser bounds: S counts from its farthest place, so that its largest is its range."""
    is_range = figure.signal == "S" and figure.reduction in (Reduction.PEAK, Reduction.MAX)
    return Reduction.RANGE if is_range else figure.reduction


def sides(figure: Figure) -> tuple[SignalExtreme, ...]:
    """The sides of a signal, highest and lowest, whose maxima make a figure: a range and a peak have both, means none.

    A peak is the highest maximum of both; those of a range's two sides add up.
    """
    name, how = figure.signal, effective_reduction(figure)
    if (name != "phi" and is_angle(name)) or (name == "S" and how is Reduction.MIN):
        return ()  # they count from the other requested angles
    if name == "S":  # counts from its farthest place, so that its range is the coordinate's
        name = OUTPUT_COORDINATE
    up, down = SignalExtreme(name, 1), SignalExtreme(name, -1)
    if how is Reduction.PEAK:
        return (up,) if name.endswith(MAGNITUDE) else (up, down)
    return replace(figure, signal=name, reduction=how).extremes


@dataclass(frozen=True)
class LocalMaxima:
    """Local maxima of some ``sides`` of signals, for any design of a mechanism under a steady motion."""

    mechanism: Mechanism
    motion: SteadyMotion
    sides: tuple[SignalExtreme, ...]

    @property
    def grid(self) -> Array:
        """Evenly spaced crank angles, rad or m."""
        count = max(FEWEST_ANGLES, len(self.motion.places))
        if self.motion.is_full_turn:
            return np.linspace(0.0, FULL_TURN, count, endpoint=False)
        return np.linspace(self.motion.places[0], self.motion.places[-1], count)

    def windows(self, numbers: Mapping[str, float]) -> tuple[Window, ...]:
        """The motion of a design cut at the minima between its maxima, for every side."""
        values = self._values(numbers, self._signals, self.grid)
        return tuple(
            window
            for side in self.sides
            for window in self._cut_windows(side, side.way * values[self._signals.index(side.signal)])
        )

    def heights(self, numbers: Mapping[str, float], windows: Sequence[Window]) -> tuple[Array, Array]:
        """The maximum in each window (windows,), SI, and its derivatives by the design's numbers (windows, parameters).

        Raises AssemblyError where the design cannot be assembled at every angle.
        """
        grid, names = self.grid, self._signals
        rows = np.array([names.index(window.side.signal) for window in windows])
        ways = np.array([window.side.way for window in windows])
        sampled = self._values(numbers, names, grid)
        near = np.array(
            [_bracket_top(window, window.side.way * sampled[row]) for window, row in zip(windows, rows, strict=True)]
        )
        own = ways[:, None] * sampled[rows[:, None], near % len(grid)]
        tops = Tops(np.arange(len(windows)), grid[0] + (grid[1] - grid[0]) * near, own)

        def heights(top: Integers, places: Array) -> Array:
            seen = self._values(numbers, names, places.ravel()).reshape(len(names), *places.shape)
            return np.asarray(ways[top, None] * seen[rows[top], np.arange(len(top))])

        _, places = climb(tops, heights)
        every = np.arange(len(windows))
        values, slopes = signal_gradients(self.mechanism, numbers, names, places, speed=self.motion.speed)
        if not np.all(np.isfinite(slopes)):
            raise self._dead_position_error
        return ways * values[rows, every], ways[:, None] * slopes[rows, :, every]

    @property
    def _signals(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(side.signal for side in self.sides))

    @property
    def _dead_position_error(self) -> AssemblyError:
        return AssemblyError(f"'{self.mechanism.linkage.name}' stands in a dead position")

    def _values(self, numbers: Mapping[str, float], names: Sequence[str], angle: Array) -> Array:
        """Signals (names, angles), SI, of a design; raises AssemblyError where it stands in a dead position."""
        values = signal_values(self.mechanism, numbers, names, angle, speed=self.motion.speed)
        if not np.all(np.isfinite(values)):
            raise self._dead_position_error
        return values

    def _cut_windows(self, side: SignalExtreme, values: Array) -> list[Window]:
        """Windows of one side, one around each of its highest maxima, cut at the minima between them."""
        count, cyclic = len(values), self.motion.is_full_turn
        before, after = np.roll(values, 1), np.roll(values, -1)
        if not cyclic:
            before[0] = after[-1] = -np.inf
        tops = np.flatnonzero((values > before) & (values >= after))
        tops = np.sort(tops[np.argsort(-values[tops], kind="stable")][:MOST_WINDOWS])
        if len(tops) == 0:
            return [Window(side, 0, count - 1)]
        ends = [*tops, tops[0] + count] if cyclic else tops
        cuts = [low + int(np.argmin(values[np.arange(low, high + 1) % count])) for low, high in pairwise(ends)]
        edges = [cuts[-1] - count, *cuts] if cyclic else [0, *cuts, count - 1]
        return [Window(side, int(low), int(high)) for low, high in pairwise(edges)]


def _bracket_top(window: Window, values: Array) -> Array:
    """Three samples in a row within a window, or beside it, of which one is its highest."""
    samples = np.arange(window.first, window.last + 1)
    top = int(samples[int(np.argmax(values[samples % len(values)]))])
    middle = max(min(top, window.last - 1), window.first + 1)
    return np.array([middle - 1, middle, middle + 1])
