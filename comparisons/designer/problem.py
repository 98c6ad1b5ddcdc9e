"""The optimisation problem: a figure of a linkage, bounded numbers of its file as variables, constraints on figures.

The highest of several maxima has a kink where two of them tie, which is where most least peaks lie. Each
maximum for itself is smooth, so that an optimiser of smooth problems can bound them all.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from analytic.description.changes import SPEED
from analytic.designs.derivatives import signal_gradients, signal_values
from analytic.designs.figures import Figure, Reduction, SignalExtreme, part_figure
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.arrays import Array, Integers
from analytic.numerics.refine import Tops, climb
from analytic.signals import MAGNITUDE, OUTPUT_COORDINATE, is_angle
from comparisons.designer.parameters import NamedFigure, Parameter, SteadyCase, named_figures

FEWEST_ANGLES: Final = 360  # crank angles at which signals are sampled
MOST_WINDOWS: Final = (
    12  # local maxima of one signal with separate windows; beyond these the lowest share a neighbour's window
)

ALLOWED_EXCESS: Final = 1e-9  # share of its size by which a figure may violate its constraint


class SampleWindow(NamedTuple):
    """A window on one ``side`` of a signal: the samples ``first`` to ``last`` of the grid, by index, both included.

    Over a full turn an index may be negative or beyond the grid: it counts modulo the number of samples.
    """

    side: SignalExtreme
    first: int
    last: int


def effective_reduction(figure: Figure) -> Reduction:
    """The reduction that an optimiser bounds: the figure's own, but ``RANGE`` for the largest or the peak of S.

    S counts from its farthest place, so that its largest is its range.
    """
    is_range = figure.signal == "S" and figure.reduction in (Reduction.PEAK, Reduction.MAX)
    return Reduction.RANGE if is_range else figure.reduction


def sides(figure: Figure) -> tuple[SignalExtreme, ...]:
    """The sides of a signal, highest and lowest, whose maxima make a figure; () where it is smooth by itself.

    So are a mean, a value at an angle, a link's angle, and the least S. A peak is the highest maximum of both sides, of
    a magnitude that of the upper one; the maxima of a range's two sides add up. S is replaced by the output's
    coordinate.
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
    """Local maxima of some ``sides`` of signals, for any design of a linkage at a steady speed.

    ``numbers`` of a design are SI values by the names of parameters.
    """

    case: SteadyCase
    sides: tuple[SignalExtreme, ...]

    @property
    def grid(self) -> Array:
        """Evenly spaced crank angles (n,), rad or m: over a full turn without its end, else over the whole range."""
        count = max(FEWEST_ANGLES, len(self.case.places))
        if self.case.is_full_turn:
            return np.linspace(0.0, self.case.linkage.load_period, count, endpoint=False)
        return np.linspace(self.case.places[0], self.case.places[-1], count)

    def windows(self, numbers: Mapping[str, float]) -> tuple[SampleWindow, ...]:
        """The motion of a design cut, for every side in its order, into windows around its highest maxima, one in each.

        A side has at most MOST_WINDOWS, and at least one. Raises AssemblyError where the design cannot be assembled at
        every angle of the grid, or stands in a dead position.
        """
        values = self._values(numbers, self._signals, self.grid)
        return tuple(
            window
            for side in self.sides
            for window in self._cut_windows(side, side.way * values[self._signals.index(side.signal)])
        )

    def heights(self, numbers: Mapping[str, float], windows: Sequence[SampleWindow]) -> tuple[Array, Array]:
        """The maximum in each window (windows,), SI, and its derivatives by the design's numbers (windows, parameters).

        Maxima are refined between the samples. That of a lowest side has the other sign. Raises AssemblyError where the
        design cannot be assembled at every angle, or stands in a dead position.
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
            """Heights (tops, n), SI, of the windows numbered ``top`` (tops,) at crank angles (tops, n), rad or m."""
            seen = self._values(numbers, names, places.ravel()).reshape(len(names), *places.shape)
            return np.asarray(ways[top, None] * seen[rows[top], np.arange(len(top))])

        _, places = climb(tops, heights)
        every = np.arange(len(windows))
        case = self.case
        values, slopes = signal_gradients(case.mechanism, numbers, names, places, speed=case.speed, at_tops=True)
        if not np.all(np.isfinite(slopes)):
            raise self._dead_position_error
        return ways * values[rows, every], ways[:, None] * slopes[rows, :, every]

    @property
    def _signals(self) -> tuple[str, ...]:
        """Names of the signals of all sides, each once."""
        return tuple(dict.fromkeys(side.signal for side in self.sides))

    @property
    def _dead_position_error(self) -> AssemblyError:
        """A new error to raise for a design that stands in a dead position."""
        return AssemblyError(f"'{self.case.linkage.name}' stands in a dead position")

    def _values(self, numbers: Mapping[str, float], names: Sequence[str], angle: Array) -> Array:
        """Signals (names, angles), SI, of a design at ``angle``, rad or m.

        Raises AssemblyError where it cannot be assembled or stands in a dead position.
        """
        values = signal_values(self.case.mechanism, numbers, names, angle, speed=self.case.speed)
        if not np.all(np.isfinite(values)):
            raise self._dead_position_error
        return values

    def _cut_windows(self, side: SignalExtreme, values: Array) -> list[SampleWindow]:
        """The windows of one side, whose height over the grid is ``values`` (n,), each around a highest maximum.

        There are at most MOST_WINDOWS, in the grid's order. They are cut at the minima between; without a maximum the
        whole grid is one.
        """
        count, cyclic = len(values), self.case.is_full_turn
        before, after = np.roll(values, 1), np.roll(values, -1)
        if not cyclic:
            before[0] = after[-1] = -np.inf
        tops = np.flatnonzero((values > before) & (values >= after))
        tops = np.sort(tops[np.argsort(-values[tops], kind="stable")][:MOST_WINDOWS])
        if len(tops) == 0:
            return [SampleWindow(side, 0, count - 1)]
        ends = [*tops, tops[0] + count] if cyclic else tops
        cuts = [low + int(np.argmin(values[np.arange(low, high + 1) % count])) for low, high in pairwise(ends)]
        edges = [cuts[-1] - count, *cuts] if cyclic else [0, *cuts, count - 1]
        return [SampleWindow(side, int(low), int(high)) for low, high in pairwise(edges)]


def _bracket_top(window: SampleWindow, values: Array) -> Array:
    """Three neighbouring samples, by index, ascending, with the window's highest one of ``values`` over the grid.

    It is the middle one, unless it lies at an end of the window, which has three samples or more and is not left. As
    in the window, an index may lie beyond the grid.
    """
    samples = np.arange(window.first, window.last + 1)
    top = int(samples[int(np.argmax(values[samples % len(values)]))])
    middle = max(min(top, window.last - 1), window.first + 1)
    return np.array([middle - 1, middle, middle + 1])


class Variable(NamedTuple):
    """A number that may differ between bounds, SI."""

    parameter: Parameter
    low: float
    high: float


class Constraint(NamedTuple):
    """A figure that stays between two values, SI, or at one; an open end is infinite."""

    figure: NamedFigure
    low: float
    high: float

    @property
    def is_equal(self) -> bool:
        """Whether the range is a single value."""
        return self.low == self.high

    @property
    def words(self) -> str:
        """The value, or the ends of the range, in words, in the file's unit, unnamed: "at 30", "from 29.9 to 30.1"."""
        if self.is_equal:
            return f"at {self.low / self.figure.unit.size:.6g}"
        ends = (("from", self.low), ("to", self.high))
        return " ".join(f"{word} {end / self.figure.unit.size:.6g}" for word, end in ends if math.isfinite(end))

    def violation(self, value: Array) -> Array:
        """The distance of values, SI, from the range, outside of it; 0 inside; in their shape."""
        return np.maximum(np.maximum(self.low - value, value - self.high), 0.0)


