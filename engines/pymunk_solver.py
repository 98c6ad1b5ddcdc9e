"""How many iterations pymunk's solver needs for a scene, from the scene itself."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.laws import FULL_TURN
from engines.contract import Scene
from engines.pymunk_layout import Layout
from engines.pymunk_reactions import contraction, gaps
from engines.pymunk_space import add_motor, build_world
from engines.pymunk_stepping import calls, place

Array = NDArray[np.float64]

# Crank angles of a turn at which the solver's convergence is looked at.
ANGLES = 36

# Bounds of the iteration count; the lower is pymunk's default.
FEWEST, MOST = 10, 2000

# Steps and iterations spent on closing the joints at each of these angles: at first, and again if they have not closed.
EFFORTS = ((4, 200), (30, 500))

# Step of these moves, s: short, so that gravity cannot pull open what the solver leaves undone.
MOVING_STEP = 1e-4

# Joints this close, as a share of the scene's size, show the convergence of closed ones.
CLOSED = 1e-4


def iterations_for(scene: Scene, layout: Layout, remaining: float) -> int:
    """Iterations after which no more than ``remaining`` of an impulse's change over a step is left wrong.

    The linkage is turned through all crank angles and the worst convergence met on the way counts. Angles it cannot
    reach (a crank that only rocks) are left out. Less than 0.5 is needed: as a step starts from the impulses of the
    last one, which closed that one's gaps, joints left more open than that are pushed further open by the next.
    """
    try:
        worst = contraction(layout, turned_through(scene, layout))
    except np.linalg.LinAlgError:
        return MOST
    if not 0.0 < worst < 1.0:
        return FEWEST if worst <= 0.0 else MOST
    return min(MOST, max(FEWEST, math.ceil(math.log(remaining) / math.log(worst))))


def turned_through(scene: Scene, layout: Layout) -> Array:
    """States of the parts, (n, parts, 3), around a turn of the crank; the start comes first and is always among them."""
    closed = np.ones(1, dtype=bool)
    states = np.zeros((1, len(layout.parts), 3))
    for settling, iterations in EFFORTS:
        world = build_world(scene, layout, iterations=iterations, error_bias=0.0)
        on = calls(world, add_motor(world))
        on.look()
        for number in range(1, ANGLES):
            place(world, on, MOVING_STEP, scene.crank_angle + FULL_TURN * number / ANGLES, settling)
            on.look()
        states = on.collected()[:, :, 0]
        closed = np.isfinite(states).all(axis=(1, 2)) & (gaps(layout, states).max(axis=1) < CLOSED * layout.reach)
        if closed.all():
            break
    closed[0] = True
    return states[closed]
