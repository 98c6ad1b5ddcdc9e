"""The integrator of articles 000 and 001: the classical Runge-Kutta method with a fixed step (Mathcad's ``rkfixed``).

It serves to show its error: 1000 steps in 10 s are more than a radian of crank each at the steady speed of the
slotted take-up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import Law
from analytic.dynamics.equation_of_motion import EquationOfMotion, equation_of_motion
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism

Array = NDArray[np.float64]

PUBLISHED_STEPS = 1000


@dataclass(frozen=True)
class FixedStepMotion:
    """Time, s, and crank angle, speed and acceleration, rad, rad/s, rad/s², at each step; all (steps + 1,)."""

    time: Array
    angle: Array
    speed: Array
    acceleration: Array


def fixed_step(
    mechanism: Mechanism,
    *,
    torque: float | Law = 0.0,
    start_angle: float = 0.0,
    start_speed: float = 0.0,
    duration: float,
    steps: int = PUBLISHED_STEPS,
    half_slope: str = "exact",
) -> FixedStepMotion:
    """The motion as the articles integrate it; arguments as for ``analytic.motion.released.free_motion``."""
    if not (steps >= 1 and np.isfinite(duration) and duration > 0.0):
        raise LinkproofError(
            f"fixed step: expected one step or more in a positive time, got {steps} in {duration:g} s; correct them"
        )
    equation = equation_of_motion(mechanism, torque, half_slope).tabulated()
    states, step = np.empty((steps + 1, 2)), duration / steps
    states[0] = start_angle, start_speed
    for number in range(steps):
        with np.errstate(over="ignore", invalid="ignore"):  # reported below
            states[number + 1] = _step(equation, states[number], step)
        if not np.all(np.isfinite(states[number + 1])):
            raise LinkproofError(
                f"fixed step: expected a finite motion, got one that grows without bound after {number} of {steps} "
                "steps; take more of them"
            )
    angle, speed = states.T
    return FixedStepMotion(np.linspace(0.0, duration, steps + 1), angle, speed, equation.acceleration(angle, speed))


def _step(equation: EquationOfMotion, state: Array, step: float) -> Array:
    """One step of the classical method of order 4."""

    def rate(now: Array) -> Array:
        return np.array([now[1], float(equation.acceleration(now[0], now[1]))])

    first = rate(state)
    second = rate(state + 0.5 * step * first)
    third = rate(state + 0.5 * step * second)
    fourth = rate(state + step * third)
    return np.asarray(state + step / 6.0 * (first + 2.0 * (second + third) + fourth))