# A number of a design and its derivatives by the variables stand in a row, (1 + variables,), several in a matrix.


def shifted(rows: Array, by: float) -> Array:
    """A copy of rows (n, 1 + variables) of values with derivatives, with ``by`` added to the values."""
    return np.column_stack([rows[:, 0] + by, rows[:, 1:]])


class Pieces(NamedTuple):
    """A figure as ``sign`` times the highest of smooth values, ``rows`` (k, 1 + variables)."""

    sign: float
    rows: Array

    @property
    def top(self) -> Array:
        """The row of the highest value, (1, 1 + variables)."""
        return self.rows[[int(np.argmax(self.rows[:, 0]))]]

    def bounded_by(self, sign: float) -> Array:
        """Rows of smooth values, with derivatives, whose highest is ``sign``, 1 or -1, times the figure.

        They are all pieces if it is the figure's own ``sign``, else the highest one alone, negative.
        """
        return self.rows if sign == self.sign else -self.top


class Linearised(NamedTuple):
    """A design: scaled values with their derivatives by its place, in rows (n, 1 + variables) of three kinds.

    The highest of ``aim`` is what is minimised; ``inside`` have to be 0 or more, ``equal`` have to be 0.
    """

    aim: Array
    inside: Array
    equal: Array

    @property
    def violation(self) -> float:
        """The largest violation of a constraint, as a share of its size; 0 if all hold."""
        return float(max(np.max(-self.inside[:, 0], initial=0.0), np.max(np.abs(self.equal[:, 0]), initial=0.0)))


