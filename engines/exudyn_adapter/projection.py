"""A state that fits every joint and the drive exactly, from exudyn's own constraint equations.

A rule with its constraints on velocity level lets positions drift off them: along 1000 turns by the square of the step
at first, and where a linkage magnifies that, to nothing like its motion. Where the crank is prescribed the constraints
g(q, t) = 0 fix everything, so a run can be put back on them wherever it is started anew (coordinate projection:
E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 1996, section VII.2):

    g = 0 by Newton's method,    G q̇ + gₜ = 0,    G q̈ + d/dt (G q̇ + gₜ) at constant q̇ = 0,    G = ∂g/∂q
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines.exudyn_adapter.drive import Foreign
from engines.exudyn_adapter.model import Model

Array = NDArray[np.float64]

PASSES = 12
CLOSED = 1e-9  # of the unit of length and rad: a correction whose square, which is the next, is rounding
UNFINISHED = 1e-7  # likewise: one that no longer shrinks is rounding if it is smaller, failure if not
CONTRACTION = 0.25  # of each correction over the one before: the solution is the one in sight
TURNED = 1e-2  # rad the crank turns between the places of a difference quotient
# Central difference of sixth order at -3 … 3 times the distance.
QUOTIENT = ((-3, -1 / 60), (-2, 3 / 20), (-1, -3 / 4), (1, 3 / 4), (2, -3 / 20), (3, 1 / 60))


@dataclass(frozen=True)
class ProjectedState:
    """Coordinates and their first two time derivatives that fit all constraints.

    ``side`` is the sign of det G, which a motion can only change where it is singular: at a dead or change point.
    """

    position: Array
    velocity: Array
    acceleration: Array
    side: float


class Constraints:
    """The constraint equations of a model as exudyn evaluates them; its static solver has no time in its Jacobian.

    A multiplier that its joint does not use has an equation without coordinates, which is left out.
    """

    def __init__(self, model: Model) -> None:
        exudyn = model.exudyn
        self.mbs = model.mbs
        self.current = exudyn.ConfigurationType.Current
        self.solver: Foreign = exudyn.MainSolverStatic()
        settings = exudyn.SimulationSettings()
        settings.solution.file.write = False
        settings.solution.sensors.active = False
        self.solver.InitializeSolver(self.mbs, settings)
        self.size = int(self.solver.GetODE2size())
        self.systems = 0  # linear systems solved
        self.still = np.zeros(self.size)

    def residual(self, q: Array, velocity: Array, time: float, *, on_velocities: bool) -> Array:
        """Values of g, or of its time derivative."""
        self._set(q, velocity, time)
        self.solver.ComputeAlgebraicEquations(self.mbs, on_velocities)
        return np.array(self.solver.GetSystemResidual())[self.size :]

    def jacobian(self, q: Array, time: float) -> tuple[Array, NDArray[np.bool_]]:
        """G, square, and which of the equations it holds."""
        self._set(q, self.still, time)
        self.solver.ComputeJacobianODE2RHS(self.mbs, scalarFactor_ODE2=-1.0)  # clears the matrix
        self.solver.ComputeJacobianAE(self.mbs)
        matrix = np.array(self.solver.GetSystemJacobian())[self.size :, : self.size]
        used = np.any(matrix != 0.0, axis=1)
        self.systems += 1
        return matrix[used], used

    def side(self, q: Array, time: float) -> float:
        """Sign of det G."""
        return float(np.linalg.slogdet(self.jacobian(q, time)[0])[0])

    def _set(self, q: Array, velocity: Array, time: float) -> None:
        state = self.mbs.systemData
        state.SetODE2Coordinates(q, configuration=self.current)
        state.SetODE2Coordinates_t(velocity, configuration=self.current)
        state.SetTime(time, self.current)


def projected_state(
    constraints: Constraints, q: Array, time: float, pace: float, *, strict: bool
) -> ProjectedState | None:
    """The state at a time of a prescribed motion whose coordinates are near those given; None where there is none.

    ``pace``, rad/s, is about how fast the crank turns. Where the drive's acceleration jumps, that of the functions of
    time set on the driver counts. ``strict`` takes no coordinates that Newton's method does not find straight away:
    near a change point another assembly mode may be as near.
    """
    try:
        found = _closed(constraints, q, time, CONTRACTION if strict else 1.0)
        return None if found is None else _with_derivatives(constraints, found, time, TURNED / pace)
    except np.linalg.LinAlgError:
        return None


def _closed(constraints: Constraints, q: Array, time: float, contraction: float) -> Array | None:
    before = math.inf
    for _ in range(PASSES):
        residual = constraints.residual(q, constraints.still, time, on_velocities=False)
        matrix, used = constraints.jacobian(q, time)
        step = np.linalg.solve(matrix, residual[used])
        q = q - step
        size = float(np.abs(step).max())
        if size <= CLOSED or UNFINISHED >= size >= 0.5 * before:
            return q
        if not size < contraction * before:
            return None
        before = size
    return None


def _with_derivatives(constraints: Constraints, q: Array, time: float, distance: float) -> ProjectedState | None:
    """Velocities and accelerations of closed coordinates; ``distance``, s, of the places of a difference quotient."""
    matrix, used = constraints.jacobian(q, time)
    inverse = -np.linalg.inv(matrix)
    rate = inverse @ constraints.residual(q, constraints.still, time, on_velocities=True)[used]
    bend = np.zeros(len(used))
    for places, weight in QUOTIENT:
        later = places * distance
        bend += weight / distance * constraints.residual(q + later * rate, rate, time + later, on_velocities=True)
    second = inverse @ bend[used]
    if not (np.isfinite(rate).all() and np.isfinite(second).all()):
        return None
    return ProjectedState(q, rate, second, float(np.linalg.slogdet(matrix)[0]))
