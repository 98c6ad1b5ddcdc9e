"""pymunk's solver converges as fast as is foreseen, and linkages that are hard for it get what they need."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.case import scene
from engines.mechanics.states import pose_of, with_ground
from engines.pymunk_adapter.adapter import TUNED, PymunkEngine, contraction, poses_of
from engines.pymunk_adapter.layout import exact_layout
from engines.scene import Channel, Prescribed
from engines.stepping.intervals import Cost
from engines.stepping.richardson import named_signals
from tests.analytic.linkages import MADE_UP, mechanism

pytest.importorskip("pymunk")
loop = pytest.importorskip("engines.pymunk_adapter.loop")

FORESEEN = 0.05  # relative error of the foreseen convergence


def _scene(name, **changes):
    return scene(mechanism(name), Prescribed(crank_motion(start_angle=0.3, **changes)), frozenset(Channel))


@pytest.mark.parametrize("name", ["fork-takeup", "slotted-takeup", "rimoldi-164"])
def test_the_solver_converges_as_foreseen(name, monkeypatch):
    layout = exact_layout(_scene(name))
    left = []
    for iterations in (60, 80):
        world = PymunkEngine().build(_scene(name), dataclasses.replace(TUNED, effort=iterations))
        monkeypatch.setattr(loop, "COLD", 1)
        (seen,), _ = loop.take_steps(world, 1e-3, np.full(2, 60.0), (np.array([1]), np.array([])), [])
        seen = seen[:-1]
        equations = layout.equations
        state, rate = (with_ground(seen[None, :, order]) / equations.metres for order in (0, 1))
        rows = equations.jacobian(equations.arms(pose_of(state)))[0]
        residual = rows @ equations.gather(rate)[0]
        left.append(np.abs(residual[: equations.crank_row]).max())
    observed = (left[1] / left[0]) ** (1.0 / 20.0)
    assert observed == pytest.approx(contraction(layout, pose_of(state)), rel=FORESEEN)


@pytest.mark.parametrize("name", [name for name in MADE_UP if name not in {"parallelogram", "near-toggle"}])
def test_the_linkage_is_looked_at_along_its_motion_with_closed_joints(name):
    for motion, driver_travel in (
        (crank_motion(clockwise=True), -2.0 * np.pi),
        (crank_motion(ramp_time=0.01, hold_time=0.01), None),
    ):
        model = scene(mechanism(name), Prescribed(motion), ())
        equations = exact_layout(model).equations
        poses = poses_of(equations)
        angles = np.array([pose.angle[0, equations.crank] for pose in poses])
        end = motion.angle(motion.duration) if driver_travel is None else driver_travel
        assert angles[[0, -1]] == pytest.approx([0.0, float(end)], abs=1e-9)
        assert np.abs(np.diff(angles)).max() < 0.1
        for pose in poses:
            opened = equations.openings(equations.residual(pose, equations.arms(pose)))
            assert np.abs(opened).max() < 1e-8


@pytest.mark.parametrize("ramp_time", [0.051, 0.051102, 0.072])  # a kink on a sample, between two, beside one
def test_passes_of_every_step_have_the_same_samples_wherever_the_motion_has_a_kink(ramp_time):
    recipe = dataclasses.replace(TUNED, step=0.102 / 500, steps_per_turn=0.0, ratios=(3, 5, 7, 9))
    given = _scene("juki-mf7923d", regime="run-up-quintic", ramp_time=ramp_time, hold_time=0.102 - ramp_time)
    engine = PymunkEngine()
    model, _, courses = engine.planned(given, recipe, Cost())
    histories = [engine.follow(engine.build(model, recipe), course) for course in courses]
    for signals in zip(*(named_signals(history) for history in histories), strict=True):
        clocks = [signal.time for _, signal in signals]
        for clock in clocks[1:]:
            np.testing.assert_allclose(clock, clocks[0], rtol=1e-9)
