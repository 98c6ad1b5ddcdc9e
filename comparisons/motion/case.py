"""Motions of the driver: what every motion offers, the zero of the output under it, the scene in its start state."""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.law import FULL_TURN
from analytic.description.linkage import (
    FileRegime,
    Linkage,
    LinkTorque,
    Output,
    PrescribedRegime,
    ReleasedRegime,
    Vector,
)
from analytic.dynamics.reduced import damping_coefficient, generalised_force, half_inertia_derivative, reduced_inertia
from analytic.dynamics.released import FreeMotion, free_motion
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.dead_centres import top_of_turn
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.numerics.arrays import Array
from analytic.numerics.refine import highest
from analytic.signals import LinkageInMotion
from engines.scene import LEVELS, Body, Channel, Drive, Free, Prescribed, Scene, build_scene

INSTANTS: Final = 2001  # at which a motion is looked at as a whole

# Jeq = 2T/ω² says nothing near standstill: samples slower than this share of the peak speed are left out.
SLOW_SHARE = 0.05
# Steps, rad, at which a motion is checked before it is run.
CHECK_STEP: Final = math.radians(0.5)
# Clocks whose truth is cached. A run has no more than two or three, and no other run has the same.
MOST_CLOCKS: Final = 4
AT_REST: Final = 1e-9  # of the peak speed


class DriverMotion(Protocol):
    """A crank motion, prescribed or integrated."""

    @property
    def regime(self) -> str:
        """Name of the regime."""
        ...

    @property
    def duration(self) -> float:
        """Time at which it ends, s; it starts at 0."""
        ...

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s, or m/s of a linear drive."""
        ...

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s."""
        ...

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad, or m of a linear drive; times in s, in their shape."""
        ...

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s, or m/s of a linear drive; times in s, in their shape."""
        ...

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s², or m/s² of a linear drive; times in s, in their shape."""
        ...


# The zero of S: the top dead centre, or the farthest point of a motion whose crank cannot turn fully.


def zero_of_output(mechanism: Mechanism, motion: DriverMotion) -> float:
    """The output's coordinate, m, from which S counts.

    It is that of the top dead centre where the crank can turn fully, else of the farthest point the motion reaches,
    between instants too. Raises LinkproofError without an output and where that of a full turn stands still along its
    direction, AssemblyError where the linkage cannot make the motion.
    """
    top = top_of_turn(mechanism)
    return _farthest_reached(mechanism, motion) if top is None else top


def _farthest_reached(mechanism: Mechanism, motion: DriverMotion) -> float:
    """The largest coordinate, m, of the output over a motion, between instants too.

    Raises AssemblyError where the linkage cannot make the motion.
    """
    time = np.linspace(0.0, motion.duration, INSTANTS)

    def coordinate(instants: Array) -> Array:
        """The output's coordinate, m, at instants (n,), s, as one curve (1, n)."""
        return mechanism.sweep(motion.angle(instants)).output()[None]

    return float(highest(coordinate, time, coordinate(time))[0][0])


# The bridge from the closed form to the engines: a linkage's start state, and the scene it gives.


def start_state(sweep: Sweep, speed: float, acceleration: float) -> dict[str, Body]:
    """Every link as a body in its state at the sweep's single crank angle, by the link's name.

    The crank's speed ω is in rad/s, its acceleration ε in rad/s²; of a linear drive in m/s and m/s². Raises
    AssemblyError where the linkage cannot be assembled or move there.
    """
    return {name: _body_state(sweep, name, speed, acceleration) for name in sweep.linkage.links}


def _body_state(sweep: Sweep, name: str, speed: float, acceleration: float) -> Body:
    """The link ``name`` as a body in its state, for a crank speed, rad/s, and acceleration, rad/s²."""
    motion = (body_motion(sweep, name, order, speed, acceleration) for order in range(3))
    (x, y, angle), (vx, vy, turning), (ax, ay, change) = ((values + 0.0).tolist() for values in motion)  # no zero is -0
    link = sweep.linkage.links[name]
    return Body(name, link.mass, link.inertia, (x, y), angle, (vx, vy), turning, (ax, ay), change)


