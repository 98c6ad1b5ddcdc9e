"""The joint forces read back are the impulses pymunk applied, and its solver converges as fast as is foreseen."""

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.reference.start_state import scene
from engines.mechanics.states import pose_of, with_ground
from engines.pymunk_adapter.layout import Gear, exact_layout
from engines.pymunk_adapter.recording import gaps, joint_forces
from engines.pymunk_adapter.solver import contraction, iterations_for, turned_through
from engines.pymunk_adapter.space import add_motor, build_world
from engines.pymunk_adapter.stepping import calls, march
from engines.scene import Channel, Prescribed
from tests.analytic.linkages import mechanism

pytest.importorskip("pymunk")

STEP = 2e-4  # s
EXACT = 1e-8  # of the largest force: rounding of velocities, differenced over a step
FORESEEN = 0.05  # relative error of the foreseen convergence


def _scene(name):
    return scene(mechanism(name), Prescribed(crank_motion(start_angle=0.3)), frozenset(Channel))


def _turning(name, steps=20, iterations=2000):
    """A world after some steps at constant crank speed, with what it looked like after the last two."""
    model = _scene(name)
    world = build_world(exact_layout(model), iterations=iterations, error_bias=0.0)
    on = calls(world, add_motor(world))
    march(on, STEP, [-60.0] * steps, [0] * (steps - 2) + [1, 1], None)
    return world, on.collected()


@pytest.mark.parametrize("name", ["rimoldi-164", "moving-guides", "scotch-yoke"])
def test_joint_forces_have_the_size_of_pymunks_impulses(name):
    world, seen = _turning(name)
    state, before, after = seen[1:, :, 0], seen[:1, :, 1], seen[1:, :, 1]
    reactions = joint_forces(world.layout, state, 0.5 * (before + after), (after - before) / STEP)
    forces = {name: float(np.linalg.norm(force)) for name, force in reactions.items()}
    impulses = {
        hold.name: constraint.impulse / STEP
        for hold, constraint in zip(world.layout.holds, world.constraints, strict=True)
        if not isinstance(hold, Gear) and hold.name not in world.layout.inner
    }
    assert forces == pytest.approx(impulses, abs=EXACT * max(impulses.values()))


@pytest.mark.parametrize("name", ["juki-mf7923d", "rimoldi-164", "ground-pin-in-slot", "slot-without-mass"])
def test_the_solver_converges_as_foreseen(name):
    model = _scene(name)
    layout = exact_layout(model)
    left = []
    for iterations in (40, 50):
        world = build_world(layout, iterations=iterations, error_bias=0.0)
        on = calls(world, add_motor(world))
        march(on, 1e-3, [-60.0], [1], None)
        (seen,) = on.collected()
        equations = layout.equations
        state, rate = (with_ground(seen[None, :, order]) / equations.metres for order in (0, 1))
        rows = equations.jacobian(equations.arms(pose_of(state)))[0]
        left.append(np.abs((rows @ equations.gather(rate)[0])[: equations.crank_row]).max())
    observed = (left[1] / left[0]) ** 0.1
    assert observed == pytest.approx(float(contraction(layout, seen[None, :, 0])[0]), rel=FORESEEN)


def test_harder_linkages_get_more_iterations():
    easy, hard = (iterations_for(_scene(n), exact_layout(_scene(n)), 0.03) for n in ("juki-mf7923d", "shaper"))
    assert 10 * easy < hard


def test_the_linkage_is_looked_at_all_the_way_round_with_closed_joints():
    model = _scene("shaper")
    layout = exact_layout(model)
    states = turned_through(model, layout)
    angles = states[:, layout.crank, 2]
    assert np.ptp(angles) == pytest.approx(2.0 * np.pi)
    assert np.max(np.diff(np.sort(angles))) < 0.2
    assert gaps(layout, states).max() < 1e-4 * layout.reach