@dataclass(frozen=True)
class DesignProblem:
    """Minimise the largest of the ``aims``, or with ``sign`` -1 maximise the least, over ``variables``.

    Designs are points (variables,) between 0 and 1, the bounds. ``aim_size`` and ``constraint_sizes``, SI, by which
    aims and constraints are divided, are those of the file's design.
    """

    case: SteadyCase
    aims: tuple[NamedFigure, ...]
    sign: float
    variables: tuple[Variable, ...]
    constraints: tuple[Constraint, ...]
    aim_size: float
    constraint_sizes: tuple[float, ...]

    @property
    def figures(self) -> tuple[NamedFigure, ...]:
        """The figures of aims, then those of constraints."""
        return (*self.aims, *(figure.figure for figure in self.constraints))

    @cached_property
    def maxima(self) -> LocalMaxima:
        """The finder of local maxima of all sides of signals that the aims and constraints need."""
        every = [side for figure in self.figures for side in sides(figure.figure)]
        return LocalMaxima(self.case, tuple(dict.fromkeys(every)))

    @cached_property
    def low(self) -> Array:
        """The lower bound of each variable, SI, (variables,)."""
        return np.array([variable.low for variable in self.variables])

    @cached_property
    def width(self) -> Array:
        """The distance of each variable's bounds, SI, (variables,)."""
        return np.array([variable.high - variable.low for variable in self.variables])

    def numbers(self, place: Array) -> dict[str, float]:
        """The numbers, SI, by name of the design at a place (variables,), 0 to 1 between the bounds, not beyond."""
        values = np.clip(self.low + self.width * place, self.low, self.low + self.width)
        return dict(zip((variable.parameter.name for variable in self.variables), values.tolist(), strict=True))

    def windows(self, place: Array) -> tuple[SampleWindow, ...]:
        """Windows around the local maxima of the design at a place (variables,), () if no figure has any.

        Raises AssemblyError where that design cannot be assembled.
        """
        return self.maxima.windows(self.numbers(place)) if self.maxima.sides else ()

    def linearise(self, place: Array, windows: tuple[SampleWindow, ...]) -> Linearised:
        """Aim and constraints of the design at a place (variables,), with a row for each maximum in ``windows``.

        Derivatives are by the place. Raises AssemblyError where the design cannot be assembled.
        """
        pieces = self._pieces_of_figures(place, windows)
        aims = [piece.bounded_by(self.sign) for piece in pieces[: len(self.aims)]]
        none = np.empty((0, 1 + len(self.variables)))
        inside, equal = [none], [none]
        for figure, entry, size in zip(self.constraints, pieces[len(self.aims) :], self.constraint_sizes, strict=True):
            if figure.is_equal:
                equal.append(shifted(entry.sign * entry.top, -figure.low) / size)
                continue
            for sign, bound in ((1.0, figure.high), (-1.0, -figure.low)):
                if np.isfinite(bound):
                    inside.append(shifted(-entry.bounded_by(sign), bound) / size)
        return Linearised(np.vstack(aims) / self.aim_size, np.vstack(inside), np.vstack(equal))

    def _pieces_of_figures(self, place: Array, windows: tuple[SampleWindow, ...]) -> list[Pieces]:
        """The pieces of every aim, then of every constraint, in their order, at a place (variables,); SI, unscaled.

        Maxima are looked for in ``windows``. Raises AssemblyError where the design cannot be assembled.
        """
        numbers = self.numbers(place)
        heights: dict[SignalExtreme, Array] = {}
        if windows:
            values, slopes = self.maxima.heights(numbers, windows)
            rows = np.column_stack([values, slopes * self.width])
            heights = {side: rows[[window.side == side for window in windows]] for side in self.maxima.sides}
        smooth: dict[NamedFigure, Pieces] = {}
        plain = [figure for figure in self.figures if not sides(figure.figure)]
        if plain:
            values, slopes = self.case.gradients(numbers, plain)
            rows = np.column_stack([values, slopes * self.width])
            smooth = {figure: Pieces(1.0, rows[[number]]) for number, figure in enumerate(plain)}
        return [smooth.get(figure) or _figure_pieces(figure.figure, heights) for figure in self.figures]

    def sample_designs(self, places: Array, angles: Array) -> Array:
        """Scaled aim, the less the better, and sum of scaled violations of designs: (2, designs).

        They are at ``places`` (designs, variables), 0 to 1 between the bounds. Nan where a design cannot be assembled;
        extremes are those of the sampled ``angles``, rad or m.
        """
        values = self.low + self.width * places
        named = {variable.parameter.name: values[:, column] for column, variable in enumerate(self.variables)}
        array = replace(self.case, places=angles).figures(named, self.figures, refine=False)
        aim = np.max(self.sign * array[: len(self.aims)], axis=0) / self.aim_size
        missed = [figure.violation(row) / size for figure, row, size in
                  zip(self.constraints, array[len(self.aims) :], self.constraint_sizes, strict=True)]  # fmt: skip
        return np.array([aim, np.sum(missed, axis=0) if missed else np.zeros(len(places))])


