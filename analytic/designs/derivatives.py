"""Derivatives of a design's signals and figures by numbers of its description, exact where there is a closed form.

The formulas of the closed form are given numbers that carry their derivatives (``analytic.numerics.dual``). An extreme
moves with the numbers, but since the signal is level there only its value counts: its derivative is that of the signal
at the place of the extreme, which is a root of the signal's slope over φ. Where two equal tops have
different derivatives it is nan.

Linkages with groups of a higher class, with a driving cylinder or with change points have central differences instead,
extrapolated to a step of zero; see ``is_exact``.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import SPEED, design_numbers, with_numbers
from analytic.description.linkage import Linkage
from analytic.designs.figures import SQUARE, Figure, Reduction, SignalExtreme
from analytic.designs.results import is_turn, period_of
from analytic.designs.sampled_figures import FigureRequest, mean_cells, unwrapped_near
from analytic.designs.sampled_signals import checked_parameters, speed_of
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism, once_per_mechanism
from analytic.kinematics.structure import Structure
from analytic.kinematics.sweep import Sweep
from analytic.machine_code import is_traceable
from analytic.numerics.averages import averages
from analytic.numerics.dual import Dual
from analytic.numerics.refine import ROUNDING, grid, tops
from analytic.numerics.roots import roots
from analytic.signals import OUTPUT_COORDINATE, MovingSweep, is_angle, signal

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
LinkageAndStructure = tuple[Linkage, Structure]

TIE: Final = 1e-9  # of a signal's largest value: tops that differ by less count as equal
STEP: Final = 4e-4  # of a number, the first of its differences
SAME: Final = 1e-6  # relative: derivatives at such tops that differ by less count as equal


def is_exact(mechanism: Mechanism) -> bool:
    """Whether derivatives are exact; else they are differences."""
    return is_traceable(mechanism)


def signal_values(
    mechanism: Mechanism, parameters: Mapping[str, float], signals: Sequence[str], angle: Array, *, speed: float
) -> Array:
    """Signals of one design (signals, angles), SI, as ``signal_gradients`` has them.

    Raises AssemblyError where the design cannot be assembled.
    """
    sweep = _design(mechanism, parameters, speed).plain_sweep(angle)
    _check_moves(sweep)
    zero_of_s = float(np.max(sweep.output())) if "S" in signals else 0.0
    at = MovingSweep(mechanism, sweep, np.asarray(speed_of(parameters, speed)), np.asarray(0.0), zero_of_s)
    return np.stack([signal(at, name) for name in signals])


def signal_gradients(
    mechanism: Mechanism, parameters: Mapping[str, float], signals: Sequence[str], angle: ArrayLike, *, speed: float
) -> tuple[Array, Array]:
    """Signals (signals, angles) and their derivatives (signals, parameters, angles), SI, at crank angles (angles,).

    ``parameters`` are numbers of the description by the names of ``analytic.description.changes``, or the driver's
    ``speed``, turned as ``speed``, with the SI values at which to differentiate; a signal may be a magnitude, as in a
    ``Figure``. S counts from the highest of the angles. The crank turns at a constant ``speed``, rad/s, signed. Raises
    UnknownNameError, LinkproofError for numbers that no design can have, and AssemblyError where the design cannot be
    assembled.
    """
    places = np.asarray(angle, dtype=float)
    _check(mechanism, parameters)
    if not is_exact(mechanism):

        def curves_of(numbers: Mapping[str, float]) -> Array:
            return signal_values(mechanism, numbers, signals, places, speed=speed)

        return differences(curves_of, parameters, _steps(mechanism, parameters))[:2]
    design = _design(mechanism, parameters, speed)
    design.check(places)
    zero_of_s = design.farthest(places, refine=False) if "S" in signals else 0.0
    at = design.varied(places, zero_of_s)
    pairs = [_values_and_slopes(signal(at, name), len(parameters)) for name in signals]
    return np.stack([value for value, _ in pairs]), np.stack([slopes for _, slopes in pairs])


def figure_gradients(
    mechanism: Mechanism,
    parameters: Mapping[str, float],
    figures: Sequence[Figure],
    angle: ArrayLike,
    *,
    speed: float,
    refine: bool = True,
) -> tuple[Array, Array]:
    """Figures (figures,) and their derivatives (figures, parameters), SI.

    ``angle``, ``speed`` and ``refine`` are as for ``analytic.designs.results.design_figures``, and
    ``parameters`` as for ``signal_gradients``. The derivative is nan where equal tops have different derivatives.
    """
    places = np.asarray(angle, dtype=float)
    _check(mechanism, parameters)
    if not is_exact(mechanism):
        _check_moves(_design(mechanism, parameters, speed).plain_sweep(places))
        period = period_of(mechanism, places)
        return _figure_differences(FigureRequest(mechanism, tuple(figures), places, speed, period, refine), parameters)
    design = _design(mechanism, parameters, speed)
    design.check(places)
    zero_of_s = design.farthest(places, refine) if any(quantity.signal == "S" for quantity in figures) else 0.0
    ends = tuple(dict.fromkeys(end for quantity in figures for end in quantity.extremes))
    top_of = dict(zip(ends, design.extremes(ends, places, zero_of_s, refine), strict=True))
    single = design.varied(
        np.array([quantity.angle for quantity in figures if quantity.reduction is Reduction.AT]), zero_of_s
    )
    averaged = [quantity for quantity in figures if quantity.is_mean]
    top = design.farthest(places, refine=True) if any(quantity.signal == "S" for quantity in averaged) else zero_of_s
    means = design.means(averaged, places, top)
    values, gradients, row = np.empty(len(figures)), np.empty((len(figures), len(parameters))), 0
    for number, figure in enumerate(figures):
        if figure.reduction is Reduction.AT:
            value, slopes = (
                part[..., row] for part in _values_and_slopes(signal(single, figure.signal), len(parameters))
            )
            row += 1
        elif figure.extremes:
            tops = [top_of[end] for end in figure.extremes]
            value, slopes = tops[0] if len(tops) == 1 else tuple(a - b for a, b in zip(*tops, strict=True))
        else:
            value, slopes = means[figure]
        sign = -1.0 if figure.is_magnitude and value < 0.0 else 1.0
        values[number], gradients[number] = sign * value, sign * slopes
    return values, gradients


def _figure_differences(request: FigureRequest, parameters: Mapping[str, float]) -> tuple[Array, Array]:
    """Figures and their derivatives by numerical differences, where the closed form has no exact ones."""

    # Differences about a mass of zero need a mass just below zero, so nothing is checked here.
    def figures_of(numbers: Mapping[str, float]) -> Array:
        return request.values_for({name: np.array([value]) for name, value in numbers.items()})[:, 0]

    return differences(figures_of, parameters, _steps(request.mechanism, parameters))[:2]


@once_per_mechanism
def _latest_designs(_: Mechanism) -> dict[object, _Design]:
    """The design of a mechanism that was asked for last, by its numbers: an optimiser asks for each several times."""
    return {}


def _design(mechanism: Mechanism, parameters: Mapping[str, float], speed: float) -> _Design:
    """The design with these numbers."""
    latest, key = _latest_designs(mechanism), (*parameters.items(), speed)
    if key not in latest:
        latest.clear()
        latest[key] = _Design(mechanism, dict(parameters), speed)
    return latest[key]


@dataclass(frozen=True)
class _Design:
    """One design: as plain numbers, and as numbers that carry their derivatives by the parameters."""

    mechanism: Mechanism
    parameters: Mapping[str, float]
    speed: float

    @cached_property
    def plain(self) -> LinkageAndStructure:
        """The design's linkage and structure in plain numbers."""
        return self._linkage_with_numbers(self.parameters)

    @cached_property
    def _numbers_with_slopes(self) -> dict[str, Dual]:
        seeds = np.eye(len(self.parameters))
        return {n: Dual(v, seed) for (n, v), seed in zip(self.parameters.items(), seeds, strict=True)}

    @cached_property
    def _with_derivatives(self) -> LinkageAndStructure:
        return self._linkage_with_numbers(self._numbers_with_slopes)

    def _linkage_with_numbers(self, numbers: Mapping[str, Any]) -> LinkageAndStructure:
        linkage = with_numbers(self.mechanism.linkage, numbers)
        signs = tuple(dyad.sign for dyad in self.mechanism.structure.dyads)
        return linkage, find_structure(linkage).with_signs(signs)

    def _moving(self, model: LinkageAndStructure, angle: Any, zero_of_s: Any) -> MovingSweep:  # noqa: ANN401 - plain or dual
        """The design in motion at crank angles, rad; S counts from the coordinate ``zero_of_s``, m."""
        speed = speed_of(self._numbers_with_slopes if model is self._with_derivatives else self.parameters, self.speed)
        return MovingSweep(self.mechanism, self.sweep(model, angle), speed, np.asarray(0.0), zero_of_s)

    def check(self, places: Array) -> None:
        """Raise AssemblyError where the design has no motion at one of the places."""
        _check_moves(self.plain_sweep(places))

    @cached_property
    def _followed(self) -> Mechanism:
        """The design by itself, for a mechanism whose assembly modes have to be followed."""
        return self.mechanism.redesigned(with_numbers(self.mechanism.linkage, self.parameters))

    def plain_sweep(self, places: Array) -> Sweep:
        """The design at crank angles, rad, in plain numbers."""
        return self.sweep(self.plain, places) if is_exact(self.mechanism) else self._followed.sweep(places)

    def sweep(self, model: LinkageAndStructure, angle: Any) -> Sweep:  # noqa: ANN401 - plain or dual
        """The design at crank angles, rad."""
        is_plain = model is self.plain
        return Sweep(*model, angle, zero_of_s=lambda: self._zero_of_s.value if is_plain else self._zero_of_s)

    @property
    def _mechanism_of_loads(self) -> Mechanism:
        """A mechanism in which loads have their corners where they have them in this design."""
        moves = self.mechanism.linkage.has_loads_of_output
        return self.mechanism.redesigned(self.plain[0]) if moves else self.mechanism

    @cached_property
    def _zero_of_s(self) -> Dual:
        """The output's coordinate at the top dead centre, m, from which loads over S count, with its derivatives."""
        return self.farthest(grid(), refine=True)

    def varied(self, places: Array, zero_of_s: Any) -> MovingSweep:  # noqa: ANN401 - a dual
        """The design in motion at crank angles, rad, in numbers that carry their derivatives."""
        return self._moving(self._with_derivatives, places, zero_of_s)

    def farthest(self, places: Array, refine: bool) -> Dual:
        """The output's highest coordinate, with its derivatives."""
        ((value, slopes),) = self.extremes((SignalExtreme(OUTPUT_COORDINATE, 1),), places, 0.0, refine)
        return Dual(value, slopes)

    def extremes(
        self,
        extremes: Sequence[SignalExtreme],
        places: Array,
        zero_of_s: Any,  # noqa: ANN401 - a dual
        refine: bool,
    ) -> list[tuple[Array, Array]]:
        """Value of every extreme and its derivatives (parameters,)."""
        if not extremes:
            return []
        grid = _with_period_end(places, self.mechanism.linkage.load_period) if refine else places
        top = zero_of_s.value if isinstance(zero_of_s, Dual) else zero_of_s
        plain = self._moving(self.plain, grid, top)
        sampled = np.stack([signal_extreme.height(signal(plain, signal_extreme.signal)) for signal_extreme in extremes])
        curve, places = self._find_tops(extremes, grid, sampled, top, refine)
        at = self.varied(places, zero_of_s)
        tops = []
        for row, extreme in enumerate(extremes):
            values, slopes = _values_and_slopes(signal(at, extreme.signal), len(self.parameters))
            is_its = curve == row
            tops.append(
                _highest_top(
                    extreme, values[is_its], slopes[:, is_its], places[is_its], float(np.max(np.abs(sampled[row])))
                )
            )
        return tops

    def means(self, figures: Sequence[Figure], places: Array, zero_of_s: Any) -> dict[Figure, tuple[Any, Array]]:  # noqa: ANN401 - a dual
        """Value of every mean and its derivatives (parameters,): the integrals of both, in one."""
        known, count = self._moving(self.plain, places, 0.0), len(self.parameters)
        near = {quantity.signal: signal(known, quantity.signal) for quantity in figures if is_angle(quantity.signal)}

        def integrands(_: object, phi: Array) -> Array:
            """Integrands of the means and their derivatives, and reciprocals of the determinants for spikes."""
            at = self.varied(phi, zero_of_s)
            curves = [(quantity, signal(at, quantity.signal)) for quantity in figures]
            turned = [
                quantity.integrand(unwrapped_near(row, phi, places, near.get(quantity.signal)))
                for quantity, row in curves
            ]
            pairs = [_values_and_slopes(row, count) for row in turned]
            sizes = [_values_and_slopes(abs(at.sweep.determinant(dyad)), 0)[0] for dyad in at.sweep.structure.dyads]
            spikes = [1.0 / np.broadcast_to(size, phi.shape) for size in sizes]
            return np.stack([*(row for value, slopes in pairs for row in (value, *slopes)), *spikes])

        ends = _with_period_end(places, self.mechanism.linkage.load_period)
        means = averages(integrands, mean_cells(ends, self._mechanism_of_loads))[:, 0].tolist() if figures else []
        result = {}  # behind the figures are the determinants
        for figure, first in zip(figures, range(0, len(means), count + 1), strict=False):
            value, slopes = figure.of_mean(means[first]), np.array(means[first + 1 : first + 1 + count])
            if figure.reduction is Reduction.RMS:  # none is below zero, where it is level or has a kink
                slopes = 0.5 * slopes / value if value else np.zeros(count)
            result[figure] = value, slopes
        return result

    def _find_tops(
        self, extremes: Sequence[SignalExtreme], grid: Array, sampled: Array, top: float, refine: bool
    ) -> tuple[Integers, Array]:
        """The tops of all extremes' heights: number of the extreme, and angle, rad; sampled ones without ``refine``."""
        if not refine:
            return np.arange(len(extremes)), grid[np.argmax(sampled, axis=1)]
        sampled_tops = tops(sampled)

        def slope(angle: Array) -> Array:
            """Slope of each top's own height over φ."""
            at = self._moving(self.plain, Dual(angle, np.ones((1, len(angle)))), top)
            rises = np.empty(angle.shape)
            for number, extreme in enumerate(extremes):
                values, slopes = _values_and_slopes(signal(at, extreme.signal), 1)
                is_its = sampled_tops.curve == number
                rises[is_its] = (extreme.side(values) * slopes[0])[is_its]
            return rises

        left, right = sampled_tops.bounds(len(grid) - 1)
        return sampled_tops.curve, roots(slope, grid[left], grid[sampled_tops.best], grid[right])


