"""Closing the joints of a scene by Newton's method, and solving the linear systems that follow, many instants at once.

One matrix per instant is inverted, at the pose Newton's method starts from. It serves the corrections of the pose and,
by iterative refinement with the matrix of the closed pose, every linear system after that to the last digit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines.mechanics.joints import Arms, JointEquations
from engines.mechanics.states import Pose, Reals
from engines.scene import Scene
from engines.stepping.driver import DivergedError

NEAR = 1e-6  # units and rad of a first correction that leave an inverse good enough for two refinements
CONTRACTION = 0.25  # of a second correction over the first: Newton's method has its solution in sight
PASSES = 12
UNFINISHED = 1e-9  # a correction that no longer shrinks is rounding if it is smaller, failure if not


class UnsolvableError(DivergedError):
    """The scene cannot be put together or solved somewhere; the message is the run's reason."""


class Equations(JointEquations):
    """The joints' equations with a count of the linear systems solved, one for every right-hand side of an instant."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.solves = 0


@dataclass(frozen=True)
class Solver:
    """Linear systems in G at n instants: an inverse good to a few digits at least, and the matrix to refine with."""

    equations: Equations
    inverse: Reals
    matrix: Reals
    passes: int = 2

    def solve(self, right: Reals) -> Reals:
        """G x = right, (n, k)."""
        self.equations.solves += len(right)
        return _refined(self.inverse, self.matrix, right, self.passes)

    def solve_transposed(self, right: Reals) -> Reals:
        """Gᵀ x = right, (n, k)."""
        self.equations.solves += len(right)
        return _refined(self.inverse.swapaxes(1, 2), self.matrix.swapaxes(1, 2), right, self.passes)


def _refined(inverse: Reals, matrix: Reals, right: Reals, passes: int) -> Reals:
    result = _product(inverse, right)
    for _ in range(passes):
        result = result + _product(inverse, right - _product(matrix, result))
    return result


def _product(matrix: Reals, vector: Reals) -> Reals:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def inverted(matrix: Reals) -> Reals:
    """Inverses in double precision; raises UnsolvableError where there is none."""
    try:
        return np.linalg.inv(matrix.astype(float))
    except np.linalg.LinAlgError:
        raise UnsolvableError("the constraint equations are singular") from None


@dataclass(frozen=True)
class Closed:
    """Poses with every joint closed to rounding; ``first`` (n,) is how far off they were at the start.

    ``smooth``: beside change points, the instants where the inverse is no number, and q' and q'' there, (2, m, k).
    """

    pose: Pose
    arms: Arms
    inverse: Reals
    first: Reals
    smooth: tuple[NDArray[np.bool_], Reals] | None = None

    def solver(self, equations: Equations, passes: int = 2) -> Solver:
        """For the velocities, accelerations and forces of these poses."""
        return Solver(equations, self.inverse, equations.jacobian(self.arms), passes)


def close(equations: Equations, pose: Pose, coordinate: Reals) -> Closed:
    """Newton's method from poses that are near, all at once, with the first Jacobian kept.

    ``coordinate`` (n,) is φ, rad or units; a crank is there already. Raises UnsolvableError where the corrections do
    not shrink.
    """
    arms = equations.arms(pose)
    inverse = inverted(equations.jacobian(arms))
    rounding = float(np.finfo(pose.place.dtype).eps) / 16.0
    first, before = None, math.inf
    for _ in range(PASSES):
        residual = equations.residual(pose, arms)
        residual[:, equations.crank_row] = equations.driven(pose, arms) - coordinate
        step = _product(inverse, -residual)
        equations.solves += len(step)
        if equations.driver.turns:
            step[:, equations.crank_column] = 0.0  # the crank is where the drive has it, to the last digit
        pose = pose.moved(equations.spread(step))
        arms = equations.arms(pose)
        sizes = np.max(np.abs(step), axis=1)
        worst = float(np.max(sizes))
        if not worst <= max(CONTRACTION * before, UNFINISHED):
            break
        expected = worst if first is None else worst * worst / before
        first = sizes if first is None else first
        if expected <= rounding or worst > CONTRACTION * before:
            return Closed(pose, arms, inverse, first)
        before = worst
    raise UnsolvableError("the joints cannot be closed")