def _figure_pieces(figure: Figure, heights: Mapping[SignalExtreme, Array]) -> Pieces:
    """The pieces of a figure, from the rows (n, 1 + variables) of each side's local maxima.

    Those of a range are all sums of a maximum of the upper side and one of the lower.
    """
    parts = [heights[side] for side in sides(figure)]
    if effective_reduction(figure) is Reduction.RANGE:
        up, down = parts
        return Pieces(1.0, (up[:, None] + down[None]).reshape(-1, up.shape[1]))
    return Pieces(-1.0 if figure.reduction is Reduction.MIN else 1.0, np.vstack(parts))


# Bounds and constraints as typed: ``rod.B.x=170:180``, ``rod.B.x=±10%``, ``stroke=29.9:30.1``.

PERCENT_RANGE: Final = re.compile(r"\s*(?:±|\+-|\+/-)\s*(?P<percent>\d+\.?\d*|\.\d+)\s*%\s*")
NOT_NEGATIVE: Final = ("mass", "inertia")


def variables(case: SteadyCase, texts: Sequence[str]) -> tuple[Variable, ...]:
    """The numbers to vary, with their bounds, from texts as typed; one may be the driver's speed.

    Raises LinkproofError for none, for malformed bounds and for one named twice, UnknownNameError for a name. A text is
    ``rod.B.x=170:180`` or ``rod.B.x=±10%``.
    """
    if not texts:
        raise LinkproofError("expected numbers to vary, got none: name them with their bounds, --over rod.B.x=170:180")
    result: dict[str, Variable] = {}
    for text in texts:
        name, mark, bounds = text.rpartition("=")
        if not mark:
            raise LinkproofError(f"--over: expected NAME=LOW:HIGH or NAME=±10%, got '{text}'; correct it")
        number = case.parameter(name.strip())
        if number.name in result:
            raise LinkproofError(f"--over: expected each number once, got {number.name} twice; leave one out")
        result[number.name] = Variable(number, *_bounds(number, bounds))
    return tuple(result.values())


