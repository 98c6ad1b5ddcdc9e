"""Andrews' squeezing mechanism in the seven angles of its source, as an ordinary differential equation of second order.

Every place is a sum of vectors that turn with sums of the angles q = (β, Θ, γ, Φ, δ, Ω, ε), so that its derivatives are
sums of the same kind. Accelerations and multipliers follow together from the equations of motion and the second
derivative of the six closures. Lengths, masses and angles are typed from the problem's description; SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

BETA, THETA, GAMMA, PHI, DELTA, OMEGA, EPSILON = np.eye(7)
A, B, C = -0.06934 - 0.00227j, -0.03635 + 0.03273j, 0.014 + 0.072j
STIFFNESS, FREE_LENGTH, TORQUE = 4530.0, 0.07785, 0.033
START = np.array(
    [
        *(-0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449),
        *(0.222668390165885884674473185609, 0.487364979543842550225598953530),
        *(-0.222668390165885884674473185609, 1.23054744454982119249735015568),
    ]
)


@dataclass(frozen=True)
class Place:
    """A fixed place and vectors on it, each with the angles whose sum it turns by."""

    fixed: complex
    vectors: tuple[tuple[complex, Array], ...]

    def plus(self, vector: complex, turns: Array) -> Place:
        """A place that lies by a vector from it."""
        return Place(self.fixed, (*self.vectors, (vector, turns)))

    def at(self, q: Array) -> complex:
        """Where it is."""
        return self.fixed + sum(v * np.exp(1j * (turns @ q)) for v, turns in self.vectors)

    def slopes(self, q: Array) -> NDArray[np.complex128]:
        """Its derivative with respect to every angle."""
        return np.sum([1j * v * np.exp(1j * (turns @ q)) * turns for v, turns in self.vectors], axis=0)

    def pull(self, q: Array, speed: Array) -> complex:
        """Its acceleration where the angles have none."""
        return -sum(v * np.exp(1j * (turns @ q)) * (turns @ speed) ** 2 for v, turns in self.vectors)


O_PIVOT, A_PIVOT, B_PIVOT = Place(0j, ()), Place(A, ()), Place(B, ())
F = O_PIVOT.plus(7e-3, BETA)
G, H = A_PIVOT.plus(40e-3, DELTA), A_PIVOT.plus(-40e-3j, EPSILON)
D = B_PIVOT.plus(20e-3 - 18e-3j, GAMMA)
# The pin E as the ends of K2, K3, K4 and K6.
ENDS = (
    F.plus(-28e-3, BETA + THETA),
    B_PIVOT.plus(-35e-3j, GAMMA),
    G.plus(-20e-3j, PHI + DELTA),
    H.plus(20e-3, OMEGA + EPSILON),
)
# K1 to K7: mass, moment of inertia, angle, mass centre.
LINKS = (
    (0.04325, 2.194e-6, BETA, O_PIVOT.plus(0.92e-3, BETA)),
    (0.00365, 4.410e-7, BETA + THETA, F.plus(-11.5e-3, BETA + THETA)),
    (0.02373, 5.255e-6, GAMMA, B_PIVOT.plus(10.43e-3 - 18.74e-3j, GAMMA)),
    (0.00706, 5.667e-7, PHI + DELTA, G.plus(-5.79e-3j, PHI + DELTA)),
    (0.07050, 1.169e-5, DELTA, A_PIVOT.plus(23.08e-3 + 9.16e-3j, DELTA)),
    (0.00706, 5.667e-7, OMEGA + EPSILON, H.plus(5.79e-3, OMEGA + EPSILON)),
    (0.05498, 1.912e-5, EPSILON, A_PIVOT.plus(-4.49e-3 - 12.28e-3j, EPSILON)),
)


def accelerations(q: Array, speed: Array) -> tuple[Array, Array]:
    """Second derivatives of the angles (7,), rad/s², and forces at E on K3, K4 and K6 (3, 2), N."""
    mass, load = np.zeros((7, 7)), TORQUE * BETA
    for m, inertia, turns, centre in LINKS:
        slopes = centre.slopes(q)
        mass += m * np.real(np.outer(slopes.conj(), slopes)) + inertia * np.outer(turns, turns)
        load = load - m * np.real(slopes.conj() * centre.pull(q, speed))
    spring = D.at(q) - C
    load = load + np.real(D.slopes(q).conj() * -STIFFNESS * (abs(spring) - FREE_LENGTH) * spring / abs(spring))
    gaps = [ENDS[0].slopes(q) - end.slopes(q) for end in ENDS[1:]]
    pulls = [ENDS[0].pull(q, speed) - end.pull(q, speed) for end in ENDS[1:]]
    closure = np.array([part for gap in gaps for part in (gap.real, gap.imag)])
    bias = np.array([part for pull in pulls for part in (pull.real, pull.imag)])
    matrix = np.block([[mass, closure.T], [closure, np.zeros((6, 6))]])
    solution = np.linalg.solve(matrix, np.concatenate([load, -bias]))
    return solution[:7], solution[7:].reshape(3, 2)


def state_after(duration: float) -> tuple[Array, Array]:
    """Angles and their rates after a time from rest, to about 1e-13."""

    def slope(_time: float, state: Array) -> Array:
        return np.concatenate([state[7:], accelerations(state[:7], state[7:])[0]])

    start = np.concatenate([START, np.zeros(7)])
    run = solve_ivp(slope, (0.0, duration), start, method="DOP853", rtol=3e-14, atol=1e-15)
    return run.y[:7, -1], run.y[7:, -1]
