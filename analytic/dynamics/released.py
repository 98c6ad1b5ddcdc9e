"""The motion of a crank that is not prescribed: moved by its torque and the linkage's own loads, damping included.

Article 000, eq (32): Jeq φ̈ + ½ Jeq' φ̇² + b φ̇ = Q + M1. The motion can be evaluated at any instant, like the prescribed
ones of ``analytic.description.crank_motion``, and says how far it can be from the exact solution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.law import FULL_TURN, Law, TimeLaw
from analytic.dynamics import reduced
from analytic.dynamics.loads import applied_loads
from analytic.dynamics.reduced import EquationOfMotion, equation_of_motion
from analytic.errors import LinkproofError
from analytic.kinematics.error_bounds import relative_bounds
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.arrays import Array
from analytic.numerics.integration import Windows, gauss_scheme, integrate
from analytic.numerics.refine import extremes, grid, highest, periodic_mean
from analytic.numerics.roots import root

TOLERANCE: Final = 1e-12
NODES: Final = 32
# The motion that the error bound is taken from shares neither steps nor order nor table with the one it judges.
CONTROL_NODES, CONTROL_DEGREE, TIGHTENED = 24, 10, 0.1
SAMPLES: Final = 8  # instants per window at which the two are compared
# Relative disturbance of the equation's terms whose effect is still in proportion, and what it need be integrated to.
DISTURBANCE, LOOSE = 1e-7, 1e-10
ROUNDINGS: Final = 64.0  # of the largest moment, in any one: the closed form's and the table's
SEEN: Final = 720  # instants at which the closed form's own error is looked at
EPS: Final = float(np.finfo(float).eps)


@dataclass(frozen=True)
class FreeMotion:
    """A crank motion that solves the equation of motion; made by ``free_motion``.

    ``regime`` is ``driven`` under a crank torque, else ``free``; ``start`` holds φ, rad, and ω, rad/s, at t = 0; the
    motion lasts ``duration``, s. ``windows`` have it as integrated to ``tolerance``, a share of the speed.
    """

    regime: str
    start: tuple[float, float]
    duration: float
    equation: EquationOfMotion
    windows: Windows
    tolerance: float

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad, at times, s; shape of ``time``."""
        return self.windows.angle_at(np.asarray(time, dtype=float))

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s, at times, s; shape of ``time``."""
        return self.windows.speed_at(np.asarray(time, dtype=float))

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s², at times, s, from the equation of motion at φ(t) and ω(t); shape of ``time``."""
        angle = self.angle(time)
        values = self.equation.acceleration(angle, self.speed(time))
        return values if self.equation.over_time is None else values + self.equation.push(time, angle)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps: none."""
        return ()

    @cached_property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        instants = self._instants(2 * NODES)

        def size(time: Array) -> Array:
            """|ω|, rad/s, at instants (n,), s, as one curve (1, n)."""
            return np.abs(self.speed(time))[None]

        return float(highest(size, instants, size(instants))[0][0])

    def _instants(self, count: int) -> Array:
        """``count`` instants, s, evenly spaced, in each window, in one array (n,), and the last window's end."""
        starts = self.windows.starts
        inside = starts[:-1, None] + np.diff(starts)[:, None] * np.linspace(0.0, 1.0, count, endpoint=False)
        return np.append(inside.ravel(), starts[-1])

    @cached_property
    def error_bound(self) -> float:
        """Bound on the error of φ at any instant, rad: of the integration, the closed form, and rounding φ itself.

        The first is twice the largest difference from a second integration of another order, with a tighter tolerance
        and a table of its own. The second is the effect on the motion of the bounds on the
        closed form's own error, which both integrations share: the response to a small disturbance, scaled down. Raises
        LinkproofError where one of these motions cannot be followed to its end.
        """
        time = self._instants(SAMPLES)
        angle = self.angle(time)
        rounding = 4.0 * EPS * float(np.max(np.abs(angle)))
        return 2.0 * self._integration_error(time, angle) + self._closed_form_error(time, angle) + rounding

    def _integration_error(self, time: Array, angle: Array) -> float:
        """Largest difference of φ, rad, from the second integration.

        It is looked for at instants ``time``, s, where φ is ``angle``, rad. Raises LinkproofError where the motion
        cannot be followed.
        """
        equation = replace(self.equation, table=None).tabulated(CONTROL_DEGREE)
        control = _integrate_windows(equation, self.start, self.duration, CONTROL_NODES, TIGHTENED * self.tolerance)
        return float(np.max(np.abs(angle - control.angle_at(time))))

    def _closed_form_error(self, time: Array, angle: Array) -> float:
        """Largest change of φ, rad, by roundings of the closed form.

        It is looked for at instants ``time``, s, where φ is ``angle``, rad. Those of the moment may all have one sign;
        those of ½Jeq' are proportional to it, else they would do work. Raises LinkproofError where the disturbed motion
        cannot be followed.
        """
        seen = np.linspace(0.0, self.duration, SEEN)
        path = self.equation.mechanism.sweep(self.angle(seen))
        _, first, second = relative_bounds(path)
        push = DISTURBANCE * self.equation.peak_moment

        def disturbed(angle: Array, speed: Array) -> Array:
            """φ̈, rad/s², at φ, rad, and ω, rad/s, with every term wrong by ``DISTURBANCE`` in the worst direction."""
            moment, damping, slope = self.equation.terms(angle)[:3]
            more, less = 1.0 + DISTURBANCE, 1.0 - DISTURBANCE
            return np.asarray(moment + push - speed * (less * damping + more * slope * speed))

        moved = integrate(
            disturbed,
            self.start,
            self.duration,
            gauss_scheme(NODES),
            tolerance=LOOSE,
            rounding=DISTURBANCE * push,
            period=self.equation.period,
            **self.equation.timing,
        )
        response = float(np.max(np.abs(angle - moved.angle_at(time)))) / DISTURBANCE
        return response * (3.0 * first + second)


