"""The joints of a layout as linear algebra: gaps, joint forces, and how fast pymunk's solver converges.

pymunk tells the magnitude of a constraint's impulse, not its direction. The vectors follow from what the solver did to
the bodies: over one step every part obeys m (v⁺ − v⁻)/h = load + Σ joint forces, with the joints' directions at the
positions of that instant, and a linkage whose crank is driven has exactly as many unknown forces as equations. The
solution is the impulses that the solver applied, to rounding.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engines.mechanics.joints import Arms
from engines.mechanics.loads import applied_loads
from engines.mechanics.states import Pose, body_masses, pose_of, with_ground
from engines.pymunk_adapter.layout import Gear, PartLayout

Array = NDArray[np.float64]

# Samples whose joint forces are solved for at once: the equations of a sample take a hundred times their room.
BLOCK = 10_000


def gaps(layout: PartLayout, state: Array) -> Array:
    """How far each joint between parts is open, m, (n, joints). ``state`` is (n, parts, 3): x, y, θ."""
    pose, arms = _posed(layout, state)
    equations = layout.equations
    return np.asarray(equations.openings(equations.residual(pose, arms)) * equations.unit)


def joint_forces(layout: PartLayout, state: Array, rate: Array, acceleration: Array) -> dict[str, Array]:
    """Force of every joint of the scene on its first body, N, ground frame, (n, 2) by name.

    ``acceleration`` (n, parts, 3) is (v⁺ − v⁻)/h at the instants of ``state``, ``rate`` the velocities there. Under a
    free drive the drive's row comes out as zero.
    """
    blocks = [
        _joint_forces(layout, *(values[start : start + BLOCK] for values in (state, rate, acceleration)))
        for start in range(0, max(1, len(state)), BLOCK)
    ]
    forces, names = np.concatenate(blocks), layout.equations.joints
    return {name: forces[:, number] for number, name in enumerate(names) if name not in layout.inner}


def _joint_forces(layout: PartLayout, state: Array, rate: Array, acceleration: Array) -> Array:
    """The same as one array, (n, joints, 2)."""
    equations = layout.equations
    _, arms = _posed(layout, state)
    loads = applied_loads(layout.scene, pose_of(with_ground(state)), with_ground(rate))
    left = equations.generalised(body_masses(layout.scene) * with_ground(acceleration) - loads)
    multipliers = np.linalg.solve(np.swapaxes(equations.jacobian(arms), 1, 2), left[..., None])[..., 0]
    return np.asarray(equations.joint_forces(arms, multipliers))


def contraction(layout: PartLayout, state: Array) -> Array:
    """Factor by which one iteration of pymunk's solver shrinks its error in the long run, (n,), at given positions.

    The solver is a block Gauss-Seidel iteration on A = G M⁻¹ Gᵀ, constraint by constraint in the order of the holds,
    the motor last; this is the spectral radius of its iteration matrix. Raises LinAlgError where A has an empty row.
    """
    equations = layout.equations
    rows = equations.jacobian(_posed(layout, state)[1])
    masses = equations.gather((body_masses(layout.scene) / (1.0, 1.0, equations.unit**2))[None])
    mobility = np.einsum("nik,k,njk->nij", rows, 1.0 / masses[0], rows)
    block = _visits(layout)
    lower = np.where(block[:, None] >= block[None, :], mobility, 0.0)
    return np.asarray(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - mobility))), axis=1))


def _visits(layout: PartLayout) -> NDArray[np.intp]:
    """The place of every equation's hold in an iteration, (rows,); the drive's is the last."""
    equations, scene = layout.equations, layout.scene
    place = {(isinstance(hold, Gear), hold.name): number for number, hold in enumerate(layout.holds)}
    result = np.full(equations.rows, len(layout.holds), dtype=np.intp)
    result[equations.x_rows] = result[equations.y_rows] = [place[False, pin.name] for pin in scene.pins]
    result[equations.line_rows] = [place[False, joint.name] for joint in scene.guided]
    result[equations.turn_rows] = [number for (gear, _), number in place.items() if gear]
    return result


def _posed(layout: PartLayout, state: Array) -> tuple[Pose, Arms]:
    """The parts in the equations' unit, and the joints' vectors."""
    equations = layout.equations
    pose = pose_of(with_ground(state) / equations.metres)
    return pose, equations.arms(pose)
