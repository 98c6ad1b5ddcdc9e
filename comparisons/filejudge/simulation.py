"""The model of a simulation, of which every number and setting can be another one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.changes import changed
from analytic.description.linkage import Linkage
from analytic.dynamics.reduced import half_inertia_derivative
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.numerics.arrays import Array
from analytic.signals import signal, unit
from comparisons.filejudge.columns import SignalTimes
from comparisons.motion.case import DriverMotion, Truth
from comparisons.trials.judging.quantities import near_jumps

# What can have another value: a number of the linkage by its name, ``rod.mass``; or a knob of a column, of the crank or
# of the linkage, ``("Mkr", "scale")``, ``("crank", "pace")``, ``("linkage", "forces")``.
Target = str | tuple[str, str]
Values = Mapping[Target, Any]

CRANK: Final = "crank"
LINKAGE: Final = "linkage"
MODES: Final = (LINKAGE, "modes")  # a sign for each dyad
MOTION: Final = (CRANK, "motion")  # another one
MOTION_PARTS: Final = ("ground", "sliders", "slots", "pins", "output", "crank")  # besides the points of links
JUMPING: Final = frozenset(("N", "N m", "W", "m/s²", "rad/s²"))  # units of signals that jump with the acceleration
# A torque of inverse dynamics without a part that grows as ω², by its name in place of a signal's.
INCOMPLETE: Final[Mapping[str, Callable[[Truth], Array]]] = {
    "Mkr without ½ J′ω²": lambda at: at.torque - half_inertia_derivative(at.sweep) * at.speed**2,
    "Mkr without centrifugal forces": lambda at: at.torque + _centrifugal(at.sweep) * at.speed**2,
}
OF_MOTION: Final = frozenset(("m", "rad", "m/s", "rad/s", "m/s²", "rad/s²"))  # units of what no load concerns
LONGEST_KEPT: Final = 100_000  # instants of a sweep that is kept,
MOST_KEPT: Final = 4  # of so many
SAME_INSTANT: Final = 1e-6  # of a step: the same instant


@dataclass(frozen=True)
class ColumnKnobs:
    """What a column has: ``scale`` y(t + ``shift``) + ``offset``, where y is the signal ``of``; SI, s.

    At single instants it may have any values: ``stray``, the instants and the values there, both (n,).
    """

    of: str
    scale: float = 1.0
    offset: float = 0.0
    shift: float = 0.0
    stray: tuple[Array, Array] | None = None


@dataclass(frozen=True)
class Simulation:
    """A linkage under a motion, as the closed form has it; ``modes`` are its assembly modes, a sign each, if others.

    ``columns`` have, by name, more than the signals of their names. Results are cached.
    """

    linkage: Linkage
    motion: DriverMotion
    modes: tuple[int, ...] | None = None
    columns: Mapping[str, ColumnKnobs] = field(default_factory=dict)
    _seen: dict[tuple[str, bytes], Array] = field(default_factory=dict, init=False, compare=False, repr=False)
    _sweeps: dict[bytes, Sweep] = field(default_factory=dict, init=False, compare=False, repr=False)

    @cached_property
    def mechanism(self) -> Mechanism:
        """The closed form of the linkage, in the simulation's assembly modes."""
        mechanism = Mechanism(self.linkage)
        if self.modes is not None:
            mechanism.structure = mechanism.structure.with_signs(self.modes)
        return mechanism

    def with_values(self, values: Values) -> Simulation:
        """A copy of the simulation with these values of its targets; it shares the results that they do not concern.

        A target is the name of a number, with its value in SI, or a pair of a column, "crank" or "linkage" and one of
        its knobs or parts. Raises LinkproofError where the linkage cannot be so.
        """
        numbers = {target: float(value) for target, value in values.items() if isinstance(target, str)}
        linkage = with_numbers(self.linkage, numbers) if numbers else self.linkage
        knobs: dict[str, dict[str, Any]] = {}
        for target, value in values.items():
            if not isinstance(target, str):
                knobs.setdefault(target[0], {})[target[1]] = value
        parts, crank = knobs.pop(LINKAGE, {}), knobs.pop(CRANK, {})
        modes = parts.pop("modes", self.modes)
        motion = crank.pop("motion", self.motion)
        other = replace(
            self,
            linkage=replace(linkage, **parts) if parts else linkage,
            motion=ChangedMotion(motion, **crank) if crank else motion,
            modes=modes,
            columns={**self.columns, **{name: replace(self._knobs(name), **of) for name, of in knobs.items()}},
        )
        if modes == self.modes and _motion_parts(other.linkage) == _motion_parts(self.linkage):
            if other.linkage is self.linkage:
                other.__dict__.update(mechanism=self.mechanism, _seen=self._seen if other.motion is self.motion else {})
            else:
                other.__dict__["mechanism"] = self.mechanism.with_loads_of(other.linkage)
                if other.motion is self.motion:
                    other.__dict__.update(_seen=self._seen_of_motion(), _sweeps=self._sweeps)
        return other

    def predict(self, curves: Iterable[SignalTimes]) -> list[Array]:
        """Values (n,), SI, of each curve at its times, in their order, nan where a column has none.

        Curves on one clock share work. Raises AssemblyError where the linkage cannot make the motion, UnknownNameError
        for an unknown signal.
        """
        truths: dict[bytes, Truth] = {}
        return [self._column(curve, truths) for curve in curves]

    def concerns(self, name: str, before: Simulation) -> bool:
        """Whether the column ``name`` may differ between this simulation and one ``before``, from which it was made."""
        return self._seen is not before._seen or self.columns.get(name) is not before.columns.get(name)

    def _seen_of_motion(self) -> dict[tuple[str, bytes], Array]:
        """The known values of signals that do not depend on masses and loads, by name and clock."""
        return {key: values for key, values in self._seen.items() if _unit(key[0], self.linkage) in OF_MOTION}

    def _truth(self, time: Array, clock: bytes) -> Truth:
        """The closed form at times (n,), s.

        ``clock`` are their bytes, by which its sweep is kept for simulations with the same motion and other masses and
        loads: that of the first MOST_KEPT clocks of at most LONGEST_KEPT times.
        """
        truth = Truth(self.mechanism, self.motion, time)
        if clock in self._sweeps:
            truth.__dict__["sweep"] = self._sweeps[clock].with_loads_of(self.linkage)
        elif len(time) <= LONGEST_KEPT and len(self._sweeps) < MOST_KEPT:
            self._sweeps[clock] = truth.sweep
        return truth

    def _knobs(self, name: str) -> ColumnKnobs:
        """The changes of the column of this name; by default none."""
        return self.columns.get(name) or ColumnKnobs(name)

    def _column(self, curve: SignalTimes, truths: dict[bytes, Truth]) -> Array:
        """The values (n,), SI, of the column that ``curve`` names, at its times.

        ``truths``, to which it may add, has the closed form by its clock, for other columns too. Where a shift leads
        out of the run, or to a jump, values are nan; stray samples have their own.
        """
        knobs, time = self._knobs(curve.name), curve.time
        at = time + knobs.shift if knobs.shift else time
        clock = at.tobytes()
        if (knobs.of, clock) not in self._seen:
            if clock not in truths:
                truths[clock] = self._truth(at, clock)
            truth = truths[clock]
            formula = INCOMPLETE.get(knobs.of)
            self._seen[knobs.of, clock] = formula(truth) if formula else signal(truth, knobs.of)
        values = self._seen[knobs.of, clock]
        values = knobs.scale * values + knobs.offset if curve.name in self.columns else values
        shift = knobs.shift + (self.motion.shift if isinstance(self.motion, ChangedMotion) else 0.0)
        if shift:  # outside the run a tool may write anything
            slack = SAME_INSTANT * float(np.median(np.diff(time)))
            within = (time + shift >= time[0] - slack) & (time + shift <= time[-1] + slack)
            if knobs.shift and unit(curve.name, self.linkage) in JUMPING:
                within &= ~near_jumps(at, self.motion)
            values = np.where(within, values, np.nan)
        if knobs.stray is not None:
            values = np.where(np.isin(time, knobs.stray[0]), np.interp(time, *knobs.stray), values)
        return np.asarray(values)


