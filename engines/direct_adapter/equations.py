"""The joints' equations of a scene, solved for many instants at once: linear systems in G, and Newton's method."""

from __future__ import annotations

import math

import numpy as np

from engines.mechanics.joints import JointEquations
from engines.mechanics.states import Pose, Reals
from engines.stepping.driver import DivergedError

PASSES = 12  # of Newton's method
SHRINKING = 0.25  # of a correction over the one before it
UNFINISHED = 1e-9  # units and rad: a correction that no longer shrinks is rounding if it is smaller, failure if not
EPS = float(np.finfo(float).eps)


class UnsolvableError(DivergedError):
    """The scene cannot be put together or solved somewhere; the message is the run's reason."""


class Equations(JointEquations):
    """The joints' equations with a count of the linear systems solved, one for every right-hand side of an instant."""

    solves = 0

    def solve(self, matrix: Reals, right: Reals) -> Reals:
        """Solve G x = right, or with Gᵀ for the multipliers, (n, k); raises UnsolvableError where G is singular."""
        self.solves += len(right)
        try:
            first = np.linalg.solve(matrix, right[..., None])
            return np.asarray((first + np.linalg.solve(matrix, right[..., None] - matrix @ first))[..., 0])
        except np.linalg.LinAlgError:
            raise UnsolvableError("the constraint equations are singular") from None

    def violation(self, pose: Pose, coordinate: Reals) -> tuple[Reals, Reals]:
        """Φ with the driver at ``coordinate`` (n,), rad or units, and G."""
        arms = self.arms(pose)
        residual = self.residual(pose, arms)
        residual[:, self.crank_row] = self.driven(pose, arms) - coordinate
        return residual, self.jacobian(arms)

    def close(self, pose: Pose, coordinate: Reals) -> Pose:
        """Close all joints by Newton's method, from poses that are near; raises UnsolvableError where it does not end.

        ``coordinate`` (n,) is φ, rad or units.
        """
        before = math.inf
        for _ in range(PASSES):
            residual, matrix = self.violation(pose, coordinate)
            step = self.solve(matrix, -residual)
            worst = float(np.max(np.abs(step)))
            if not worst <= max(SHRINKING * before, UNFINISHED):
                break
            pose = pose.moved(self.spread(step))
            if worst <= EPS or worst > SHRINKING * before:
                return pose
            before = worst
        raise UnsolvableError("the joints cannot be closed")