def _bounds(number: Parameter, text: str) -> tuple[float, float]:
    """Lower and upper bound of a number, SI, from the typed text, ``170:180`` or ``±10%``.

    Raises LinkproofError for another text, bounds upside down, and bounds that a mass, an inertia or a speed cannot
    have.
    """
    share = PERCENT_RANGE.fullmatch(text)
    if share is not None:
        part = 0.01 * float(share["percent"])
        low, high = sorted((number.value * (1.0 - part), number.value * (1.0 + part)))
    else:
        ends = text.split(":")
        if len(ends) != 2:
            raise LinkproofError(f"--over {number.name}: expected LOW:HIGH or ±10%, got '{text}'; correct it")
        low, high = map(number.si, ends)
    if not low < high:
        about = f"; {number.name} is {number.value / number.unit.size:g}" if share else ""
        raise LinkproofError(f"--over {number.name}: expected LOW below HIGH, got '{text}'{about}; correct it")
    if number.kind in NOT_NEGATIVE and low < 0.0:
        raise LinkproofError(f"--over {number.name}: expected bounds that are not negative, got '{text}'; correct it")
    if number.kind == SPEED and low <= 0.0:
        raise LinkproofError(
            f"--over speed: expected bounds above 0, got '{text}'; a negative --speed turns the other way"
        )
    return low, high


def constraint_texts(mechanism: Mechanism, texts: Iterable[str]) -> dict[NamedFigure, str | None]:
    """The constrained figures of typed texts, each with that of its range; None if the file's value is to stay.

    A text is ``stroke=29.9:30.1`` or ``stroke``; of two for one figure the later counts. Raises LinkproofError for an
    unknown figure.
    """
    result: dict[NamedFigure, str | None] = {}
    for text in texts:
        name, mark, values = text.rpartition("=")
        has_values = bool(mark) and not part_figure(text)[1].startswith(
            "."
        )  # else the sign is one of the figure's name
        figures = named_figures(mechanism, [(name if has_values else text).strip()])
        result |= dict.fromkeys(figures, values if has_values else None)
    return result


def constraint(figure: NamedFigure, text: str | None, file_value: float) -> Constraint:
    """A constraint to a typed value or range, either end of which may be open; to ``file_value``, SI, for None.

    A text is ``30``, ``29.9:30.1``, ``29.9:`` or ``:30.1``, in the file's unit or one of its own. Raises LinkproofError
    for another one and for a range upside down.
    """
    if text is None:
        return Constraint(figure, file_value, file_value)
    ends = text.split(":")
    open_ends = zip(ends, (-math.inf, math.inf), strict=False)
    numbers = [figure.si(end) if end.strip() else open_end for end, open_end in open_ends]
    low, high = numbers * 2 if len(ends) == 1 else numbers[:2] if len(ends) == 2 else (math.nan, math.nan)
    if len(ends) == 1 and not text.strip():
        low = math.nan
    if not low <= high or low == -high == -math.inf:
        raise LinkproofError(
            f"--keep {figure.name}: expected LOW:HIGH, LOW:, :HIGH or a value, got '{text}'; correct it, "
            "or give the name alone to keep what the file has"
        )
    return Constraint(figure, low, high)
