"""How many iterations pymunk's solver needs for a scene, from the scene itself.

The impulses of a step start from those of the last one. What the iterations leave of their change is carried into the
next step, where it opens the joints: where half of it is left, they are pushed open further from step to step, however
short the steps are. How fast an iteration converges depends on masses and positions, from a handful of iterations to
thousands.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import DriverKind
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import Pose, body_masses
from engines.pymunk_adapter.layout import Gear, PartLayout
from engines.scene import Free, Scene

Array = NDArray[np.float64]

# Crank angles of a full turn at which the solver's convergence is looked at, and the corrections that close the joints.
ANGLES, CORRECTIONS = 180, 8

# Joints open by less, as a share of the scene's size, are closed.
CLOSED = 1e-9

# Bounds of the iteration count, the lower of them pymunk's default; beyond ENOUGH no more are spent than keep the
# joints from being pushed open.
FEWEST, ENOUGH, MOST = 10, 1000, 10_000
LARGEST_REMAINDER = 0.3


def iterations_for(scene: Scene, layout: PartLayout, remaining: float, even: int) -> Array:
    """Iterations (ANGLES + 1,) after which about ``remaining`` of an impulse's change over a step is left wrong.

    They are those at even crank angles from the start on (see ``way``), and the most there are where the crank is free.
    Up to ``even`` are not made fewer where fewer would do: a change of effort leaves a trace in the accelerations.
    """
    with np.errstate(all="ignore"):
        factors = np.array([contraction(layout, pose) for pose in turned_through(scene, layout.equations)])
        rates = np.log(np.minimum(factors, 1.0 - 1e-12))
        wanted, needed = (np.log(share) / rates for share in (remaining, LARGEST_REMAINDER))
    counts = np.clip(np.fmax(np.fmin(wanted, ENOUGH), needed), FEWEST, MOST)
    most = float(counts.max())
    if isinstance(scene.drive, Free):
        return np.full(ANGLES + 1, most)
    before, after = (np.roll(counts, shift) for shift in (1, -1))
    return np.resize(np.maximum.reduce([before, counts, after, np.full(len(counts), min(most, even))]), ANGLES + 1)


def way(scene: Scene) -> float:
    """How far the driver goes from its start to look at the solver, rad or m.

    It is as far as its motion does to one side, but no more than a full turn of a crank.
    """
    if isinstance(scene.drive, Free):
        return FULL_TURN
    farthest = max((end - scene.crank_angle for end in scene.drive.motion.reach), key=abs)
    return max(-FULL_TURN, min(FULL_TURN, farthest)) if scene.driver_kind is DriverKind.CRANK else farthest


def turned_through(scene: Scene, equations: JointEquations) -> list[Pose]:
    """The poses at crank angles of the scene's motion, that of the start first.

    A free crank may not reach them all: those at which the joints do not close are left out.
    """
    end = way(scene)
    start = pose = equations.start()
    start_travel = equations.driven(start, equations.arms(start))
    poses = [start]
    for angle in end / equations.driver.scale * np.arange(1, ANGLES + 1) / ANGLES:
        for _ in range(CORRECTIONS):
            arms = equations.arms(pose)
            residual = equations.residual(pose, arms)
            residual[:, equations.crank_row] = equations.driven(pose, arms) - start_travel - angle
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

    The solver is a block Gauss-Seidel iteration on A = G M⁻¹ Gᵀ, constraint by constraint in the order of the holds,
    the motor last; this is the spectral radius of its iteration matrix.
    """
    equations = layout.equations
    rows = equations.jacobian(equations.arms(pose))[0]
    masses = equations.gather((body_masses(layout.scene) / (1.0, 1.0, equations.unit**2))[None])[0]
    mobility = rows / masses @ rows.T
    block = _visits(layout)
    lower = np.where(block[:, None] >= block[None, :], mobility, 0.0)
    try:
        return float(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - mobility)))))
    except np.linalg.LinAlgError:
        return 1.0


def _visits(layout: PartLayout) -> NDArray[np.intp]:
    """The place of every equation's hold in an iteration, (rows,); the drive's is the last."""
    equations, scene = layout.equations, layout.scene
    place = {(isinstance(hold, Gear), hold.name): number for number, hold in enumerate(layout.holds)}
    result = np.full(equations.rows, len(layout.holds), dtype=np.intp)
    result[equations.x_rows] = result[equations.y_rows] = [place[False, pin.name] for pin in scene.pins]
    result[equations.line_rows] = [place[False, joint.name] for joint in scene.guided]
    result[equations.turn_rows] = [number for (gear, _), number in place.items() if gear]
    return result
