"""Reading a motion back: energies, points and powers from the history, never from an engine's own word for them."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.linkage import DriverKind, Vector
from analytic.numerics.arrays import Array, Booleans
from analytic.numerics.refine import highest
from engines.contract import History, Origin, Signal, weakest
from engines.mechanics.joints import JointEquations, applied_loads, potential_energy, without_potential
from engines.mechanics.states import (
    Pose,
    body_masses,
    body_numbers,
    driven,
    point_acceleration,
    point_velocity,
    pose_of,
    with_ground,
)
from engines.scene import LEVELS, Channel, Free, Scene

DENSE = 48  # samples of a turn that can be read between

POINTS = 6
SHARP_POINTS = 16  # samples beside a place whose value is the zero of all others, where more accuracy counts


@dataclass(frozen=True)
class ObservedMotion:
    """The history of one run beside the scene that made it; arrays are (samples, ...) on the given clock.

    Bodies are in the scene's order, the ground behind them. What rests on a channel that was not recorded raises
    AssertionError, and ValueError what is read between fewer than six samples of a motion without jumps.
    """

    scene: Scene
    history: History

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The index of every body in the arrays, by its name, the ground's too, which is last."""
        return body_numbers(self.scene)

    @cached_property
    def masses(self) -> Array:
        """Weights of (x, y, θ) for every body: mass, mass, inertia, kg and kg m², (bodies, 3); 0 for the ground."""
        return np.asarray(body_masses(self.scene), dtype=float)

    def signal(self, channel: Channel) -> Signal:
        """The signal of a recorded channel, no joint force; raises AssertionError for one that was not recorded.

        A free crank's torque is taken from the drive, at the accelerations' times.
        """
        if channel is Channel.TORQUE and isinstance(self.scene.drive, Free):
            time = self.signal(Channel.ACCELERATION).time
            return Signal(time, self.scene.drive.torque_at(time))
        signal = getattr(self.history, channel.value)
        assert isinstance(signal, Signal), f"channel {channel} was not recorded"
        return signal

    def has(self, channel: Channel) -> bool:
        """Whether a channel was recorded; a free crank's torque is known wherever its acceleration is.

        Of joint forces one is enough.
        """
        if channel is Channel.JOINT_FORCE:
            return bool(self.history.joint_force)
        if channel is Channel.TORQUE and isinstance(self.scene.drive, Free):
            return self.has(Channel.ACCELERATION)
        return getattr(self.history, channel.value) is not None

    def origin(self, channels: Iterable[Channel]) -> Origin:
        """The weakest origin of the signals in these channels, which must have been recorded; READ without any.

        Of the joint forces it is that of all joints.
        """
        signals = [s for c in channels for s in (self.history.joint_force.values() if c is Channel.JOINT_FORCE
                   else (self.signal(c),))]  # fmt: skip
        return weakest(signal.origin for signal in signals)

    @cached_property
    def is_linear(self) -> bool:
        """Whether the driver is pushed along a line, so that φ is in m."""
        return self.scene.driver_kind is not DriverKind.CRANK

    @cached_property
    def last_turn(self) -> slice | None:
        """The slice of the position's samples in the crank's last full turn in one direction.

        None without one, of a linear driver, or with fewer than DENSE samples, between which interpolation would add an
        error that is not the engine's.
        """
        if self.is_linear:
            return None
        angle = self.crank(Channel.POSITION, self.signal(Channel.POSITION).time)
        inside = np.flatnonzero(np.abs(angle - angle[-1]) >= FULL_TURN)
        if not len(inside):
            return None
        turn = slice(int(inside[-1]), len(angle))
        ways = np.diff(angle[turn])
        return turn if len(ways) >= DENSE and (np.all(ways > 0.0) or np.all(ways < 0.0)) else None

    def on_clock(self, channel: Channel, time: Array) -> Array:
        """A channel's values at times (n,), s, (n, ...), interpolated to sixth order between its samples.

        Samples beyond a jump of the acceleration take no part in it. The channel is no joint force.
        """
        return resample_piecewise(self.signal(channel), time, self.jumps)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times, s, at which the prescribed acceleration jumps; () for a free crank."""
        drive = self.scene.drive
        return () if isinstance(drive, Free) else drive.motion.jumps

    def bodies(self, channel: Channel, time: Array) -> Array:
        """Position, velocity or acceleration of every body at times (n,), s, the ground last: (n, bodies, 3).

        Of a body they are x and y of its mass centre, m, and its angle, rad, or these per s or s².
        """
        return np.asarray(with_ground(self.on_clock(channel, time)), dtype=float)

    def pose(self, time: Array) -> Pose:
        """Poses, m and rad, of all bodies and the ground at times (n,), s."""
        return pose_of(self.bodies(Channel.POSITION, time))

    def crank(self, channel: Channel, time: Array) -> Array:
        """φ, rad or m, or its first or second time derivative, by the channel, at times (n,), s, by the engine."""
        signal = self.signal(channel)
        if self.is_linear:
            order = LEVELS.index(channel)
            motion = (self.bodies(level, time) for level in LEVELS[: order + 1])
            return np.asarray(driven(self.scene, *motion)[order], dtype=float)
        column = Signal(signal.time, signal.values[:, self.numbers[self.scene.crank], 2])
        return resample_piecewise(column, time, self.jumps)

    def kinetic_energy(self, time: Array) -> Array:
        """Kinetic energy of all bodies at times (n,), s: T = Σ ½ m v² + ½ J ω², J."""
        velocity = self.bodies(Channel.VELOCITY, time)
        return np.asarray(0.5 * np.einsum("nbk,bk->n", velocity**2, self.masses))

    def potential_energy(self, time: Array) -> Array:
        """Energy of gravity and springs, J, at times (n,), s; that of gravity is 0 at the ground's origin."""
        return np.asarray(potential_energy(self.scene, self.pose(time)), dtype=float)

    def load_power(self, time: Array) -> Array:
        """Power, W, at times (n,), s, of forces at points, torques on links, dampers and dashpots: no potential."""
        return self._power(without_potential(self.scene), time)

    def dissipation(self, time: Array) -> Array:
        """Power, W, at times (n,), s, that dampers and dashpots take; never negative."""
        damped = replace(without_potential(self.scene), forces=(), torques=())
        return np.maximum(-self._power(damped, time), 0.0)

    def _power(self, scene: Scene, time: Array) -> Array:
        """Power (n,), W, at times (n,), s, of the loads of a ``scene``, this motion's with some left out."""
        if not (scene.forces or scene.torques or scene.dampers or scene.springs):
            return np.zeros(len(time))
        rate = self.bodies(Channel.VELOCITY, time)
        return np.asarray(np.einsum("nbk,nbk->n", applied_loads(scene, self.pose(time), rate), rate))

    def joint_gaps(self, time: Array) -> dict[str, Array]:
        """The opening of every joint, m, (n,), by name: pins apart, sliders and slot pins off their line.

        None is negative; ``time`` (n,) is in s.
        """
        equations, pose = JointEquations(self.scene, unit=1.0), self.pose(time)
        openings = equations.openings(equations.residual(pose, equations.arms(pose)))
        return {name: np.asarray(openings[:, number]) for number, name in enumerate(equations.joints)}

    def point(self, body: str, anchor: Vector, time: Array, order: int = 0) -> Array:
        """A point fixed in a body at times (n,), s: place (n, 2), m, velocity (``order`` 1) or acceleration (2).

        ``body`` is a name, the ground's too; ``anchor`` is in m in the body's own frame, from its mass centre.
        """
        number, pose = self.numbers[body], self.pose(time)
        if order == 0:
            return np.asarray(pose.point(number, anchor))
        arm, rate = pose.arm(number, anchor), self.bodies(Channel.VELOCITY, time)[:, number]
        if order == 1:
            return np.asarray(point_velocity(arm, rate))
        return np.asarray(point_acceleration(arm, rate, self.bodies(Channel.ACCELERATION, time)[:, number]))


