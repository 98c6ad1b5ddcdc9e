"""The instants at which a motion is looked at, every signal of a case at them, and their refined peaks; SI."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final, Literal, TypeVar

import numpy as np

from analytic import signals
from analytic.description.crank_motion import CrankMotion, Standstill
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.written import finite
from analytic.dynamics.reduced import load_corners
from analytic.errors import LinkproofError
from analytic.kinematics.sweep import transmission_angle
from analytic.numerics.arrays import Array, Integers, distinct
from analytic.numerics.averages import averages
from analytic.numerics.refine import highest_each
from analytic.numerics.roots import root, roots
from comparisons.designer.open_ends import OpenEnd, open_ends
from comparisons.motion.case import Case, DriverMotion, Truth

STEP: Final = math.radians(0.5)  # of the crank, between two instants
LINEAR_STEPS: Final = 720  # over the travel of a drive along a line
FEWEST, MOST = 180, 20_000  # intervals of the whole motion
FEWEST_OF_PIECE: Final = 24
MOTION_SAMPLES, FEWEST_PIECE_SAMPLES = (
    1801,
    65,
)  # instants at which the way of the crank is measured: of a motion, and of a piece of it
ROUNDING: Final = 1e-12  # of a turn, or of the motion's length: what is nearer than this to an instant is there
# Between two instants the sine of a transmission angle changes by no more than this share of itself: the forces go as
# its inverse. Next to such a change, too, for its least value may lie between two that are equal.
CHANGE: Final = 0.2
HALVINGS: Final = 14
MOST_ADDED: Final = 4000  # instants added

Measure = Callable[[Truth], Array]
Key = TypeVar("Key", bound=Hashable)

TIME: Final = "time"
TRANSMISSION: Final = "transmission_angle:"
DIRECTION: Final = ":direction"  # of a force in place of its magnitude
BATCH: Final = 192  # curves whose peaks are refined together: more would compute much that none of them needs
CELL: Final = 16  # steps of the grid to a cell of a mean


@dataclass(frozen=True)
class Instants:
    """A motion seen over time, or over φ where the crank turns at constant speed.

    ``turns`` marks an angle, of which whole turns do not count, not a travel.
    """

    motion: DriverMotion
    turns: bool = True

    @cached_property
    def is_steady(self) -> bool:
        """Whether φ is the axis: the crank turns at one speed all the time, or the motion is a Standstill."""
        if isinstance(self.motion, Standstill):
            return True
        time = np.linspace(0.0, self.motion.duration, FEWEST)
        speed = self.motion.speed(time)
        return bool(speed[0] and not np.any(self.motion.acceleration(time)) and np.all(speed == speed[0]))

    @property
    def axis(self) -> Literal["phi", "time"]:
        """The name of the axis: "phi" if the motion ``is_steady``, else "time"."""
        return "phi" if self.is_steady else "time"

    @cached_property
    def grid(self) -> Array:
        """Instants over the whole motion, s, ascending; just before and just after each jump of the acceleration.

        Every piece of the motion has its own even grid, so that a short stroke after a long dwell is resolved as well.
        """
        jumps = [jump for jump in self.motion.jumps if 0.0 < jump < self.motion.duration]
        edges = self._edges(jumps)
        counts = self._intervals(edges)
        ends = zip(pairwise(edges), counts, strict=True)
        pieces = [np.linspace(start, end, count + 1) for (start, end), count in ends]
        return distinct(np.concatenate([*pieces, np.nextafter(jumps, 0.0)]))

    def _edges(self, jumps: list[float]) -> list[float]:
        """The instants, s, ascending, between which the motion has its pieces.

        They are its ``jumps``, its segments' starts and both ends.
        """
        segments = self.motion.segments if isinstance(self.motion, CrankMotion) else ()
        return sorted({0.0, self.motion.duration, *jumps, *(segment.start for segment in segments)})

    def _intervals(self, edges: list[float]) -> list[int]:
        """The number of intervals of each piece between ``edges``, s, by the crank's way in it.

        There are 2 or more in each, and in all about FEWEST to MOST.
        """
        looks = max(MOTION_SAMPLES // len(edges), FEWEST_PIECE_SAMPLES)
        angles = [self.motion.angle(np.linspace(start, end, looks)) for start, end in pairwise(edges)]
        step = STEP if self.turns else float(np.ptp(np.concatenate(angles))) / LINEAR_STEPS or 1.0
        ways = [float(np.sum(np.abs(np.diff(angle)))) / step for angle in angles]
        counts = [max(math.ceil(way * (1.0 - ROUNDING)), FEWEST_OF_PIECE) if way else 2 for way in ways]
        total = sum(counts)
        scale = max(1.0, FEWEST / total) * min(1.0, MOST / total)
        return [max(math.ceil(count * scale * (1.0 - ROUNDING)), 2) for count in counts]

    def checked_times(self, times: Array) -> Array:
        """Instants (n,), s, that a user asks for, moved to the motion's ends where rounding puts them beyond.

        Raises LinkproofError for one that the motion does not have.
        """
        duration = self.motion.duration
        for time in times:
            if not -ROUNDING * duration <= time <= duration * (1.0 + ROUNDING):
                raise LinkproofError(
                    f"--time: expected instants from 0 to {duration:g} s, the motion's, got {time:g}; choose others"
                )
        return np.clip(times, 0.0, duration)

    def times_of_angles(self, angles: Array, unit: str, size: float) -> Array:
        """The instants, s, (n,), at which the crank first passes these angles, given in a ``unit`` of a ``size``, SI.

        ``unit`` is for messages alone, as it follows a number: "°". Raises LinkproofError for an angle that it does not
        pass. Of a turning crank whole turns do not count.
        """
        return np.array([self._first_passing(float(angle), unit, size) for angle in angles])

    def _first_passing(self, angle: float, unit: str, size: float) -> float:
        """The first instant, s, at the angle, given in a ``unit`` of a ``size``, SI, whole turns aside.

        Raises LinkproofError if it is never passed.
        """
        time, target = self.grid, angle * size
        away = self._periods_from(time, target)
        hits = np.flatnonzero(np.abs(away - np.round(away)) <= ROUNDING)
        passed = np.flatnonzero(np.floor(away[1:]) != np.floor(away[:-1]))
        low, high = (float(end(self.motion.angle(time))) for end in (np.min, np.max))
        is_outside = not self.turns and not low - self._slack <= target <= high + self._slack
        if is_outside or not (len(hits) or len(passed)):
            turns = " and whole turns more or less" if self.turns else ""
            raise LinkproofError(
                f"--at: expected values that the motion passes, from {low / size:.6g}{unit} to {high / size:.6g}{unit}"
                f"{turns}, got {angle:.6g}{unit}; choose others, or another motion"
            )
        first = float(time[hits[0]]) if len(hits) else math.inf
        if len(passed) and time[passed[0]] < first:
            step = slice(passed[0], passed[0] + 2)
            level = np.max(np.floor(away[step]))  # the whole number that it passes
            return root(lambda t: float(self._periods_from(np.array([t]), target)[0] - level), *time[step].tolist())
        return first

    @property
    def _slack(self) -> float:
        """How near, rad or m, two places of the driver are one: the rounding of a period."""
        return ROUNDING * self._period

    @cached_property
    def _period(self) -> float:
        """A turn, rad; for a travel, which has no period, a length, m, longer than its way."""
        return FULL_TURN if self.turns else 4.0 * (float(np.ptp(self.motion.angle(self.grid))) or 1.0)

    def _periods_from(self, time: Array, target: float) -> Array:
        """φ less ``target``, rad or m, at instants (n,), s, in periods, signed and with its fraction."""
        return np.asarray((self.motion.angle(time) - target) / self._period)


def refine_near_toggles(case: Case, grid: Array) -> Array:
    """The grid of instants, s, with more of them where a transmission angle changes fast, as near toggles.

    At most MOST_ADDED are added. Raises AssemblyError where the linkage cannot be assembled at one.
    """
    time, sines = grid, _transmission_sines(case, grid)
    for _ in range(HALVINGS):
        middles = _missing_middles(time, sines)
        if not len(middles) or len(time) + len(middles) > len(grid) + MOST_ADDED:
            break
        places = np.searchsorted(time, middles)
        time = np.insert(time, places, middles)
        sines = np.insert(sines, places, _transmission_sines(case, middles), axis=1)
    return time


def _transmission_sines(case: Case, time: Array) -> Array:
    """Sines of the transmission angles of all dyads at instants (n,), s: (dyads, n)."""
    sweep = case.mechanism.sweep(case.motion.angle(time))
    sines = [np.sin(transmission_angle(sweep, dyad)) for dyad in case.mechanism.structure.dyads]
    return np.reshape(sines, (-1, len(time)))


def _missing_middles(time: Array, sines: Array) -> Array:
    """Middles, s, of the steps of a grid in which, or next to which, a transmission angle's sine changes too much.

    ``time`` (n,) is the grid, s, ``sines`` are (dyads, n). Too much is more than CHANGE of the smaller one.
    """
    coarse = np.any(np.abs(np.diff(sines)) > CHANGE * np.minimum(sines[:, 1:], sines[:, :-1]), axis=0)
    wide = np.convolve(coarse, [True, True, True], mode="same").astype(bool)
    middles = 0.5 * (time[1:] + time[:-1])
    return np.asarray(middles[wide & (middles > time[:-1]) & (middles < time[1:])])


# Which samples show long curves.

MOST_MISSED: Final = 1e-3  # of a signal's largest magnitude, by which a straight line between two instants may miss it
ROUNDS: Final = 6


def choose_samples(axis: Array, curves: Array, few: int, most: int) -> Integers:
    """Indices of the samples of curves (k, n) over ``axis`` (n,), ascending, that are enough to draw them.

    ``few`` are evenly spaced, both ends among them; of the others, up to ``most`` in all, those that straight lines
    between the chosen ones miss by most. Infinite values and nan count as 0.
    """
    even = np.linspace(axis[0], axis[-1], min(few, len(axis)))
    places = distinct(np.append(np.abs(np.searchsorted(0.5 * (axis[1:] + axis[:-1]), even)), len(axis) - 1))
    shown = np.nan_to_num(curves, nan=0.0, posinf=0.0, neginf=0.0)
    shown = shown / np.maximum(np.max(np.abs(shown), axis=1, keepdims=True), np.finfo(float).tiny)
    for _ in range(ROUNDS):
        lines = np.array([np.interp(axis, axis[places], curve[places]) for curve in shown])
        missed = np.max(np.abs(lines - shown), axis=0)
        worst = np.array([low + int(np.argmax(missed[low : high + 1])) for low, high in pairwise(places)])
        worst = worst[missed[worst] > MOST_MISSED]
        worst = worst[np.argsort(-missed[worst])][: most - len(places)]
        if not len(worst):
            break
        places = distinct(np.append(places, worst))
    return places


@dataclass(frozen=True)
class SignalFigure:
    """A number of a designer: ``what`` it is, of a force the link it acts ``on``, its signal, value and SI unit.

    ``time``, s, and ``phi``, rad, of a drive along a line m, are its place; None for a mean. A value that is not
    finite, as a joint's force at a change point, is None. ``joint_force:A:direction``, rad, is no signal of the closed
    form. ``at_open_end`` marks an extreme that says no more than where the motion was cut off beside a dead position.
    """

    what: str
    signal: str
    value: float | None
    unit: str
    on: str = ""
    time: float | None = None
    phi: float | None = None
    at_open_end: bool = False


@dataclass(frozen=True)
class Curves:
    """The signals of a case by name: those of ``analytic.signals``, the time, and magnitudes of forces.

    A magnitude is ``joint_force:A:magnitude``, or ``shaking_force:magnitude``. A measure is a function of a Truth at n
    instants that returns (n,).
    """

    case: Case

    @cached_property
    def instants(self) -> Instants:
        """The Instants of the case's motion, which choose where it is computed."""
        return Instants(self.case.motion, turns=not self.linkage.is_linear)

    @property
    def linkage(self) -> Linkage:
        """The case's linkage."""
        return self.case.mechanism.linkage

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all signals: the time first, and magnitudes after the components of their vectors."""
        return (TIME, *signals.names_with_magnitudes(self.case.mechanism))

    @cached_property
    def open_ends(self) -> tuple[OpenEnd, ...]:
        """The ends of the motion beside a dead position, where extremes only tell where it was cut off.

        () without any.
        """
        return open_ends(self.case.mechanism, *self.case.reach)

    def unit(self, name: str) -> str:
        """SI unit of a signal or of "time", by its name; raises KeyError for an unknown kind."""
        return "s" if name == TIME else signals.unit(name, self.linkage)

    @cached_property
    def grid(self) -> Array:
        """Instants over the whole motion, s: the even grid, more near dead positions, and the loads' corners."""
        return distinct(np.append(refine_near_toggles(self.case, self.instants.grid), self.corners))

    @cached_property
    def corners(self) -> Array:
        """The instants (n,), s, at which the drive passes a corner of a load over φ, one corner after the other.

        Peaks are there, and means change.
        """
        time = self.instants.grid
        angle = self.case.motion.angle(time)
        places = load_corners(self.case.mechanism, float(np.min(angle)), float(np.max(angle)))
        row, step = np.nonzero((angle[:-1] < places[:, None]) != (angle[1:] < places[:, None]))
        low, high = time[step], time[step + 1]
        return roots(lambda at: self.case.motion.angle(at) - places[row], low, low, high)

    @cached_property
    def on_grid(self) -> Truth:
        """The closed form at all instants of ``grid``."""
        return self.truth_at(self.grid)

    def truth_at(self, time: Array) -> Truth:
        """The closed form of the case at instants (n,), s, each part computed on request, none of it cached here."""
        return Truth(self.case.mechanism, self.case.motion, time)

    def values(self, names: Iterable[str], time: float) -> tuple[float, ...]:
        """Values, SI, of the signals ``names`` at one instant, s, in their order; raises UnknownNameError."""
        truth = self.truth_at(np.array([time]))
        return tuple(float(self.signal_values(truth, name)[0]) for name in names)

    def signal_values(self, truth: Truth, name: str) -> Array:
        """A signal (n,), SI, of the closed form at n instants, cached on the grid.

        A link's angle is unwrapped along the motion. Raises UnknownNameError for a signal that the linkage lacks,
        AssemblyError where it cannot make the motion.
        """
        if name == TIME:
            return truth.time
        known = self._known if truth is self.on_grid else {}
        if name not in known:
            values = signals.signal(truth, name)
            is_link_angle = signals.is_angle(name) and name != "phi"
            known[name] = self._unwrapped(name, truth, values) if is_link_angle else values
        return known[name]

    @cached_property
    def _known(self) -> dict[str, Array]:
        """The cache of signals on the grid, by name, empty at first."""
        return {}

    def table(self, truth: Truth, names: Iterable[str] = ()) -> dict[str, Array]:
        """Signals (n,), SI, of the closed form at n instants, by name, in the order of ``names``; all by default.

        Raises UnknownNameError for a signal that the linkage lacks.
        """
        return {name: self.signal_values(truth, name) for name in names or self.names}

    def _unwrapped(self, name: str, truth: Truth, angle: Array) -> Array:
        """The ``angle`` (n,), rad, of a link's signal ``name`` at the truth's instants, unwrapped along the motion."""
        near = np.interp(truth.time, self.grid, signals.signal(self.on_grid, name))
        return np.asarray(angle + FULL_TURN * np.round((near - angle) / FULL_TURN))

    def figure(self, what: str, name: str, value: float, time: float | None = None, on: str = "") -> SignalFigure:
        """The key figure ``what`` of a signal, or of a force's direction, with its value, SI, and instant, s, if any.

        ``on`` is the link on which a force acts. A value that is not finite becomes None. It is marked if it lies at an
        open end, but for signals of the drive and directions.
        """
        phi = None if time is None else float(self.case.motion.angle(np.array([time]))[0])
        unit = "rad" if name.endswith(DIRECTION) else self.unit(name)
        at_end = phi is not None and any(end.has(phi) for end in self.open_ends)
        is_given = name in signals.DRIVE or name.endswith(DIRECTION)
        return SignalFigure(what, name, finite(value), unit, on, time, phi, at_end and not is_given)

    def peaks(self, names: Iterable[str]) -> dict[str, SignalFigure]:
        """The peak of each signal, between instants too: the largest magnitude, of a transmission angle the least.

        Each is a figure "peak", whose value has its sign, by the signal's name.
        """
        places = self.places({name: self._severity(name) for name in names})
        truth = self.truth_at(np.array([*places.values()]))
        values = [float(self.signal_values(truth, name)[row]) for row, name in enumerate(places)]
        return {n: self.figure("peak", n, value, places[n]) for n, value in zip(places, values, strict=True)}

    def _severity(self, name: str) -> Measure:
        """The measure that is highest at a signal's peak: its magnitude, or the negative transmission angle.

        It maps the closed form at n instants to (n,).
        """
        if name.startswith(TRANSMISSION):
            return lambda at: -self.signal_values(at, name)
        return lambda at: np.abs(self.signal_values(at, name))

    def places(self, measures: Mapping[Key, Measure]) -> dict[Key, float]:
        """The instant, s, at which each measure of the closed form is highest, refined beyond the grid, by its key."""
        numbers: dict[Key, float] = {}
        names = list(measures)
        for keys in (names[start : start + BATCH] for start in range(0, len(names), BATCH)):
            chosen = [measures[key] for key in keys]

            def curves(rows: Integers, time: Array, chosen: Sequence[Measure] = chosen) -> Array:
                """The measures numbered ``rows`` among ``chosen`` at instants (n,), s: (rows, n)."""
                truth = self.truth_at(time)
                return np.stack([chosen[row](truth) for row in rows])

            sampled = np.stack([measure(self.on_grid) for measure in chosen])
            _, places = highest_each(curves, self.grid, sampled)
            numbers |= dict(zip(keys, places.tolist(), strict=True))
        return numbers

    def means(self, *measures: Measure) -> list[float]:
        """Means over time, over the whole motion, of these measures of the closed form, in their order."""
        jumps = [jump for jump in self.case.motion.jumps if 0.0 < jump < self.grid[-1]]

        def integrands(_: object, time: Array) -> Array:
            """The measures at instants, s, of any shape, in the form that ``averages`` calls: (measures, *shape)."""
            truth = self.truth_at(time.ravel())
            return np.stack([measure(truth).reshape(time.shape) for measure in measures])

        edges = distinct(np.concatenate([self.grid[::CELL], jumps, self.corners, self.grid[-1:]]))
        return [float(mean) for (mean,) in averages(integrands, edges)]