def body_motion(sweep: Sweep, name: str, order: int, speed: ArrayLike, acceleration: ArrayLike) -> Array:
    """Place of the mass centre, x and y, and angle of a link, m and rad, or a derivative by time, SI: (..., 3).

    Of ``order`` 0 it is the place, of 1 and 2 the derivative for a crank speed, rad/s, and acceleration, rad/s², each
    of the sweep's shape or scalar. Raises AssemblyError where the linkage cannot be assembled or move, and
    UnknownNameError for an unknown link.
    """

    def over_angle(k: int) -> Array:
        """The derivative of order ``k`` over φ, (..., 3); of order 0 the place itself."""
        turned = (sweep.rates, sweep.accelerations)[k - 1](name)[2] if k else sweep.angles(name)
        return np.stack(np.broadcast_arrays(*sweep.centre(name, k), turned, sweep.angle)[:3], axis=-1)

    if order == 0:
        return over_angle(0)
    rate = np.asarray(speed)[..., None]
    if order == 1:
        return np.asarray(over_angle(1) * rate)
    return np.asarray(over_angle(2) * rate**2 + over_angle(1) * np.asarray(acceleration)[..., None])


def scene(
    mechanism: Mechanism, drive: Drive, channels: Iterable[Channel], *, start_angle: float = 0.0, speed: float = 0.0
) -> Scene:
    """The scene of a mechanism under a drive, for an engine that is to record ``channels``.

    Under a prescribed motion the start state is the motion's, whatever ``start_angle`` and ``speed``; a free one starts
    at that angle, rad, with that speed, rad/s, its accelerations taken from the equation of motion; of a linear drive
    they are in m and m/s. Raises AssemblyError where the linkage cannot be assembled at the start, and LinkproofError
    for loads over S where the crank makes no full turn.
    """
    if isinstance(drive, Prescribed):
        motion = drive.motion
        sweep = mechanism.sweep(np.asarray(motion.angle(0.0)))
        state = start_state(sweep, float(motion.speed(0.0)), float(motion.acceleration(0.0)))
    else:
        sweep = mechanism.sweep(np.asarray(start_angle))
        moment = float(drive.torque_at(0.0)) + generalised_force(sweep) - damping_coefficient(sweep) * speed
        acceleration = (moment - half_inertia_derivative(sweep) * speed**2) / reduced_inertia(sweep)
        state = start_state(sweep, speed, float(acceleration))
    over_travel = any(law.over == "S" for law in mechanism.linkage.laws)
    zero = mechanism.zero_of_s() if over_travel else 0.0
    return build_scene(mechanism.linkage, state, drive, frozenset(channels), zero)


@dataclass(frozen=True)
class Truth(LinkageInMotion):
    """The closed form at the instants ``time`` (n,), s, of a motion: each part computed once, when it is needed."""

    mechanism: Mechanism
    motion: DriverMotion
    time: Array

    @cached_property
    def speed(self) -> Array:
        """ω at the instants, rad/s, or m/s of a linear drive, (n,)."""
        return self.motion.speed(self.time)

    @cached_property
    def acceleration(self) -> Array:
        """ε at the instants, rad/s², or m/s² of a linear drive, (n,)."""
        return self.motion.acceleration(self.time)

    @cached_property
    def sweep(self) -> Sweep:
        """The linkage posed at φ(t), (n,); raises AssemblyError where it cannot be assembled."""
        return self.mechanism.sweep(self.motion.angle(self.time))

    @property
    def farthest(self) -> float:
        """The output's coordinate, m, from which S counts; raises LinkproofError as ``zero_of_output``."""
        return zero_of_output(self.mechanism, self.motion)