def _unit(name: str, linkage: Linkage) -> str:
    """SI unit of a signal, or of an incomplete torque."""
    return "N m" if name in INCOMPLETE else unit(name, linkage)


def _centrifugal(sweep: Sweep) -> Array:
    """Power of the mass centres' centrifugal forces as if at their links' origins, at unit speed, kg m²."""
    total: Array = np.zeros(sweep.angle.shape)
    for name, link in sweep.linkage.links.items():
        (x, y), (at_x, at_y), (u, v) = sweep.centre(name), *(sweep.local_point(name, (0.0, 0.0), k) for k in (0, 1))
        total = total + link.mass * sweep.rates(name)[2] ** 2 * ((x - at_x) * u + (y - at_y) * v)
    return total


def with_numbers(linkage: Linkage, values: Mapping[str, float]) -> Linkage:
    """A copy of a linkage with other numbers, SI, by name; lengths change no masses, and unknown names nothing.

    Raises LinkproofError for two points of a link in one place.
    """
    other = changed(linkage, lambda name, _, value: values.get(name, value))
    for name, link in other.links.items():
        if len({*link.points.values()}) < len({*linkage.links[name].points.values()}):
            raise LinkproofError(f"points of '{name}': expected different places, got one twice")
    return other


def _motion_parts(linkage: Linkage) -> list[Any]:
    """The parts of a linkage on which its motion depends, to be compared with those of another one."""
    points = {name: link.points for name, link in linkage.links.items()}
    return [points, *(getattr(linkage, part) for part in MOTION_PARTS)]


@dataclass(frozen=True)
class ChangedMotion:
    """Another motion with the angle ``pace`` φ(t + ``shift``) + ``offset``, rad and s.

    Derivatives above ``order`` are 0: for 1 accelerations, for 0 speeds, too.
    """

    motion: DriverMotion
    pace: float = 1.0
    offset: float = 0.0
    shift: float = 0.0
    order: int = 2

    @property
    def regime(self) -> str:
        """Name of the regime, that of the original motion."""
        return self.motion.regime

    @property
    def duration(self) -> float:
        """Time at which the original motion ends, s."""
        return self.motion.duration

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s, whatever ``order`` leaves out."""
        return self.motion.peak_speed * abs(self.pace)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s, whatever ``order`` leaves out."""
        return tuple(jump - self.shift for jump in self.motion.jumps)

    def _clock(self, time: ArrayLike) -> Array:
        """The time of the original motion, s, at times of this one, s, in their shape."""
        return np.asarray(np.asarray(time, dtype=float) + self.shift)

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad; times in s, in their shape."""
        return np.asarray(self.pace * self.motion.angle(self._clock(time)) + self.offset)

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s; times in s, in their shape."""
        return np.asarray((self.order > 0) * self.pace * self.motion.speed(self._clock(time)))

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s²; times in s, in their shape."""
        return np.asarray((self.order > 1) * self.pace * self.motion.acceleration(self._clock(time)))


def is_rotary(name: str) -> bool:
    """Whether a signal changes sign when the mechanism is seen from behind: rotations and torques, by its name."""
    return name in ("phi", "omega", "epsilon", "Mkr", "shaking_moment") or name.startswith("link:")
