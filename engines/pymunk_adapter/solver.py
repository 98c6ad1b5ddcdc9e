"""How many iterations pymunk's solver needs for a scene, from the scene itself."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from engines.mechanics.states import body_masses
from engines.pymunk_adapter.layout import Gear, PartLayout
from engines.pymunk_adapter.recording import gaps, posed
from engines.pymunk_adapter.space import add_motor, build_world
from engines.pymunk_adapter.stepping import calls, place
from engines.scene import Prescribed, Scene
from engines.stepping.driver import UnsupportedError

Array = NDArray[np.float64]

# Crank angles at which the solver's convergence is looked at.
ANGLES = 36

# Bounds of the iteration count; the lower is pymunk's default.
FEWEST, MOST = 10, 3000

# A step starts from the impulses of the last one, which closed that one's gaps. Joints of which half is left are pushed
# open by that; this much less is asked of the solver where it cannot do better in MOST iterations.
LARGEST_REMAINDER = 0.2

# Steps and iterations spent on closing the joints at each of these angles: at first, and again if they have not closed.
EFFORTS = ((4, 200), (30, 500))

# Step of these moves, s: short, so that gravity cannot pull open what the solver leaves undone.
MOVING_STEP = 1e-4

# Joints this close, as a share of the scene's size, show the convergence of closed ones.
CLOSED = 1e-4


def iterations_for(scene: Scene, layout: PartLayout, remaining: float) -> int:
    """Iterations after which no more than ``remaining`` of an impulse's change over a step is left wrong.

    The linkage is turned through the crank angles of its motion, and the worst convergence met on the way counts. A
    free crank may not reach them all: those at which the joints do not close are left out. Raises UnsupportedError
    where a motion leads through an angle at which no number of iterations will do.
    """
    states = turned_through(scene, layout)
    try:
        factors = contraction(layout, states)
    except np.linalg.LinAlgError:
        factors = np.ones(len(states))
    worst = float(np.max(factors))
    if _iterations(worst, LARGEST_REMAINDER) > MOST and isinstance(scene.drive, Prescribed):
        angle = math.degrees(states[int(np.argmax(factors)), layout.crank, 2])
        raise UnsupportedError(
            f"pymunk's solver does not converge at a crank angle of {angle:.0f}°, where the linkage all but falls into "
            f"its other assembly: an iteration leaves {worst:.6f} of the error, and {MOST} are the most that are tried"
        )
    return math.ceil(min(MOST, max(FEWEST, _iterations(worst, remaining))))


def _iterations(factor: float, remaining: float) -> float:
    """Number n for which factorⁿ is ``remaining``."""
    if factor <= 0.0:
        return 0.0
    return math.log(remaining) / math.log(factor) if factor < 1.0 else math.inf


def _angles(scene: Scene) -> Array:
    """Crank angles to look at, rad, from the start on: those of a prescribed motion, or of a full turn."""
    start, way = scene.crank_angle, FULL_TURN
    if isinstance(scene.drive, Prescribed):
        motion = scene.drive.motion
        angles = motion.angle(np.linspace(0.0, motion.duration, 201))
        if np.ptp(angles) < FULL_TURN:
            low, high = float(np.min(angles)), float(np.max(angles))
            start, way = (low, high - low) if start - low <= high - start else (high, low - high)
    return start + way * np.arange(1, ANGLES + 1) / ANGLES


def turned_through(scene: Scene, layout: PartLayout) -> Array:
    """States of the parts, (n, parts, 3), at crank angles of the motion, that of the start always among them."""
    closed = np.ones(1, dtype=bool)
    states = np.zeros((1, len(layout.parts), 3))
    for settling, iterations in EFFORTS:
        world = build_world(layout, iterations=iterations, error_bias=0.0)
        on = calls(world, add_motor(world))
        on.look()
        for angle in _angles(scene):
            place(world, on, MOVING_STEP, float(angle), settling)
            on.look()
        states = on.collected()[:, :, 0]
        closed = np.isfinite(states).all(axis=(1, 2)) & (gaps(layout, states).max(axis=1) < CLOSED * layout.reach)
        if closed.all():
            break
    closed[0] = True
    return states[closed]


def contraction(layout: PartLayout, state: Array) -> Array:
    """Factor by which one iteration of pymunk's solver shrinks its error in the long run, (n,), at given positions.

    The solver is a block Gauss-Seidel iteration on A = G M⁻¹ Gᵀ, constraint by constraint in the order of the holds,
    the motor last; this is the spectral radius of its iteration matrix. Raises LinAlgError where A has an empty row.
    """
    equations = layout.equations
    rows = equations.jacobian(posed(layout, state)[1])
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
