"""How many iterations pymunk's solver needs for a scene, from the scene itself."""

from __future__ import annotations

import math

import numpy as np

from engines.contract import Scene
from engines.pymunk_layout import Layout
from engines.pymunk_reactions import contraction, gaps
from engines.pymunk_space import add_motor, build_world
from engines.pymunk_stepping import calls, place

# Crank angles of a turn at which the solver's convergence is looked at.
ANGLES = 16

# Bounds of the iteration count; the lower is pymunk's default.
FEWEST, MOST = 10, 1000

# Effort of the moves from angle to angle, which start without a guess, and what counts as a closed joint after one.
MOVING_ITERATIONS = 200
CLOSED = 1e-6


def iterations_for(scene: Scene, layout: Layout, remaining: float) -> int:
    """Iterations after which no more than ``remaining`` of an impulse's change over a step is left wrong.

    The linkage is turned through all crank angles and the worst convergence met on the way counts. Angles it cannot
    reach (a crank that only rocks) are left out.
    """
    try:
        worst = contraction(layout, _turned_through(scene, layout))
    except np.linalg.LinAlgError:
        return MOST
    if not 0.0 < worst < 1.0:
        return FEWEST if worst <= 0.0 else MOST
    return min(MOST, max(FEWEST, math.ceil(math.log(remaining) / math.log(worst))))


def _turned_through(scene: Scene, layout: Layout) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """States of the parts, (n, parts, 3), around a turn; the start comes first and is always among them."""
    world = build_world(scene, layout, iterations=MOVING_ITERATIONS, error_bias=0.0)
    on = calls(world, add_motor(world))
    on.look()
    for number in range(1, ANGLES):
        place(world, on, 1.0, scene.crank_angle + 2.0 * math.pi * number / ANGLES)
        on.look()
    states = on.collected()[:, :, 0]
    closed = np.isfinite(states).all(axis=(1, 2)) & (gaps(layout, states).max(axis=1) < CLOSED * layout.reach)
    closed[0] = True
    return np.asarray(states[closed])