def free_motion(
    mechanism: Mechanism,
    *,
    torque: float | Law = 0.0,
    start_angle: float = 0.0,
    start_speed: float = 0.0,
    duration: float,
    tolerance: float = TOLERANCE,
    over_time: TimeLaw | None = None,
) -> FreeMotion:
    """Release the linkage at crank angle ``start_angle`` (rad) with ``start_speed`` (rad/s), for ``duration`` seconds.

    ``torque`` is M1 on the crank, N m, a number or a law of φ; a torque ``over_time`` and the linkage's loads act
    besides. ``tolerance`` is the error of the speed within one window of integration, relative to it. Raises
    LinkproofError for a wrong number, where ``equation_of_motion`` does, and where the motion cannot be followed;
    AssemblyError where the linkage cannot be assembled or moved at the start.
    """
    for name, value in (("start angle", start_angle), ("start speed", start_speed)):
        if not math.isfinite(value):
            raise LinkproofError(f"{name}: expected a finite number, got {value:g}; give one that is")
    for name, value in (("duration", duration), ("tolerance", tolerance)):
        if not (math.isfinite(value) and value > 0.0):
            raise LinkproofError(f"{name}: expected a positive finite number, got {value:g}; give one that is")
    equation = equation_of_motion(mechanism, torque, over_time)
    return follow(equation.tabulated(), start_angle, start_speed, duration, tolerance)


def follow(
    equation: EquationOfMotion, start_angle: float, start_speed: float, duration: float, tolerance: float
) -> FreeMotion:
    """Integrate an equation of motion that may be tabulated already.

    The motion starts at ``start_angle``, rad, with ``start_speed``, rad/s, and lasts ``duration``, s; ``tolerance`` is
    the error of the speed within one window of integration, relative to it. Raises LinkproofError where the motion
    cannot be followed, AssemblyError where the linkage cannot be assembled or moved at the start.
    """
    start = (start_angle, start_speed)
    windows = _integrate_windows(equation, start, duration, NODES, tolerance)
    timed = equation.over_time is not None and any(equation.over_time.torque)
    regime = "driven" if timed or np.any(equation.torque.values) else "free"
    return FreeMotion(regime, start, duration, equation, windows, tolerance)


def _integrate_windows(
    equation: EquationOfMotion, start: tuple[float, float], duration: float, nodes: int, tolerance: float
) -> Windows:
    """The windows of a motion, integrated by Gauss's method with so many ``nodes`` a window.

    ``start`` is (φ, rad, ω, rad/s), ``duration`` in s, ``tolerance`` of the speed within a window, relative to it. Near
    an equilibrium the moment is a small difference, with the rounding of its peak. Raises LinkproofError where the
    motion cannot be followed, AssemblyError where it cannot begin.
    """
    rounding = ROUNDINGS * EPS * equation.peak_moment
    linkage = equation.mechanism.linkage
    return integrate(
        equation.acceleration,
        start,
        duration,
        gauss_scheme(nodes),
        tolerance=tolerance,
        rounding=rounding,
        place=linkage.phi.named,
        period=equation.period,
        **equation.timing,
    )


# The energy of a released crank's motion against the work done on it: a check that needs no equation of motion.