def differences(
    function: Callable[[Mapping[str, float]], Array], point: Mapping[str, float], steps: Mapping[str, float]
) -> tuple[Array, Array, Array]:
    """Values of a function of named numbers, derivatives (values, numbers, ...) and their errors, as estimated.

    Central differences over a step, a half and a quarter of it, extrapolated; the last two extrapolations differ by the
    error.
    """
    slopes, errors = [], []
    for name, value in point.items():
        rows = []
        for size in (steps[name], 0.5 * steps[name], 0.25 * steps[name]):
            high, low = (function({**point, name: value + side * size}) for side in (1.0, -1.0))
            rows.append((high - low) / (2.0 * size))
        once = [(4.0 * fine - coarse) / 3.0 for coarse, fine in itertools.pairwise(rows)]
        slopes.append((16.0 * once[1] - once[0]) / 15.0)
        errors.append(np.abs(slopes[-1] - once[1]))
    return function(point), np.stack(slopes, axis=1), np.stack(errors, axis=1)


def _steps(mechanism: Mechanism, parameters: Mapping[str, float]) -> dict[str, float]:
    """Steps of differences: a share of the number, of the drawing for a length of zero, of one for any other zero."""
    every = {**design_numbers(mechanism.linkage), SPEED: (SPEED, parameters.get(SPEED, 0.0))}
    chosen = {name: every[name] for name in parameters}
    sizes = {"length": mechanism.linkage.extent()}
    return {name: STEP * (abs(value) or sizes.get(kind, 1.0)) for name, (kind, value) in chosen.items()}


