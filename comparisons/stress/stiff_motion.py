"""The motion of a released crank that its dampers hold back so hard that it forgets its speed at once.

``analytic.motion.released`` follows every relaxation time with a window of its own, which is exact and, here, without
end. Radau's method of order 5 does not have to; where both can be had they agree to 1e-11 of the peak.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import ReleasedRegime
from analytic.dynamics.equation_of_motion import EquationOfMotion, equation_of_motion
from analytic.dynamics.reduced import damping_coefficient, reduced_inertia
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism

Array = NDArray[np.float64]

RELATIVE, ABSOLUTE = 1e-11, 1e-13  # tolerances of φ, rad, and ω, rad/s
MOST_RELAXATIONS = 1e3  # of the time constant Jeq/b: up to here a window each is cheap


@dataclass(frozen=True)
class StiffMotion:
    """φ(t) by Radau's method; ``state`` gives φ and ω, (2, n), at times (n,)."""

    regime: str
    duration: float
    equation: EquationOfMotion
    state: Callable[[Array], Array]
    nodes: Array

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        return self._at(time, 0)

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        return self._at(time, 1)

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s², by the equation of motion."""
        return self.equation.acceleration(self.angle(time), self.speed(time))

    def _at(self, time: ArrayLike, part: int) -> Array:
        clock = np.asarray(time, dtype=float)
        return np.asarray(self.state(clock.reshape(-1))[part].reshape(clock.shape))

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps: none."""
        return ()

    @cached_property
    def peak_speed(self) -> float:
        """Largest |ω| at the method's own steps, rad/s."""
        return float(np.max(np.abs(self.speed(self.nodes))))


def relaxations(mechanism: Mechanism, duration: float) -> float:
    """How many of its shortest time constants Jeq/b a damped crank is released for."""
    turn = mechanism.turn
    return duration * float(np.max(damping_coefficient(turn) / reduced_inertia(turn)))


def stiff_motion(mechanism: Mechanism, own: ReleasedRegime) -> StiffMotion:
    """Let the crank go; raises LinkproofError where Radau's method gives up."""
    from scipy.integrate import solve_ivp  # noqa: PLC0415  only stiff cells pay for it

    equation = equation_of_motion(mechanism, own.torque).tabulated()

    def rate(_: float, state: Array) -> tuple[float, float]:
        return float(state[1]), float(equation.acceleration(state[0], state[1]))

    start = (own.start_angle, own.start_speed)
    solution = solve_ivp(
        rate, (0.0, own.duration), start, method="Radau", rtol=RELATIVE, atol=ABSOLUTE, dense_output=True
    )
    if not solution.success or not math.isfinite(solution.y[0, -1]):
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected a motion to its end, got '{solution.message}'; damp less"
        )
    return StiffMotion(own.name, own.duration, equation, solution.sol, solution.t)
