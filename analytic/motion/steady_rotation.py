"""Steady rotation under a crank torque: mean speed and coefficient of fluctuation.

Over a turn of steady rotation the crank's torque and the damping do equal work, whatever the inertia and the
conservative loads do in between: with a constant M1 and b the mean of ω over φ is M1/b exactly. The mean over time, 2π
over the time of a turn, is a little less, since the crank dwells where it is slow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN, Law
from analytic.dynamics import reduced
from analytic.dynamics.equation_of_motion import EquationOfMotion, equation_of_motion
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import TOLERANCE, FreeMotion, follow
from analytic.numerics.refine import extremes, grid, periodic_mean
from analytic.numerics.roots import root

Array = NDArray[np.float64]

# Shares of the mean speed to start the search from: at the first angle the crank may be faster than in the mean.
GUESSES: Final = (1.0, 1.5, 2.5)
MOST_TURNS: Final = 60
SETTLED: Final = 1e-10  # step of the search, relative: a secant's error is far below its step
SLOWEST: Final = 8.0  # times the guessed time of a turn: slower is a stall
SAMPLES: Final = 720  # per turn
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
    """The rotation in the last whole turns of a motion; raises LinkproofError if it did not make them."""
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
    """Mean speeds, rad/s, over time and over φ, and the extreme speeds, between two instants, s."""

    def speed(phase: Array) -> Array:
        return motion.speed(start + (end - start) * (phase % FULL_TURN) / FULL_TURN)

    result, time = extremes(speed, SAMPLES * turns), end - start
    travelled = float(motion.angle(end) - motion.angle(start))
    square = motion.speed(np.linspace(start, end, 8 * SAMPLES * turns + 1)) ** 2  # dφ = ω dt
    over_angle = float(np.mean(0.5 * (square[1:] + square[:-1]))) * time / travelled
    return Rotation(travelled / time, over_angle, result.maximum, result.minimum)


def _last_passage(motion: FreeMotion, angle: float) -> float | None:
    """The last time, s, at which the crank passes an angle, rad; None if it never does."""
    times = motion.windows.starts
    ahead = motion.angle(times) >= angle
    changes = np.flatnonzero(ahead[1:] != ahead[:-1])
    if not len(changes):
        return None
    left, right = times[changes[-1]], times[changes[-1] + 1]
    return root(lambda time: float(motion.angle(time)) - angle, float(left), float(right))


def steady_state(mechanism: Mechanism, torque: float | Law) -> Rotation:
    """The rotation that repeats itself turn after turn under a crank torque M1, N m, a number or a law of φ.

    Raises LinkproofError without a steady rotation: no damping, no mean torque, or too little torque for the loads.
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
    """Search the speed at φ = 0 that a turn brings back, by secants of the turn's map; None if the crank stalls."""
    earlier: tuple[float, float] | None = None
    for _ in range(MOST_TURNS):
        turn = None if _stalls(equation, speed) else _turn(equation, speed)
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


def _turn(equation: EquationOfMotion, speed: float) -> tuple[FreeMotion, float] | None:
    """A motion of one turn from φ = 0 and the time it takes, s; None if the crank does not get round."""
    duration = 1.25 * FULL_TURN / abs(speed)
    while duration < SLOWEST * FULL_TURN / abs(speed):
        motion = follow(equation, 0.0, speed, duration, TOLERANCE)
        end = _last_passage(motion, float(np.copysign(FULL_TURN, speed)))
        if end is not None:
            return motion, end
        duration *= 2.0
    return None


def _stalls(equation: EquationOfMotion, speed: float) -> bool:
    """Whether the crank comes to rest within the turn that it starts at φ = 0: ω² over φ, by the Runge-Kutta method.

    Over φ a stall takes no longer than a turn; over time the crank would swing in its dwell for ever.
    """
    angle = np.copysign(np.linspace(0.0, FULL_TURN, 2 * SAMPLES + 1), speed)
    terms: list[list[float]] = equation.terms(angle).tolist()
    moment, damping, slope = terms
    step, square = float(angle[2]), speed * speed

    def gain(at: int, value: float) -> float:
        drag = math.copysign(damping[at] * math.sqrt(max(value, 0.0)), speed)
        return 2.0 * step * (moment[at] - drag - slope[at] * value)

    for at in range(0, 2 * SAMPLES, 2):
        first = gain(at, square)
        second = gain(at + 1, square + 0.5 * first)
        third = gain(at + 1, square + 0.5 * second)
        square += (first + 2.0 * (second + third) + gain(at + 2, square + third)) / 6.0
        if square <= 0.0:
            return True
    return False