def _highest_top(
    extreme: SignalExtreme, values: Array, slopes: Array, places: Array, largest: float
) -> tuple[Array, Array]:
    """Value and derivatives of the highest top, of equal ones the first; nan where derivatives of equal ones differ."""
    heights, rises = extreme.height(values), extreme.side(values) * slopes
    highest = np.max(heights)
    if extreme.is_kink(highest):
        return np.asarray(SQUARE), np.zeros(len(slopes))
    first = int(np.argmin(np.where(heights >= highest - ROUNDING * largest, places, np.inf)))
    tied = rises[:, heights >= highest - TIE * largest]
    apart = np.max(tied, axis=1) - np.min(tied, axis=1) > SAME * np.max(np.abs(tied), axis=1) + TIE * largest
    return values[first], np.where(apart, np.nan, slopes[:, first])


def _values_and_slopes(number: Any, count: int) -> tuple[Array, Array]:  # noqa: ANN401 - plain or dual
    """Values and derivatives; those of a plain number are zero."""
    if isinstance(number, Dual):
        return number.value, number.full
    return number, np.zeros((count, *np.shape(number)))


def _with_period_end(places: Array, period: float) -> Array:
    """Crank angles that divide a period evenly with its end added; others as they are."""
    return np.append(places, places[0] + period) if is_turn(places, period) else places


def _check_moves(sweep: Sweep) -> None:
    """Raise AssemblyError where a design has no motion at one of the places."""
    for body in sweep.structure.bodies:
        sweep.rates(body)


def _check(mechanism: Mechanism, parameters: Mapping[str, float]) -> None:
    """Raise UnknownNameError and LinkproofError for numbers that a design cannot have."""
    checked_parameters(mechanism.linkage, {name: [value] for name, value in parameters.items()}, has_speed=True)
