"""Number of iterations that pymunk's solver needs for a scene, from the scene itself.

The impulses of a step start from those of the last one. What the iterations leave of their change is carried into the
next step, where it opens the joints: where half of it is left, they are pushed open further from step to step, however
short the steps are. How fast an iteration converges depends on masses and positions, from a handful of iterations to
thousands.
"""

from __future__ import annotations

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.linkage import DriverKind
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import Pose, body_masses
from engines.pymunk_adapter.layout import PartLayout
from engines.scene import Free, Scene

# Driver positions of the motion at which convergence is looked at, and the corrections that close the joints there.
POSES, CORRECTIONS = 90, 8
CLOSED = 1e-9  # joints that open by less, as a share of the scene's size
# Bounds of the iteration count, the lower of them pymunk's default; beyond ENOUGH no more are spent than leave
# LARGEST_REMAINDER of a change wrong, which keeps the joints from being pushed open.
FEWEST, ENOUGH, MOST = 10, 1000, 10_000
LARGEST_REMAINDER = 0.3


def iterations_for(layout: PartLayout, remaining: float) -> int:
    """Iterations after which no more than ``remaining`` of an impulse's change over a step is left wrong."""
    with np.errstate(all="ignore"):
        worst = max(contraction(layout, pose) for pose in poses_of(layout.equations))
        enough, needed = np.log([remaining, LARGEST_REMAINDER]) / np.log(min(worst, 1.0 - 1e-12))
    return int(np.clip(max(min(enough, ENOUGH), needed), FEWEST, MOST))


def way(scene: Scene) -> float:
    """Travel of the driver from its start, rad or m, to its farther side; a crank's is a full turn at most."""
    if isinstance(scene.drive, Free):
        return FULL_TURN
    farthest = max((end - scene.crank_angle for end in scene.drive.motion.reach), key=abs)
    return max(-FULL_TURN, min(FULL_TURN, farthest)) if scene.driver_kind is DriverKind.CRANK else farthest


def poses_of(equations: JointEquations) -> list[Pose]:
    """The poses of the parts along the motion, that of the start first, up to the first where joints do not close."""
    pose = equations.start()
    start = equations.driven(pose, equations.arms(pose))
    poses = [pose]
    for travel in way(equations.scene) / equations.driver.scale * np.arange(1, POSES + 1) / POSES:
        for _ in range(CORRECTIONS):
            arms = equations.arms(pose)
            residual = equations.residual(pose, arms)
            residual[:, equations.crank_row] = equations.driven(pose, arms) - start - travel
            if np.abs(residual).max() < CLOSED:
                break
            try:
                change = np.linalg.solve(equations.jacobian(arms), -residual[..., None])[..., 0]
            except np.linalg.LinAlgError:
                return poses
            pose = pose.moved(equations.spread(change))
        else:
            return poses
        poses.append(pose)
    return poses


def contraction(layout: PartLayout, pose: Pose) -> float:
    """Factor by which one iteration of pymunk's solver shrinks its error in the long run, at one pose.

    The solver is a block Gauss-Seidel iteration on A = G M⁻¹ Gᵀ, constraint by constraint: pins, grooves, gears, motor.
    This is the spectral radius of its iteration matrix.
    """
    equations = layout.equations
    rows = equations.jacobian(equations.arms(pose))[0]
    masses = equations.gather((body_masses(layout.scene) / (1.0, 1.0, equations.unit**2))[None])[0]
    mobility = rows / masses @ rows.T
    pins = np.arange(equations.pins)
    visit = np.concatenate([pins, pins, np.arange(len(pins), equations.rows - len(pins))])
    lower = np.where(visit[:, None] >= visit[None, :], mobility, 0.0)
    try:
        return float(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - mobility)))))
    except np.linalg.LinAlgError:
        return 1.0