def energy_imbalance(motion: FreeMotion) -> float:
    """Largest gap between the energy gained and the work of torque, forces and damping, as a share of what is at play.

    That is the peak of kinetic energy, the range of potential energy and the most work together; where it is 0, so is
    the gap. Energies come from the closed form at the angles and speeds of the motion, the work from Gauss quadrature
    along it; neither uses ½ Jeq' or the equation of motion. A wrong model shows here, since it violates conservation of
    energy.
    """
    mechanism, starts = motion.equation.mechanism, motion.windows.starts
    ends = mechanism.sweep(motion.angle(starts))
    kinetic, potential = reduced.kinetic_energy(ends, motion.speed(starts)), reduced.potential_energy(ends)
    gained = kinetic + potential - (kinetic[0] + potential[0])
    scheme = gauss_scheme(NODES)
    time = starts[:-1, None] + np.diff(starts)[:, None] * scheme.nodes
    work = np.append(0.0, np.cumsum(np.diff(starts) * (_power_of_loads(motion, time) @ scheme.end_once)))
    at_play = np.max(kinetic) + np.ptp(potential) + np.max(np.abs(work))
    return float(np.max(np.abs(gained - work)) / at_play) if at_play > 0.0 else 0.0


def _power_of_loads(motion: FreeMotion, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Power, W, at instants, s, of torque, forces and damping, which have no potential energy; shape of ``time``.

    Raises AssemblyError where the linkage cannot be assembled or moved on the way.
    """
    mechanism, angle, speed = motion.equation.mechanism, motion.angle(time), motion.speed(time)
    sweep = mechanism.sweep(angle)
    force = motion.equation.torque(angle)[0]
    for load in mechanism.linkage.applied:
        force = force + reduced.power(sweep, applied_loads(sweep, load, speed))
    if motion.equation.over_time is not None:
        force = force + motion.equation.over_time(time)
    return np.asarray((force - reduced.damping_coefficient(sweep) * speed) * speed)


# Steady rotation under a crank torque: mean speed and coefficient of fluctuation.
#
# Over a turn of steady rotation the crank's torque and the damping do equal work, whatever the inertia and the
# conservative loads do in between: with a constant M1 and b the mean of ω over φ is M1/b exactly. The mean over time,
# 2π over the time of a turn, is a little less, since the crank dwells where it is slow.


# Shares of the mean speed to start the search from: at the first angle the crank may be faster than in the mean.
GUESSES: Final = (1.0, 1.5, 2.5)
MOST_TURNS: Final = 60
SETTLED: Final = 1e-10  # step of the search, relative: a secant's error is far below its step
SLOWEST: Final = 8.0  # times the guessed time of a turn: slower is a stall
SAMPLES_PER_TURN: Final = 720
NO_TORQUE: Final = 1e-12  # a mean moment of this share of the largest is rounding


@dataclass(frozen=True)
class Rotation:
    """Speeds of a crank over whole turns, rad/s, negative if clockwise: mean over time, mean over φ, extremes."""

    mean_speed: float
    mean_speed_over_angle: float
    largest: float
    smallest: float

    @property
    def fluctuation(self) -> float:
        """Coefficient of fluctuation (ω_max − ω_min) / ω_mean."""
        return abs((self.largest - self.smallest) / self.mean_speed)


def last_turns(motion: FreeMotion, turns: int = 1) -> Rotation:
    """The rotation in the last ``turns`` whole turns of a motion.

    Raises LinkproofError if it did not make them, or for fewer than one.
    """
    end, whole = float(motion.angle(motion.duration)), turns * FULL_TURN
    direction = 1.0 if end > float(motion.angle(0.0)) else -1.0
    start = _last_passage(motion, end - direction * whole)
    if start is None or turns < 1:
        raise LinkproofError(
            f"rotation: expected a motion of at least {turns} whole turns and at least one, got one from "
            f"{np.degrees(motion.angle(0.0)):.4g}° to {np.degrees(end):.4g}°; lengthen it or ask for fewer turns"
        )
    return _rotation(motion, start, motion.duration, turns)


def _rotation(motion: FreeMotion, start: float, end: float, turns: int) -> Rotation:
    """The rotation between two instants, s, at which the crank is so many whole ``turns`` apart."""

    def speed(phase: Array) -> Array:
        """Speed, rad/s, at a phase, which spans the time from ``start`` to ``end`` from 0 to 2π and repeats."""
        return motion.speed(start + (end - start) * (phase % FULL_TURN) / FULL_TURN)

    result, time = extremes(speed, SAMPLES_PER_TURN * turns), end - start
    travelled = float(motion.angle(end) - motion.angle(start))
    square = motion.speed(np.linspace(start, end, 8 * SAMPLES_PER_TURN * turns + 1)) ** 2  # dφ = ω dt
    over_angle = float(np.mean(0.5 * (square[1:] + square[:-1]))) * time / travelled
    return Rotation(travelled / time, over_angle, result.maximum, result.minimum)


def _last_passage(motion: FreeMotion, angle: float) -> float | None:
    """The last time, s, at which the crank passes an angle, rad; None if it never passes it.

    There and back within one window of integration is not seen.
    """
    times = motion.windows.starts
    ahead = motion.angle(times) >= angle
    changes = np.flatnonzero(ahead[1:] != ahead[:-1])
    if not len(changes):
        return None
    left, right = times[changes[-1]], times[changes[-1] + 1]
    return root(lambda time: float(motion.angle(time)) - angle, float(left), float(right))


def steady_state(mechanism: Mechanism, torque: float | Law) -> Rotation:
    """The rotation that repeats itself turn after turn under a crank torque M1, N m, a number or a law of φ.

    Raises LinkproofError without a steady rotation: no damping, no mean torque, or too little torque for the loads; and
    where ``equation_of_motion`` does or a motion cannot be followed. AssemblyError for a crank that cannot make a full
    turn.
    """
    equation = equation_of_motion(mechanism, torque)
    sweep = mechanism.sweep(grid())
    moments = reduced.generalised_force(sweep) + equation.torque(sweep.angle)[0]
    moment, damping = periodic_mean(moments), periodic_mean(reduced.damping_coefficient(sweep))
    if damping <= 0.0 or abs(moment) <= NO_TORQUE * float(np.max(np.abs(moments))):
        raise LinkproofError(
            f"steady rotation of '{mechanism.linkage.name}': expected a damper and a torque that is not zero in the "
            f"mean, got a mean damping of {damping:g} N m s and a mean torque of {moment:g} N m; add what is missing"
        )
    equation = equation.tabulated()
    for guess in GUESSES:
        rotation = _repeating_rotation(equation, guess * moment / damping)
        if rotation is not None:
            return rotation
    raise LinkproofError(
        f"steady rotation of '{mechanism.linkage.name}': expected a crank that keeps turning, got one that stalls "
        f"under a mean torque of {moment:g} N m; raise the torque"
    )


def _repeating_rotation(equation: EquationOfMotion, speed: float) -> Rotation | None:
    """The rotation whose speed a turn brings back, found by secants from ``speed``, rad/s; None if there is none.

    The crank stalls, or the search has not settled. Raises LinkproofError where a motion cannot be followed.
    """
    earlier: tuple[float, float] | None = None
    for _ in range(MOST_TURNS):
        turn = None if _stalls(equation, speed) else _one_turn(equation, speed)
        if turn is None:
            return None
        motion, end = turn
        gain = float(motion.speed(end)) - speed
        following = speed + gain
        if earlier is not None and gain != earlier[1]:
            secant = speed - gain * (speed - earlier[0]) / (gain - earlier[1])
            following = secant if 0.5 < secant / speed < 2.0 else following
            if abs(following - speed) <= SETTLED * abs(speed):
                return _rotation(motion, 0.0, end, 1)
        earlier, speed = (speed, gain), following
    return None


def _one_turn(equation: EquationOfMotion, speed: float) -> tuple[FreeMotion, float] | None:
    """A motion from φ = 0 at a speed, rad/s, signed, and when, s, it has made one turn.

    None if the crank does not get round in the time of five turns at this speed. Raises LinkproofError where the motion
    cannot be followed.
    """
    duration = 1.25 * FULL_TURN / abs(speed)
    while duration < SLOWEST * FULL_TURN / abs(speed):
        motion = follow(equation, 0.0, speed, duration, TOLERANCE)
        end = _last_passage(motion, float(np.copysign(FULL_TURN, speed)))
        if end is not None:
            return motion, end
        duration *= 2.0
    return None


def _stalls(equation: EquationOfMotion, speed: float) -> bool:
    """Whether the crank comes to rest within the turn that it starts at φ = 0 at a speed, rad/s, signed.

    Computed is ω² over φ, by the Runge-Kutta method: over φ a stall takes no longer than a turn; over time the crank
    would swing in its dwell for ever.
    """
    angle = np.copysign(np.linspace(0.0, FULL_TURN, 2 * SAMPLES_PER_TURN + 1), speed)
    terms: list[list[float]] = equation.terms(angle).tolist()
    moment, damping, slope = terms
    step, square = float(angle[2]), speed * speed

    def gain(at: int, value: float) -> float:
        """Increase of ω², rad²/s², over a step from the table's place ``at``, where ω² is ``value``."""
        drag = math.copysign(damping[at] * math.sqrt(max(value, 0.0)), speed)
        return 2.0 * step * (moment[at] - drag - slope[at] * value)

    for at in range(0, 2 * SAMPLES_PER_TURN, 2):
        first = gain(at, square)
        second = gain(at + 1, square + 0.5 * first)
        third = gain(at + 1, square + 0.5 * second)
        square += (first + 2.0 * (second + third) + gain(at + 2, square + third)) / 6.0
        if square <= 0.0:
            return True
    return False
