"""Derivatives of a design's signals and figures by numbers of its description, exact where there is a closed form.

A signal's list of operations is gone through backward (``analytic.machine_code``). An extreme moves with the numbers,
but since the signal is level there only its value counts: its derivative is that of the signal at the place of the
extreme, which is a root of the signal's slope over φ. Where two equal tops have different derivatives it is nan.

Linkages with groups that are solved numerically, with change points or with friction have central differences instead,
extrapolated to a step of zero; see ``is_exact``.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import SPEED, design_numbers, with_numbers
from analytic.description.law import FULL_TURN
from analytic.designs.figures import SQUARE, Figure, Reduction, SignalExtreme
from analytic.designs.sampled_figures import FigureRequest, mean_cells, sampled_source, unwrapped_near
from analytic.designs.sampled_signals import checked_parameters, speed_of
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism, once_per_mechanism
from analytic.kinematics.sweep import Sweep
from analytic.machine_code import PHI, ZERO_OF_S, LinkageTrace, is_traceable, linkage_trace
from analytic.numerics.arrays import Array
from analytic.numerics.averages import averages
from analytic.numerics.refine import ROUNDING, grid, tops
from analytic.numerics.roots import roots
from analytic.signals import OUTPUT_COORDINATE, MovingSweep, is_angle, is_wrapped, signal

Integers = NDArray[np.int64]
Curve = tuple[Any, Array]  # values of a signal (...), or one, and their derivatives (k, ...)
STILL: Final[Curve] = (0.0, np.zeros(1))

AT_CORNER: Final = 1e-6  # of the drawing: a top this near to a corner of a load is there
MOST_ZEROS: Final = 64  # designs of which the zero of S is kept: a search asks for each many times
TIE: Final = 1e-9  # of a signal's largest value: tops that differ by less count as equal
STEP: Final = 4e-4  # of a number, the first of its differences
SAME: Final = 1e-6  # relative: derivatives at such tops that differ by less count as equal


def is_exact(mechanism: Mechanism) -> bool:
    """Whether derivatives are exact, as for linkages of dyads without friction and change points.

    Else they are differences.
    """
    return is_traceable(mechanism)


def signal_values(
    mechanism: Mechanism, parameters: Mapping[str, float], signals: Sequence[str], angle: Array, *, speed: float
) -> Array:
    """Signals of one design (signals, angles), SI, at crank angles (angles,), rad.

    ``parameters`` are numbers, SI, by the names of ``analytic.description.changes``, or the driver's ``speed``, turned
    as ``speed``, rad/s, signed. S counts from its largest value at these angles. Raises UnknownNameError for an unknown
    signal, LinkproofError for S without an output and where friction locks the design, AssemblyError where it cannot be
    assembled or moved.
    """
    design = _Design(mechanism, parameters, speed)
    if is_exact(mechanism):
        coordinates = design.values([OUTPUT_COORDINATE], angle) if "S" in signals else np.zeros(1)
        return np.stack(design.values(signals, angle, float(np.max(coordinates))))
    sweep = design.followed.sweep(angle)
    _check_moves(sweep)
    zero_of_s = float(np.max(sweep.output())) if "S" in signals else 0.0
    at = MovingSweep(mechanism, sweep, np.asarray(speed_of(parameters, speed)), np.asarray(0.0), zero_of_s)
    return np.stack([signal(at, name) for name in signals])


def signal_gradients(
    mechanism: Mechanism,
    parameters: Mapping[str, float],
    signals: Sequence[str],
    angle: ArrayLike,
    *,
    speed: float,
    at_tops: bool = False,
) -> tuple[Array, Array]:
    """Signals (signals, angles) and their derivatives (signals, parameters, angles), SI, at crank angles (angles,).

    The angles are in rad. ``parameters`` are numbers of the description by the names of
    ``analytic.description.changes``, or the driver's ``speed``, turned as ``speed``, with the SI values at which to
    differentiate; a signal may be a magnitude, as in a ``Figure``, but not S, which counts from the design's own top.
    The crank turns at a constant ``speed``, rad/s, signed. With ``at_tops`` the angles are tops of the signals, and one
    at a corner of a load moves with it. Raises UnknownNameError for an unknown parameter or signal, LinkproofError for
    numbers that no design can have, and AssemblyError where the design cannot be assembled or moved.
    """
    places = np.asarray(angle, dtype=float)
    _check_parameters(mechanism, parameters)
    if not is_exact(mechanism):

        def curves_of(numbers: Mapping[str, float]) -> Array:
            """The signals (signals, angles), SI, of one design with these numbers."""
            return signal_values(mechanism, numbers, signals, places, speed=speed)

        return differences(curves_of, parameters, _steps(mechanism, parameters))[:2]
    design = _Design(mechanism, parameters, speed)
    design.values(signals, places)  # refuses one without a motion
    values, slopes = zip(*(design.at_tops if at_tops else design.curves)(signals, places, STILL), strict=True)
    return np.stack(values), np.stack(slopes)


def figure_gradients(
    mechanism: Mechanism,
    parameters: Mapping[str, float],
    figures: Sequence[Figure],
    angle: Array,
    *,
    speed: float,
    period: float | None,
) -> tuple[Array, Array]:
    """Figures (figures,) and their derivatives (figures, parameters), SI.

    ``angle``, ``speed`` and ``period`` are as for ``analytic.designs.results.design_figures``, extremes are refined,
    and ``parameters`` are as for ``signal_gradients``. The derivative is nan where equal tops have different
    derivatives. Raises UnknownNameError for an unknown parameter, LinkproofError for numbers that no design can have,
    and AssemblyError where the design cannot be assembled at one of the angles.
    """
    _check_parameters(mechanism, parameters)
    request = FigureRequest(mechanism, tuple(figures), angle, speed, period, refine=True)
    if not is_exact(mechanism):
        _check_moves(_Design(mechanism, parameters, speed).followed.sweep(angle))
        return _figure_differences(request, parameters)
    design, grid = _Design(mechanism, parameters, speed), request.grid
    design.values([figure.signal for figure in figures], grid)  # refuses one without a motion
    zero_of_s = design.farthest(grid) if any(figure.signal == "S" for figure in figures) else STILL
    ends = tuple(dict.fromkeys(end for figure in figures for end in figure.extremes))
    means = design.means([figure for figure in figures if figure.is_mean], grid, zero_of_s)
    tops = zip(ends, design.extremes(ends, grid, zero_of_s), strict=True)
    known: dict[SignalExtreme | Figure, Curve] = {**dict(tops), **means}
    for figure in figures:
        if figure.reduction is Reduction.AT:
            (known[figure],) = design.curves([figure.signal], np.array(figure.angle), zero_of_s)
    values, gradients = np.empty(len(figures)), np.empty((len(figures), len(parameters)))
    for number, figure in enumerate(figures):
        parts = [known[part] for part in figure.extremes or (figure,)]
        value, slopes = parts[0] if len(parts) == 1 else tuple(a - b for a, b in zip(*parts, strict=True))
        sign = -1.0 if figure.is_magnitude and value < 0.0 else 1.0
        values[number], gradients[number] = sign * value, sign * slopes
    return values, gradients


def _figure_differences(request: FigureRequest, parameters: Mapping[str, float]) -> tuple[Array, Array]:
    """Figures (figures,) and their derivatives (figures, parameters), SI, by central differences.

    Parameters are by name, SI.
    """

    # Differences about a mass of zero need a mass just below zero, so nothing is checked here.
    def figures_of(numbers: Mapping[str, float]) -> Array:
        """The figures (figures,), SI, of one design with these numbers."""
        return request.values_for({name: np.array([value]) for name, value in numbers.items()})[:, 0]

    return differences(figures_of, parameters, _steps(request.mechanism, parameters))[:2]


@once_per_mechanism
def _zeros_of_s(_: Mechanism) -> dict[object, Curve]:
    """The cache of a mechanism, {} at first: where S counts from, by the design's numbers.

    A key has pairs of name and value, SI.
    """
    return {}


@dataclass(frozen=True)
class _Design:
    """One design: its signals and their derivatives by the parameters.

    A ``Curve`` is a signal's values (...) and their derivatives (parameters, ...). ``parameters`` are SI, by name; the
    driver's ``speed``, rad/s, is signed.
    """

    mechanism: Mechanism
    parameters: Mapping[str, float]
    speed: float

    def _list(self, signals: Iterable[str]) -> LinkageTrace:
        """The list of operations that computes these signals; in place of S the output's coordinate.

        Raises errors as ``linkage_trace`` does.
        """
        return linkage_trace(self.mechanism, self.parameters, tuple(map(sampled_source, signals)))

    def _input_values(self, listed: LinkageTrace, places: Array) -> dict[int, Any]:
        """Values of the list's inputs by line: the design's numbers, the speed, and crank angles, rad."""
        zero = {ZERO_OF_S: self._zero_of_s[0]} if ZERO_OF_S in listed.trace.inputs else {}
        return listed.values({**self.parameters, **zero}, places, speed_of(self.parameters, self.speed))

    def curves(self, signals: Sequence[str], places: Array, zero_of_s: Curve = STILL) -> list[Curve]:
        """Signals at crank angles, rad, of any shape, with their derivatives (parameters, ...), in order.

        S counts from the coordinate ``zero_of_s``, m.
        """
        listed, inputs = self._list(signals), self._list(signals).trace.inputs
        ways: list[dict[int, Any]] = [{inputs[name]: 1.0} for name in self.parameters]
        if SPEED in self.parameters:
            ways[[*self.parameters].index(SPEED)] = {inputs[SPEED]: np.sign(self.speed)}
        if ZERO_OF_S in inputs:
            ways = [way | {inputs[ZERO_OF_S]: slope} for way, slope in zip(ways, self._zero_of_s[1], strict=True)]
        return self._moved(listed, signals, places, ways, zero_of_s)

    def at_tops(self, signals: Sequence[str], places: Array, zero_of_s: Curve) -> list[Curve]:
        """Signals and derivatives as from ``curves``, at tops (n,), rad.

        One at a corner of a load over S moves with it. S counts from ``zero_of_s``.
        """
        curves = self.curves(signals, places, zero_of_s)
        corners = [corner for law in self.mechanism.linkage.laws if law.over == "S" for corner in law.corners]
        if not corners or ZERO_OF_S not in self._list(signals).trace.inputs:
            return curves
        (height, rises), (_, slope) = (
            self.curves([OUTPUT_COORDINATE], places)[0], self.over_phi([OUTPUT_COORDINATE], places, 0.0)[0]
        )  # fmt: skip
        zero, shifts = self._zero_of_s
        distances = np.abs(np.subtract.outer(corners, zero - height))
        is_corner = np.min(distances, axis=0) <= AT_CORNER * self.mechanism.linkage.extent()
        moves = np.where(is_corner, (shifts[:, None] - rises) / np.where(is_corner, slope[0], 1.0), 0.0)
        over_phi = self.over_phi(signals, places, float(zero_of_s[0]))
        pairs = zip(curves, over_phi, strict=True)
        return [(value, slopes + change[0] * moves) for (value, slopes), (_, change) in pairs]

    def over_phi(self, signals: Sequence[str], places: Array, zero_of_s: float) -> list[Curve]:
        """Signals at crank angles, rad, with their derivatives over φ, (1, ...); S counts from ``zero_of_s``, m."""
        listed = self._list(signals)
        laws = {line: name for name, line in listed.trace.inputs.items() if isinstance(name, tuple)}
        way = {line: law(places, order + 1)[component] for line, (law, order, component) in laws.items()}
        way |= {listed.trace.inputs[PHI]: 1.0}
        return self._moved(listed, signals, places, [way], (zero_of_s, np.zeros(1)))

    def _moved(
        self, listed: LinkageTrace, signals: Sequence[str], places: Array, ways: Sequence[dict[int, Any]], zero: Curve
    ) -> list[Curve]:
        """Signals at ``places``, rad, each with its change in each of the ``ways``.

        A way maps an input's line to its change; ``listed`` is the list that has the signals. S counts from ``zero``,
        m, with its own changes.
        """
        moving = {line for way in ways for line in way}
        rows = listed.trace.differentiated(listed.signals, self._input_values(listed, places), moving)
        result = []
        for name, (value, slopes) in zip(signals, rows, strict=True):
            rises = [
                sum((slopes[line] * change for line, change in way.items() if line in slopes), 0.0) for way in ways
            ]
            full = np.stack([np.broadcast_to(rise, places.shape) for rise in rises])
            if name == "S":
                full = zero[1].reshape(-1, *[1] * places.ndim) - full
            result.append((self._signal_of_line(name, value, places, zero[0]), full))
        return result

    def values(self, signals: Sequence[str], places: Array, zero_of_s: float = 0.0) -> list[Array]:
        """Signals at crank angles, rad, of any shape; S counts from the coordinate ``zero_of_s``, m.

        Raises AssemblyError where the design has no motion at one of the places.
        """
        listed = self._list(signals)
        *rows, moves = listed.trace.evaluate([*listed.signals, listed.moves], self._input_values(listed, places))
        if not np.all(moves):
            linkage = with_numbers(self.mechanism.linkage, self.parameters)
            signs = tuple(dyad.sign for dyad in self.mechanism.structure.dyads)
            _check_moves(Sweep(linkage, find_structure(linkage).with_signs(signs), places))
        return [self._signal_of_line(name, row, places, zero_of_s) for name, row in zip(signals, rows, strict=True)]

    def _signal_of_line(self, name: str, value: Any, places: Array, zero_of_s: float) -> Array:  # noqa: ANN401 - of a list
        """A signal at crank angles from its line's ``value``: S, from ``zero_of_s``, m, a link's angle unwrapped.

        All others are the value itself, in the shape of ``places``.
        """
        full = np.broadcast_to(value, places.shape)
        if name == "S":
            return zero_of_s - full
        return np.unwrap(full) if places.ndim and is_wrapped(name, self.mechanism.linkage) else full

    @cached_property
    def followed(self) -> Mechanism:
        """The design as a mechanism of its own, its dyads in the assembly modes of this mechanism's; kept.

        Raises AssemblyError or StructureError for a group of a higher class that does not meet or that the sketch
        leaves open.
        """
        return self.mechanism.redesigned(with_numbers(self.mechanism.linkage, self.parameters))

    @property
    def _mechanism_of_loads(self) -> Mechanism:
        """The mechanism whose loads have their corners at this design's crank angles.

        It is the design's own if loads depend on the output, else that of all designs.
        """
        moves = self.mechanism.linkage.has_loads_of_output
        return self.followed if moves else self.mechanism

    @property
    def _zero_of_s(self) -> Curve:
        """The output's top coordinate, m, from which loads over S count, and its derivatives.

        It is kept with the mechanism; beyond MOST_ZEROS designs, all that is kept is dropped.
        """
        known, key = _zeros_of_s(self.mechanism), tuple(self.parameters.items())
        if key not in known:
            if len(known) >= MOST_ZEROS:
                known.clear()
            known[key] = self.farthest(np.append(grid(), FULL_TURN))
        return known[key]

    def farthest(self, grid: Array) -> Curve:
        """The output's highest coordinate, m, with its derivatives, at and between the places, rad, of a grid."""
        return self.extremes((SignalExtreme(OUTPUT_COORDINATE, 1),), grid, STILL)[0]

    def extremes(self, extremes: Sequence[SignalExtreme], grid: Array, zero_of_s: Curve) -> list[Curve]:
        """The value of each extreme, refined between a grid's places, with its derivatives (parameters,), in order.

        The places are in rad; S counts from ``zero_of_s``. Raises AssemblyError where the design has no motion at one
        of them.
        """
        if not extremes:
            return []
        signals = [extreme.signal for extreme in extremes]
        rows = zip(extremes, self.values(signals, grid, zero_of_s[0]), strict=True)
        sampled = np.stack([extreme.height(values) for extreme, values in rows])
        curve, places = self._find_tops(extremes, grid, sampled, zero_of_s[0])
        result = []
        for row, (extreme, (values, slopes)) in enumerate(
            zip(extremes, self.at_tops(signals, places, zero_of_s), strict=True)
        ):
            is_its, largest = curve == row, float(np.max(np.abs(sampled[row])))
            result.append(_highest_top(extreme, values[is_its], slopes[:, is_its], places[is_its], largest))
        return result

    def means(self, figures: Sequence[Figure], grid: Array, zero_of_s: Curve) -> dict[SignalExtreme | Figure, Curve]:
        """Each mean over a grid's whole length and its derivatives (parameters,) by figure, from one integration.

        S counts from ``zero_of_s``. An RMS of 0 has derivatives of 0. {} without figures.
        """
        if not figures:
            return {}
        count, signals = len(self.parameters), [quantity.signal for quantity in figures]
        known = dict(zip(signals, self.values(signals, grid), strict=True))
        near = {name: values for name, values in known.items() if is_angle(name)}

        def integrands(_: object, phi: Array) -> Array:
            """Integrands of means and their derivatives at φ, rad, (k, *phi.shape); then reciprocals of determinants.

            With these, spikes beside dead positions are closed in on.
            """
            rows: list[Array] = []
            for quantity, (values, slopes) in zip(figures, self.curves(signals, phi, zero_of_s), strict=True):
                turned = unwrapped_near(values, phi, grid, near.get(quantity.signal))
                factor = turned if quantity.reduction is Reduction.RMS else 1.0
                rows += [quantity.integrand(turned), *(factor * slopes)]
            listed = self._list(signals)
            sizes = listed.trace.evaluate(listed.determinants, self._input_values(listed, phi))
            return np.stack([*rows, *(1.0 / np.broadcast_to(size, phi.shape) for size in sizes)])

        means = averages(integrands, mean_cells(grid, self._mechanism_of_loads))[:, 0].tolist()
        result: dict[SignalExtreme | Figure, Curve] = {}  # behind the figures are the determinants
        for figure, first in zip(figures, range(0, len(means), count + 1), strict=False):
            value, slopes = figure.of_mean(means[first]), np.array(means[first + 1 : first + 1 + count])
            if figure.reduction is Reduction.RMS:  # none is below zero, where it is level or has a kink
                slopes = slopes / value if value else np.zeros(count)
            result[figure] = value, slopes
        return result

    def _find_tops(
        self, extremes: Sequence[SignalExtreme], grid: Array, sampled: Array, top: float
    ) -> tuple[Integers, Array]:
        """The tops of all extremes' heights, as number of the extreme (n,) and angle, rad, (n,).

        ``sampled`` (extremes, n) are heights on the ``grid``, and S counts from ``top``, m.
        """
        sampled_tops = tops(sampled)

        def slope(angle: Array) -> Array:
            """Slope over φ of each top's own height, at one angle, rad, for each top (n,)."""
            rises = np.empty(angle.shape)
            curves = self.over_phi([extreme.signal for extreme in extremes], angle, top)
            for number, (extreme, (values, slopes)) in enumerate(zip(extremes, curves, strict=True)):
                is_its = sampled_tops.curve == number
                rises[is_its] = (extreme.side(values) * slopes[0])[is_its]
            return rises

        left, right = sampled_tops.bounds(len(grid) - 1)
        return sampled_tops.curve, roots(slope, grid[left], grid[sampled_tops.best], grid[right])