# Values between samples: six-point Lagrange interpolation on any increasing clock.


def resample(signal: Signal, time: Array, points: int = POINTS) -> Array:
    """Values of a signal at other times, (len(time), ...); of order ``points`` inside, one-sided at the ends.

    Times outside the samples are extrapolated. On the signal's own clock its own array comes back. Raises ValueError
    for a signal with fewer samples.
    """
    if time is signal.time or np.array_equal(time, signal.time):
        return signal.values
    if len(signal.time) < points:
        raise ValueError(f"expected at least {points} samples to interpolate, got {len(signal.time)}")
    start = np.clip(np.searchsorted(signal.time, time) - points // 2, 0, len(signal.time) - points)
    nodes = [signal.time[start + k] for k in range(points)]
    result = np.zeros((len(time), *signal.values.shape[1:]))
    shape = (len(time), *([1] * (signal.values.ndim - 1)))
    for k in range(points):
        weight = np.ones(len(time))
        for j in range(points):
            if j != k:
                weight *= (time - nodes[j]) / (nodes[k] - nodes[j])
        result += weight.reshape(shape) * signal.values[start + k]
    return result


def resample_piecewise(signal: Signal, time: Array, breaks: Sequence[float], points: int = POINTS) -> Array:
    """Values of a signal at other times, (len(time), ...), from nodes on one side of each break, s, alone.

    A derivative jumps at a break, and no polynomial follows it. ``breaks`` ascend; what lies on one belongs to the
    piece behind it. ``points`` is the order, as of ``resample``.

    A piece with fewer nodes takes what it has; one with a single node or none is read across the break. Without breaks
    ValueError is raised for a signal of fewer samples.
    """
    if time is signal.time or np.array_equal(time, signal.time) or not len(breaks):
        return resample(signal, time, points)
    nodes, places = np.searchsorted(breaks, signal.time, "right"), np.searchsorted(breaks, time, "right")
    result = np.empty((len(time), *signal.values.shape[1:]))
    for piece in np.unique(places):
        here, there = nodes == piece, places == piece
        count = int(np.count_nonzero(here))
        part = Signal(signal.time[here], signal.values[here]) if count > 1 else signal
        result[there] = resample(part, time[there], min(points, len(part.time)))
    return result


def peak(signal: Signal, breaks: Sequence[float] = ()) -> float:
    """The largest value of a signal (n,), in its unit, between its samples too, smooth except at its ``breaks``, s.

    It has three samples or more.
    """
    points = min(SHARP_POINTS, len(signal.time))

    def between(time: Array) -> Array:
        """Values of the signal at times, s, as one curve (1, n)."""
        return resample_piecewise(signal, time, breaks, points)[None]

    return float(highest(between, signal.time, signal.values[None])[0][0])


# Integrals over samples that an engine chose, with an estimate of their error.

FEWEST = 4 * POINTS  # samples needed for an error estimate
PLACES, WEIGHTS = np.polynomial.legendre.leggauss(POINTS // 2)  # exact for the interpolating polynomials


def is_off_jumps(time: Array, jumps: Sequence[float]) -> Booleans:
    """Which samples at these times (n,), s, are on none of the ``jumps``, s, where an engine may show either value.

    What is nearer than 1e-6 of the first step is on a jump.
    """
    result = np.full(len(time), True)
    for jump in jumps:
        result &= np.abs(time - jump) > _same_time(time)
    return result


def _same_time(time: Array) -> float:
    """The distance, s, within which two times of a clock count as one."""
    return 1e-6 * float(time[1] - time[0])


def integral(signal: Signal, jumps: tuple[float, ...], order: int = POINTS) -> Array:
    """∫ dt of a signal (n,) from the first sample to each, (n,), of an even ``order`` up to 6 between its ``jumps``, s.

    It is the integral of what ``resample`` puts between the samples. A sample on a jump has two values, so that it is
    dropped and both sides are extrapolated to it. ``jumps`` ascend.
    """
    time = signal.time
    near = _same_time(time)
    one_value = is_off_jumps(time, jumps)
    borders = [float(time[0]), *(jump for jump in jumps if time[0] < jump < time[-1]), float(time[-1])]
    result = np.zeros(len(time))
    total = 0.0
    for start, end in itertools.pairwise(borders):
        inside = (time >= start) & (time <= end) & one_value
        nodes = np.unique(np.concatenate([[start], time[inside], [end]]))
        sums = total + _integrate_stretch(nodes, Signal(time[inside], signal.values[inside]), order)
        here = (time >= start - near) & (time <= end + near)
        result[here] = sums[np.clip(np.searchsorted(nodes, time[here] - near), 0, len(nodes) - 1)]
        total = float(sums[-1])
    return result


def _integrate_stretch(nodes: Array, stretch: Signal, order: int) -> Array:
    """The integral of a ``stretch``, a signal (k,) without a jump, from the first of the ``nodes``, s, to each.

    ``order`` is that of the interpolation; a stretch of fewer than ``POINTS`` samples is taken for a polygon, one of
    none for 0.
    """
    step = np.diff(nodes)
    places = (nodes[:-1, None] + 0.5 * step[:, None] * (1.0 + PLACES)).ravel()
    if len(stretch.time) >= POINTS:
        between = resample(stretch, places, order)
    elif len(stretch.time):
        between = np.interp(places, stretch.time, stretch.values)
    else:
        between = np.zeros(len(places))
    parts = 0.5 * step * (between.reshape(-1, len(PLACES)) @ WEIGHTS)
    return np.concatenate([[0.0], np.cumsum(parts)])


def error_estimate(signal: Signal, fine: Array, jumps: tuple[float, ...]) -> Array:
    """Estimated error of ``integral``, here ``fine``, at each sample, (n,): its distance from that of fourth order.

    It never falls. Of a signal that its samples resolve this is several times the error; of one that they do not, less
    than it. Infinite where there are too few samples to tell. ``signal`` and ``jumps`` are those of the integral.
    """
    if len(signal.time) < FEWEST:
        return np.full(len(signal.time), np.inf)
    return np.maximum.accumulate(np.abs(integral(signal, jumps, order=4) - fine))


def error_bound(signal: Signal, fine: Array, jumps: tuple[float, ...]) -> Array:
    """Error bound of ``integral``, here ``fine``, at each sample, (n,): its distance from that of every other sample.

    It never falls. Of a signal that its samples resolve, this is some sixty times the error; of a peak as narrow as a
    few samples still no less than it. Infinite where there are too few samples to tell. ``signal`` and ``jumps`` are
    those of the integral.
    """
    time = signal.time
    if len(time) < FEWEST:
        return np.full(len(time), np.inf)
    some = np.unique([*range(0, len(time), 2), len(time) - 1])
    coarse = integral(Signal(time[some], signal.values[some]), jumps)
    largest = np.maximum.accumulate(np.abs(coarse - fine[some]))
    return largest[np.searchsorted(some, np.arange(len(time)))]
