"""What pymunk alone has: bodies cut into parts, magnitudes of forces, impulses as read-outs, grooves that are wrong."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import scene
from engines.contract import Setting
from engines.mechanics.states import pose_of, with_ground
from engines.pymunk_adapter import adapter
from engines.pymunk_adapter.adapter import PymunkEngine, contraction, poses_of
from engines.pymunk_adapter.layout import exact_layout, plain_layout
from engines.scene import Channel, Prescribed
from engines.stepping.intervals import Cost
from engines.stepping.own_units import own_units
from engines.stepping.richardson import named_signals
from tests.analytic.linkages import MADE_UP, from_text, mechanism
from tests.engines.closed_form import driven, errors_of, history_of, run_of

pytest.importorskip("pymunk")
loop = pytest.importorskip("engines.pymunk_adapter.loop")

ENGINE = PymunkEngine()
TUNED = 5e-5  # of the peak: torque, joint forces and accelerations
WRONG_GROOVE = 1e-4  # what a groove off the mass centre's line does to velocities at any step
SEEN = 1e-2  # of a joint force: what a world of another crank or without a load is off by

LIGHT = """
title   = "four-bar of links that are all mass and no inertia"
source  = "made up for the tests"
units   = { length = "mm", mass = "kg", inertia = "kg*mm^2", angle = "deg" }
crank   = "crank"
gravity = [0, -9.81]
ground  = { O = [0, 0], Q = [90, 0] }
[links.crank]
points  = { O = [0, 0], A = [30, 0] }
mass    = 1.0
centre  = [15, 0]
inertia = 1.8
[links.coupler]
points  = { A = [0, 0], B = [80, 0] }
mass    = 0.1
centre  = [30, 10]
inertia = 1.3
[links.rocker]
points  = { Q = [0, 0], B = [70, 0] }
mass    = 2.0
centre  = [35, 0]
inertia = 20
[sketch]
points = { B = [70, 67] }
"""


def _motion(regime="run-up-quintic", **changes):
    return crank_motion(regime, **{"ramp_time": 0.06, "hold_time": 0.02, "start_angle": 0.3, **changes})


def _errors(linkage, motion, setting=Setting.TUNED, engine=ENGINE):
    return errors_of(run_of(engine, linkage, motion, setting), linkage, motion)


def test_masses_with_small_inertias_are_no_trouble():
    assert max(_errors(from_text(LIGHT), _motion()).values()) < 10.0 * TUNED


def test_the_torque_is_the_motors_impulse_less_what_keeps_its_sign_and_nothing_else(monkeypatch):
    """A term of the adapter's own that grows with the motion would not be the engine's word."""
    seen, stepped = [], loop.take_steps
    monkeypatch.setattr(loop, "take_steps", lambda *given: seen.append((given, stepped(*given))) or seen[-1][1])
    model = driven(mechanism("juki-mf7923d"), _motion(), channels=frozenset({Channel.TORQUE}))
    torque = history_of(ENGINE, model).torque
    (((world, step, *_), (_, impulses)),) = seen
    expected = (world.given["offset"] - impulses[:, 0] / step) * own_units(model).unit("torque")
    assert torque.values == pytest.approx(expected, rel=1e-12, abs=1e-15)


class _Another(PymunkEngine):
    """pymunk in a world of which the adapter knows nothing."""

    def altered(self, scene):
        bodies = tuple(dataclasses.replace(b, mass=2.0 * b.mass) if b.name == "crank" else b for b in scene.bodies)
        return dataclasses.replace(scene, bodies=bodies if not scene.forces else scene.bodies, forces=())


def test_a_crank_of_twice_its_mass_and_a_side_load_that_is_missing_are_seen_in_the_joint_forces():
    """Neither moves anything, nor takes a torque."""
    drawn, motion = mechanism("juki-mf7923d").linkage, _motion()
    balanced = dataclasses.replace(drawn.links["crank"], centre=(0.0, 0.0))
    plain = dataclasses.replace(drawn, links={**drawn.links, "crank": balanced})
    loaded = mechanism("force-over-angle").linkage.forces[0]
    load = dataclasses.replace(loaded, link="needle_bar", point="D", force=Law(np.array([20.0, 0.0])))
    for linkage, joint in ((plain, "O1"), (dataclasses.replace(plain, forces=(load,)), "needle_bar on ground")):
        closed = Mechanism(linkage)
        right, wrong = (_errors(closed, motion, engine=engine) for engine in (ENGINE, _Another()))
        assert max(right.values()) < TUNED
        assert wrong["torque"] < TUNED
        assert wrong[joint] > SEEN


def test_a_groove_that_is_not_cut_free_gives_a_wrong_velocity(monkeypatch):
    monkeypatch.setattr(adapter, "exact_layout", plain_layout)
    assert _errors(mechanism("ground-pin-in-slot"), _motion())["velocity"] > WRONG_GROOVE


def test_a_naive_run_has_pymunks_defaults_and_the_torques_size_alone():
    model = driven(mechanism("juki-mf7923d"), _motion(hold_time=0.01))
    run = ENGINE.run(model, Setting.NAIVE)
    assert (run.steps, run.details["iterations"]) == (700, 10)
    assert len(run.history.acceleration.time) == run.steps
    assert np.all(run.history.torque.values >= 0.0)


def test_no_buffer_is_made_for_a_run(monkeypatch):
    """For pymunk never frees one."""
    monkeypatch.delattr("pymunk.batch.Buffer")
    assert run_of(ENGINE, mechanism("juki-mf7923d"), _motion(ramp_time=0.01), Setting.BEST).torque is not None


def test_a_linkage_with_a_change_point_is_run_away_from_it():
    motion = _motion(speed=10.0)
    history = run_of(ENGINE, mechanism("parallelogram"), motion, Setting.TUNED)
    errors = errors_of(history, mechanism("parallelogram"), motion)
    assert max(errors[name] for name in ("torque", "position", "velocity", "acceleration")) < TUNED


pytest.importorskip("pymunk")

FORESEEN = 0.05  # relative error of the foreseen convergence


def _scene(name, **changes):
    return scene(mechanism(name), Prescribed(crank_motion(start_angle=0.3, **changes)), frozenset(Channel))


@pytest.mark.parametrize("name", ["fork-takeup", "slotted-takeup", "rimoldi-164"])
def test_the_solver_converges_as_foreseen(name, monkeypatch):
    layout = exact_layout(_scene(name))
    left = []
    for iterations in (60, 80):
        world = PymunkEngine().build(_scene(name), dataclasses.replace(adapter.TUNED, effort=iterations))
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
    recipe = dataclasses.replace(adapter.TUNED, step=0.102 / 500, steps_per_turn=0.0, ratios=(3, 5, 7, 9))
    given = _scene("juki-mf7923d", regime="run-up-quintic", ramp_time=ramp_time, hold_time=0.102 - ramp_time)
    engine = PymunkEngine()
    model, _, courses = engine.planned(given, recipe, Cost())
    histories = [engine.follow(engine.build(model, recipe), course) for course in courses]
    for signals in zip(*(named_signals(history) for history in histories), strict=True):
        clocks = [signal.time for _, signal in signals]
        for clock in clocks[1:]:
            np.testing.assert_allclose(clock, clocks[0], rtol=1e-9)
