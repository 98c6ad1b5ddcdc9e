"""The optimisation problem: a figure of a linkage, bounded numbers of its file as variables, constraints on figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.designs.figures import Figure, Reduction, SignalExtreme
from analytic.designs.results import design_figures
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.named_figures import NamedFigure
from comparisons.designs.optimum.local_maxima import LocalMaxima, Window, reduction, sides
from comparisons.designs.parameters import Parameter
from comparisons.designs.steady_motion import SteadyMotion

Array = NDArray[np.float64]

ALLOWED_EXCESS: Final = 1e-9  # share of its size by which a figure may violate its constraint


class Variable(NamedTuple):
    """A number that may differ between bounds, SI."""

    parameter: Parameter
    low: float
    high: float


class Constraint(NamedTuple):
    """A figure that stays between two values, SI, or at one."""

    figure: NamedFigure
    low: float
    high: float

    @property
    def is_equal(self) -> bool:
        """Whether the range is a single value."""
        return self.low == self.high

    def missed(self, value: Array) -> Array:
        """By how much values are out of it, 0 where they are not."""
        return np.maximum(np.maximum(self.low - value, value - self.high), 0.0)


class Pieces(NamedTuple):
    """A figure as ``sign`` times the highest of smooth values (k,), with their derivatives (k, variables)."""

    sign: float
    values: Array
    slopes: Array

    @property
    def top(self) -> tuple[Array, Array]:
        """The highest alone: (1,), (1, variables)."""
        here = slice(best := int(np.argmax(self.values)), best + 1)
        return self.values[here], self.slopes[here]

    @property
    def value(self) -> float:
        """The figure."""
        return self.sign * float(np.max(self.values))

    def below(self, sign: float) -> tuple[Array, Array]:
        """Values whose highest is ``sign`` times the figure: all the pieces, or the negative of the highest."""
        if sign == self.sign:
            return self.values, self.slopes
        values, slopes = self.top
        return -values, -slopes


class Linearised(NamedTuple):
    """A design: what the aim has to be above, and what has to be positive or zero, with their derivatives; scaled."""

    aim: Array
    aim_slopes: Array
    inside: Array
    inside_slopes: Array
    equal: Array
    equal_slopes: Array

    @property
    def missed(self) -> float:
        """The largest relative violation of a constraint."""
        return float(max(np.max(-self.inside, initial=0.0), np.max(np.abs(self.equal), initial=0.0)))


@dataclass(frozen=True)
class DesignProblem:
    """Minimise the largest of the ``aims``, or with ``sign`` -1 maximise the least, over ``variables``.

    Designs are points between 0 and 1, the bounds. Sizes are those of the design ``start`` from the file.
    """

    mechanism: Mechanism
    motion: SteadyMotion
    aims: tuple[NamedFigure, ...]
    sign: float
    variables: tuple[Variable, ...]
    constraints: tuple[Constraint, ...]
    aim_size: float
    constraint_sizes: tuple[float, ...]

    @property
    def figures(self) -> tuple[NamedFigure, ...]:
        """The aims and the constrained figures."""
        return (*self.aims, *(figure.figure for figure in self.constraints))

    @cached_property
    def maxima(self) -> LocalMaxima:
        """Finds the local maxima of every signal side that an aim or a constraint is made of, for any design."""
        every = [side for figure in self.figures for side in sides(figure.figure)]
        return LocalMaxima(self.mechanism, self.motion, tuple(dict.fromkeys(every)))

    @cached_property
    def low(self) -> Array:
        """Lower bounds, SI."""
        return np.array([variable.low for variable in self.variables])

    @cached_property
    def width(self) -> Array:
        """The bounds' distances, SI."""
        return np.array([variable.high - variable.low for variable in self.variables])

    def numbers(self, place: Array) -> dict[str, float]:
        """A design's numbers, SI."""
        values = np.clip(self.low + self.width * place, self.low, self.low + self.width)
        return dict(zip((variable.parameter.name for variable in self.variables), values.tolist(), strict=True))

    def windows(self, place: Array) -> tuple[Window, ...]:
        """Windows around a design's local maxima; raises AssemblyError."""
        return self.maxima.windows(self.numbers(place)) if self.maxima.sides else ()

    def at(self, place: Array, windows: tuple[Window, ...]) -> Linearised:
        """The design at a place, with the same local maxima for the same windows; raises AssemblyError."""
        pieces = self._pieces(place, windows)
        aims = [piece.below(self.sign) for piece in pieces[: len(self.aims)]]
        inside, equal = [], []
        for figure, entry, size in zip(self.constraints, pieces[len(self.aims) :], self.constraint_sizes, strict=True):
            if figure.is_equal:
                values, slopes = entry.top
                equal.append(((entry.sign * values - figure.low) / size, entry.sign * slopes / size))
                continue
            for sign, bound in ((1.0, figure.high), (-1.0, -figure.low)):
                if np.isfinite(bound):
                    values, slopes = entry.below(sign)
                    inside.append(((bound - values) / size, -slopes / size))
        values, slopes = self._stacked(aims)
        return Linearised(values / self.aim_size, slopes / self.aim_size, *self._stacked(inside), *self._stacked(equal))

    def _stacked(self, parts: list[tuple[Array, Array]]) -> tuple[Array, Array]:
        if not parts:
            return np.empty(0), np.empty((0, len(self.variables)))
        return np.concatenate([values for values, _ in parts]), np.vstack([slopes for _, slopes in parts])

    def _pieces(self, place: Array, windows: tuple[Window, ...]) -> list[Pieces]:
        numbers = self.numbers(place)
        heights: dict[SignalExtreme, tuple[Array, Array]] = {}
        if windows:
            values, slopes = self.maxima.heights(numbers, windows)
            for side in self.maxima.sides:
                rows = [row for row, window in enumerate(windows) if window.side == side]
                heights[side] = values[rows], slopes[rows] * self.width
        plain = [figure.figure for figure in self.figures if not sides(figure.figure)]
        smooth = {}
        if plain:
            values, slopes = self.motion.gradients(self.mechanism, numbers, plain)
            smooth = {
                figure: Pieces(1.0, values[[row]], slopes[[row]] * self.width) for row, figure in enumerate(plain)
            }
        return [
            smooth[figure.figure] if figure.figure in smooth else _made(figure.figure, heights)
            for figure in self.figures
        ]

    def sampled(self, places: Array, angles: Array) -> Array:
        """Scaled aim and violation of the constraints of many designs (designs, variables): (2, designs).

        Nan where a design cannot be assembled; extremes are those of the sampled angles.
        """
        values = self.low + self.width * places
        named = {variable.parameter.name: values[:, column] for column, variable in enumerate(self.variables)}
        figures = [figure.figure for figure in self.figures]
        array = design_figures(self.mechanism, named, figures, angles, speed=self.motion.speed)
        aim = np.max(self.sign * array[: len(self.aims)], axis=0) / self.aim_size
        missed = [figure.missed(row) / size for figure, row, size in
                  zip(self.constraints, array[len(self.aims) :], self.constraint_sizes, strict=True)]  # fmt: skip
        return np.array([aim, np.sum(missed, axis=0) if missed else np.zeros(len(places))])


def _made(figure: Figure, heights: Mapping[SignalExtreme, tuple[Array, Array]]) -> Pieces:
    """A figure from the local maxima of its sides."""
    parts = [heights[side] for side in sides(figure)]
    if reduction(figure) is Reduction.RANGE:
        (up, up_slopes), (down, down_slopes) = parts
        slopes = up_slopes[:, None] + down_slopes[None]
        return Pieces(1.0, (up[:, None] + down[None]).ravel(), slopes.reshape(-1, slopes.shape[-1]))
    sign = -1.0 if figure.reduction is Reduction.MIN else 1.0
    return Pieces(sign, np.concatenate([values for values, _ in parts]), np.vstack([values for _, values in parts]))