@dataclass(frozen=True)
class Case:
    """One mechanism under one crank motion; ``drive`` is what an engine is given, the motion itself by default.

    ``conditions`` are words on both, "" for those that the motion gives.
    """

    mechanism: Mechanism
    motion: DriverMotion
    drive: Drive | None = None
    conditions: str = ""
    _seen: dict[bytes, Truth] = field(default_factory=dict, init=False, compare=False, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        """The state for pickling, without cached truth, which is many times the size of the rest."""
        return self.__dict__ | {"_seen": {}}

    @property
    def is_prescribed(self) -> bool:
        """Whether the crank's motion is given, so that the torque is the unknown."""
        return self.drive is None or isinstance(self.drive, Prescribed)

    @property
    def output(self) -> Output:
        """The linkage's output, which S, v and a need; raises LinkproofError for a linkage without one."""
        output = self.mechanism.linkage.output
        if output is None:
            raise LinkproofError(
                f"'{self.mechanism.linkage.name}' names no output, so S, v and a are undefined: add "
                "output = { point = ..., along = [x, y] } to its file, or leave these quantities out"
            )
        return output

    @property
    def least_speed(self) -> float:
        """Crank speed, rad/s, below which quantities divided by ω are left out."""
        return SLOW_SHARE * self.motion.peak_speed

    @cached_property
    def reach(self) -> tuple[float, float]:
        """The lowest and the highest φ, rad or m, of many instants of the motion."""
        angle = self.motion.angle(np.linspace(0.0, self.motion.duration, INSTANTS))
        return float(np.min(angle)), float(np.max(angle))

    def check_motion(self) -> None:
        """Raise AssemblyError where the linkage cannot be assembled or move at an angle that the crank passes.

        So too where it leaves a cylinder's travel, where a dyad turns freely, and where the crank rests on a change
        point. The motion is looked at in small steps.
        """
        low, high = self.reach
        self._check_change_points(low, high)
        cylinder = self.mechanism.linkage.cylinder
        if cylinder is not None and cylinder.has_ends:
            self.mechanism.crank_range().check(low, high, self.mechanism.linkage.name)
        turns = not self.mechanism.linkage.is_linear
        look = CHECK_STEP * (1.0 if turns else self.mechanism.linkage.extent())
        passed = np.linspace(low, high, math.ceil((high - low) / look) + 2)
        reached = self.mechanism.turn if turns and high - low >= FULL_TURN else self.mechanism.sweep(passed)
        try:
            for sweep in (reached, self.start()):
                for body in self.mechanism.structure.bodies:
                    sweep.rates(body)
        except AssemblyError:
            self.mechanism.crank_range(float(self.motion.angle(0.0))).check(low, high, self.mechanism.linkage.name)
            raise

    def _check_change_points(self, low: float, high: float) -> None:
        """Raise AssemblyError where a dyad turns freely between two angles, or the crank rests at a change point.

        The angles are in rad.
        """
        self.mechanism.check_determined(low, high)
        motion = self.motion
        pieces = motion.segments if isinstance(motion, CrankMotion) else ()
        ends = {0.0, *(piece.start for piece in pieces), *(piece.end for piece in pieces)}
        for end in ends:
            if abs(float(motion.speed(end))) <= AT_REST * motion.peak_speed:
                self.mechanism.check_rest(float(motion.angle(end)))

    @property
    def unbounded_at(self) -> float | None:
        """A change point that the motion passes, rad, where joint forces are infinite; None if it passes none.

        It is the first in a turn of those passed.
        """
        low, high = self.reach
        return next((c for c in self.mechanism.changes if (c - low) % FULL_TURN <= high - low), None)

    def start(self) -> Sweep:
        """The linkage posed at the first instant of the motion, arrays (1,), from the cache of ``at``."""
        return self.sweep(np.zeros(1))

    def scene(self, channels: Iterable[Channel]) -> Scene:
        """The scene of the case, for an engine that is to record ``channels``; raises LinkproofError as ``scene``.

        Without a drive the motion has to be a CrankMotion, else AssertionError.
        """
        drive = self.drive
        if drive is None:
            assert isinstance(self.motion, CrankMotion)
            drive = Prescribed(self.motion)
        start = np.zeros(())
        angle, speed = float(self.motion.angle(start)), float(self.motion.speed(start))
        return scene(self.mechanism, drive, channels, start_angle=angle, speed=speed)

    def at(self, time: Array) -> Truth:
        """The Truth at instants (n,), s, cached for the last few clocks: quantities on one clock share its work.

        There are at most MOST_CLOCKS; the oldest goes first.
        """
        key = time.tobytes()
        if key not in self._seen:
            while len(self._seen) >= MOST_CLOCKS:
                del self._seen[next(iter(self._seen))]
            self._seen[key] = Truth(self.mechanism, self.motion, time)
        return self._seen[key]

    def sweep(self, time: Array) -> Sweep:
        """The linkage posed along the motion, at times (n,), s, from the cache of ``at``.

        Raises AssemblyError where it cannot be assembled.
        """
        return self.at(time).sweep

    @cached_property
    def apart(self) -> Case:
        """The same case with a cache of its own, for a few instants that must not displace those of a run.

        It is made once.
        """
        return replace(self)

    @cached_property
    def at_rest(self) -> Case:
        """A case of the same mechanism, its driver held at rest where the motion begins, as long; no ``conditions``."""
        rest = Segment(0.0, self.motion.duration, (float(self.motion.angle(0.0)),))
        return Case(self.mechanism, CrankMotion(self.motion.regime, (rest,)))

    def joint_names(self) -> tuple[str, ...]:
        """Names of all joints that carry a force."""
        return self.mechanism.linkage.joint_names

    def output_anchor(self) -> Vector:
        """The output point relative to its link's mass centre, link frame, m.

        Raises LinkproofError without an output.
        """
        link = self.mechanism.linkage.links[self.output.link]
        point = link.points[self.output.point]
        return (point[0] - link.centre[0], point[1] - link.centre[1])

    def along(self, vectors: Array) -> Array:
        """The component of vectors (n, 2) along the output's direction, (n,).

        Raises LinkproofError without an output.
        """
        return np.asarray(vectors @ np.asarray(self.output.along))


@lru_cache(maxsize=16)  # a megabyte each, or tens where a crank is released for long
def unpickle_case(case: bytes) -> Case:
    """The case of a worker's job from its pickle, one object for all its jobs, so that they share its cache.

    The last few cases are kept. Pickled even within this process: unpickling may change an array's memory order, and
    with it the last bits of sums; so all workers get the same bits.
    """
    result: Case = pickle.loads(case)
    return result


def motion_of_file_regime(mechanism: Mechanism, regime: ReleasedRegime) -> FreeMotion:
    """The motion of a crank released as a regime of the file says, integrated, with the regime's name.

    Raises LinkproofError where the motion cannot be followed.
    """
    motion = free_motion(
        mechanism,
        torque=regime.torque if regime.over_angle is None else regime.over_angle,
        over_time=regime.over_time,
        start_angle=regime.start_angle,
        start_speed=regime.start_speed,
        duration=regime.duration,
    )
    return replace(motion, regime=regime.name)


def _release_words(linkage: Linkage, regime: ReleasedRegime) -> str:
    """Words on how a driver is released: "released at 0° with 10 rad/s, crank torque 2 N m"."""
    if linkage.is_linear:
        speed = linkage.written(regime.start_speed)
        return (
            f"released at {linkage.written(regime.start_angle)} with {speed}/s, "
            f"force of the drive {_torque_words(regime, 'N')}"
        )
    start = f"{math.degrees(regime.start_angle):g}° with {regime.start_speed:g} rad/s"
    return f"released at {start}, crank torque {_torque_words(regime, 'N m')}"


def case_of_file_regime(mechanism: Mechanism, regime: FileRegime) -> Case:
    """The case of a regime of the linkage's file: a prescribed motion, or a released crank by the equation of motion.

    A crank torque over the angle is a load like any other: the case's linkage, a copy, has it among its own. Raises
    LinkproofError where a released crank cannot be followed.
    """
    gravity = "gravity on" if any(mechanism.linkage.gravity) else "gravity off"
    if isinstance(regime, PrescribedRegime):
        return Case(mechanism, regime.motion, conditions=f"{regime.conditions}, {gravity}")
    motion = motion_of_file_regime(mechanism, regime)
    if regime.over_angle is not None:
        linkage = mechanism.linkage
        loads = (*linkage.torques, LinkTorque(linkage.crank, regime.over_angle))
        mechanism = Mechanism(replace(linkage, torques=loads))
    conditions = _release_words(mechanism.linkage, regime) + f", {regime.duration:g} s, {gravity}"
    return Case(mechanism, motion, free_drive(motion, regime), conditions)


def _torque_words(regime: ReleasedRegime, unit: str) -> str:
    """A released crank's torque in words, in this unit if constant: "2 N m", "24 values over the angle"."""
    if regime.over_angle is not None:
        return f"{len(regime.over_angle.values)} values over the angle"
    if regime.over_time is not None:
        return f"{len(regime.over_time.times)} values over time"
    return f"{regime.torque:g} {unit}"


def free_drive(motion: DriverMotion, regime: ReleasedRegime) -> Free:
    """A released crank's drive: its torque, constant and over time, duration, and pace, by which engines choose steps.

    The pace, rad/s, is the peak |ω| plus the largest |ε| over it. A torque over the angle is left out: it is a load of
    the case.
    """
    hardest = float(np.max(np.abs(motion.acceleration(np.linspace(0.0, motion.duration, INSTANTS)))))
    return Free(regime.torque, regime.duration, motion.peak_speed + hardest / motion.peak_speed, regime.over_time)


# The closed form of what an engine records, channel by channel.


def channel_truth(case: Case, channel: Channel, part: str, time: Array) -> Array:
    """The closed form, SI, of a channel at times (n,), s: of a body (n, 3), of a joint (n, 2), or of the drive (n,).

    Of a body it is x, y and angle, or their first or second derivative by time, as the channel says; of a joint the
    force, x and y. ``part`` is the body's or the joint's name; the drive needs none. Raises UnknownNameError for an
    unknown body, KeyError for an unknown joint.
    """
    at = case.at(time)
    if channel is Channel.TORQUE:
        return at.torque
    if channel is Channel.JOINT_FORCE:
        return np.asarray(at.joint_forces[part].T)
    return body_motion(at.sweep, part, LEVELS.index(channel), at.speed, at.acceleration)