def differences(
    function: Callable[[Mapping[str, float]], Array], point: Mapping[str, float], steps: Mapping[str, float]
) -> tuple[Array, Array, Array]:
    """Values of a function of named numbers, derivatives (values, numbers, ...), and estimated errors of these.

    ``function`` takes all numbers by name and returns an array (values, ...); ``point`` has the numbers, ``steps`` the
    first step of each. Central differences over a step, a half and a quarter of it, extrapolated; the error is the
    difference of the last two extrapolations.
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
    """Step of differences for each number, SI, by name: a share of it or, for zero, of the drawing's size or of 1."""
    every = {**design_numbers(mechanism.linkage), SPEED: (SPEED, parameters.get(SPEED, 0.0))}
    chosen = {name: every[name] for name in parameters}
    sizes = {"length": mechanism.linkage.extent()}
    return {name: STEP * (abs(value) or sizes.get(kind, 1.0)) for name, (kind, value) in chosen.items()}


def _highest_top(
    extreme: SignalExtreme, values: Array, slopes: Array, places: Array, largest: float
) -> tuple[Array, Array]:
    """Value and derivatives (k,) of the highest top, of equal ones the first; nan where equal ones' derivatives differ.

    ``values`` (n,) and ``slopes`` (k, n) are the signal and its derivatives at the tops, ``places`` their angles, rad;
    ``largest`` is the signal's largest magnitude, against which tops count as equal. A transmission angle that reaches
    90° is π/2, with derivatives of 0.
    """
    heights, rises = extreme.height(values), extreme.side(values) * slopes
    highest = np.max(heights)
    if extreme.is_kink(highest):
        return np.asarray(SQUARE), np.zeros(len(slopes))
    first = int(np.argmin(np.where(heights >= highest - ROUNDING * largest, places, np.inf)))
    tied = rises[:, heights >= highest - TIE * largest]
    apart = np.max(tied, axis=1) - np.min(tied, axis=1) > SAME * np.max(np.abs(tied), axis=1) + TIE * largest
    return values[first], np.where(apart, np.nan, slopes[:, first])


def _check_moves(sweep: Sweep) -> None:
    """Raise AssemblyError where a design has no motion at one of the sweep's places."""
    for body in sweep.structure.bodies:
        sweep.rates(body)


def _check_parameters(mechanism: Mechanism, parameters: Mapping[str, float]) -> None:
    """Raise UnknownNameError for an unknown name, LinkproofError for numbers, SI, that no design can have."""
    checked_parameters(mechanism.linkage, {name: [value] for name, value in parameters.items()}, has_speed=True)
