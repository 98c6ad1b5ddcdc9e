"""pymunk against the closed form, joint by joint and load by load; what pymunk cannot do comes back as a value."""

import dataclasses
import math
import os

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.description.linkage import GROUND, RotaryDamper, Spring
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import joint_forces
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.pymunk_adapter import adapter, checks, passes, plans, stepping
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.pymunk_adapter.layout import exact_layout, plain_layout
from engines.pymunk_adapter.plans import Aim, Plan
from engines.scene import AppliedForce, AppliedTorque, Channel, Free, Prescribed
from tests.analytic.linkages import mechanism
from tests.engines.newton_euler import true_motion

pytest.importorskip("pymunk")

ENGINE = PymunkEngine()
EVERYTHING = frozenset(Channel)
NO_FORCES = EVERYTHING - {Channel.JOINT_FORCE}

# Errors relative to the peak. Samples are 2.4° of crank apart; made-up linkages are sharper than the needle mechanisms.
LOAD = {Setting.TUNED: 5e-6, Setting.BEST: 3e-7}  # torque, joint forces, accelerations
MOTION = {Setting.TUNED: 2e-7, Setting.BEST: 1e-9}  # positions and velocities: an integral smoother
NAIVE_ROUGHNESS = 1e-2  # a newcomer's accelerations are further off than this
WRONG_GROOVE = 2e-4  # what a groove off the mass centre's line does to velocities, extrapolated or not
LOOSE_ORDER = 0.3  # an observed order may be this much below the theoretical one
FREE_ANGLE = {Setting.TUNED: 1e-6, Setting.BEST: 2e-8}  # rad after half a second
UNREADABLE = 1e-9  # of the largest joint force: rounding of the reading

NEEDLE = ["juki-mf7923d", "rimoldi-164"]
SLIDING = [
    "moving-guides",  # slots and sliders on links of every kind, two of them on one link
    "ground-pin-in-slot",
    "scotch-yoke",  # a slot in a body that does not turn
    "slot-without-mass",
    "three-on-one-pin",
]


def _obstacle(model):
    """Why a scene is not run."""
    run = ENGINE.run(model, Setting.TUNED)
    return run.reason if run.outcome is Outcome.UNSUPPORTED else None


def _motion(regime="run-up-quintic", **changes):
    return crank_motion(regime, **{"ramp_time": 0.12, "hold_time": 0.03, "start_angle": 0.3, **changes})


def _run(name, motion, setting=Setting.TUNED, channels=NO_FORCES):
    model = scene(mechanism(name), Prescribed(motion), channels)
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    return model, run


def _error(signal, truth):
    """Largest error over the truth's peak, component by component, acceleration jumps included."""
    difference, size = np.abs(signal.values - truth), np.abs(truth)
    axes = tuple(range(truth.ndim - 1)) if truth.ndim > 1 else 0
    floor = 1e-3 * size.max()
    return float(np.max(difference.max(axes) / np.maximum(size.max(axes), floor)))


def _true_torque(closed, motion, time):
    return reduced.drive_torque(closed.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time))


def _torque_error(name, motion, run):
    return _error(run.history.torque, _true_torque(mechanism(name), motion, run.history.torque.time))


@pytest.mark.parametrize("regime", ["run-up", "run-up-cubic", "run-up-quintic", "constant-speed"])
@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
@pytest.mark.parametrize("name", NEEDLE)
def test_motion_and_torque_follow_the_closed_form_at_every_sample(name, setting, regime):
    motion = _motion(regime, clockwise=regime == "run-up-cubic")
    _, run = _run(name, motion, setting)
    history = run.history
    for channel, order, limit in (("position", 0, MOTION), ("velocity", 1, MOTION), ("acceleration", 2, LOAD)):
        signal = getattr(history, channel)
        truth = true_motion(mechanism(name), motion, signal.time)[order]
        assert _error(signal, truth) < limit[setting], channel
    assert _torque_error(name, motion, run) < LOAD[setting]


@pytest.mark.parametrize("name", [*NEEDLE, *SLIDING])
def test_joint_forces_are_those_of_the_analysis_of_the_assur_groups(name):
    motion = _motion("run-up")
    model, run = _run(name, motion, channels=EVERYTHING)
    forces = run.history.joint_force
    assert set(forces) == {joint.name for joint in (*model.pins, *model.sliders, *model.slots)}
    time = run.history.torque.time
    sweep, speed, acceleration = (
        mechanism(name).sweep(motion.angle(time)),
        motion.speed(time),
        motion.acceleration(time),
    )
    truth = {joint: force.T for joint, force in joint_forces(sweep, speed, acceleration).items()}
    torque = reduced.drive_torque(sweep, speed, acceleration)
    assert _error(run.history.torque, torque) < LOAD[Setting.TUNED]
    largest = max(np.abs(force).max() for force in truth.values())
    for joint, force in truth.items():
        if np.abs(force).max() > UNREADABLE * largest:
            peak = np.linalg.norm(force, axis=1).max()
            assert np.abs(forces[joint].values - force).max() < LOAD[Setting.TUNED] * peak, joint


@pytest.mark.parametrize("name", SLIDING)
def test_bodies_are_reported_as_themselves_however_they_are_cut(name):
    motion = _motion()
    model, run = _run(name, motion)
    for channel, order in (("position", 0), ("velocity", 1), ("acceleration", 2)):
        signal = getattr(run.history, channel)
        truth = true_motion(mechanism(name), motion, signal.time)[order]
        turning = [body.inertia is not None for body in model.bodies]
        assert (
            _error(dataclasses.replace(signal, values=signal.values[:, :, :2]), truth[:, :, :2]) < LOAD[Setting.TUNED]
        )
        kept = dataclasses.replace(signal, values=signal.values[:, turning, 2])
        assert _error(kept, truth[:, turning, 2]) < LOAD[Setting.TUNED]


def test_a_groove_that_is_not_cut_free_gives_a_wrong_velocity(monkeypatch):
    motion = _motion()

    def worst():
        _, run = _run("ground-pin-in-slot", motion)
        signal = run.history.velocity
        return _error(signal, true_motion(mechanism("ground-pin-in-slot"), motion, signal.time)[1])

    assert worst() < MOTION[Setting.TUNED] * 10.0
    monkeypatch.setattr(adapter, "exact_layout", plain_layout)
    monkeypatch.setattr(passes, "LARGEST_DISAGREEMENT", math.inf)
    assert worst() > WRONG_GROOVE


# -- loads -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["force-over-angle", "spring-and-damper"])
@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
def test_every_kind_of_load_reaches_the_crank(name, setting):
    motion = _motion("run-up")
    assert _torque_error(name, motion, _run(name, motion, setting)[1]) < LOAD[setting]


@pytest.mark.parametrize(
    "load",
    [
        {"dampers": (RotaryDamper(("rocker", "rod"), 1e-3),)},
        {"springs": (Spring(("A", "O2"), ("rod", GROUND), 0.0, 0.0, 2.0),)},  # a dashpot alone
        {"springs": (Spring(("B", "D"), ("rod", "link"), 300.0, 0.02, 2.0),)},
    ],
)
def test_dampers_and_dashpots_between_links(load):
    closed = Mechanism(dataclasses.replace(mechanism("rimoldi-164").linkage, **load))
    motion = _motion("run-up")
    run = ENGINE.run(scene(closed, Prescribed(motion), NO_FORCES), Setting.TUNED)
    time = run.history.torque.time
    truth = _true_torque(closed, motion, time)
    bare = _true_torque(mechanism("rimoldi-164"), motion, time)
    assert np.abs(truth - bare).max() > 100.0 * LOAD[Setting.TUNED] * np.abs(truth).max()
    assert _error(run.history.torque, truth) < LOAD[Setting.TUNED]


def test_constant_loads_cost_no_python_in_a_step():
    model = scene(mechanism("rimoldi-164"), Prescribed(_motion()), NO_FORCES)
    force = AppliedForce("rod", (0.01, 0.0), Law(np.array([1.0, -2.0])))
    torque = AppliedTorque("link", Law(np.array([0.01])))
    loaded = dataclasses.replace(model, forces=(force,), torques=(torque,))
    world = passes.build_world(exact_layout(loaded), iterations=10, error_bias=0.0)
    assert not passes.StepLoads(world, 1e-4, ahead=True)


# -- the stepping ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("ratios", "order"), [((1, 3), 3), ((1, 3, 5), 4), ((1, 3, 5, 7), 5)])
def test_order_of_convergence(monkeypatch, ratios, order):
    motion, errors = _motion(), []
    for samples in (40, 80):
        plan = Plan(ratios, Aim(samples, 10, disagreement=math.inf), 1e-4)
        monkeypatch.setattr(plans, "PRESCRIBED", {Setting.TUNED: plan})
        errors.append(_torque_error("rimoldi-164", motion, _run("rimoldi-164", motion)[1]))
    assert math.log2(errors[0] / errors[1]) > order - LOOSE_ORDER


def test_a_sharp_linkage_gets_more_passes_than_a_smooth_one(monkeypatch):
    plan = Plan((1, 3, 5), Aim(40, 50, disagreement=1e-4), 0.03)
    monkeypatch.setattr(plans, "PRESCRIBED", {Setting.TUNED: plan})
    _, smooth = _run("centric-slider-crank", _motion())
    _, sharp = _run("double-crank", _motion())
    assert smooth.details["ratios"] == "1 3 5"
    assert sharp.details["ratios"].startswith("1 3 5 7")


def test_samples_at_a_jump_are_those_just_after_it():
    motion = _motion("run-up")
    _, run = _run("juki-mf7923d", motion)
    torque = run.history.torque
    for jump in motion.jumps:
        (number,) = np.flatnonzero(np.isclose(torque.time, jump, atol=1e-9))
        truth = _true_torque(mechanism("juki-mf7923d"), motion, np.array([jump]))
        before = _true_torque(mechanism("juki-mf7923d"), motion, np.array([jump - 1e-9]))
        assert abs(truth - before) > 1e-3 or jump == 0.0
        assert torque.values[number] == pytest.approx(truth[0], abs=LOAD[Setting.TUNED] * np.abs(torque.values).max())


def test_the_c_functions_do_what_the_methods_do(monkeypatch):
    motion = _motion(ramp_time=0.02, hold_time=0.01)
    _, direct = _run("rimoldi-164", motion, channels=EVERYTHING)
    monkeypatch.setattr(passes, "calls", stepping.public_calls)
    _, public = _run("rimoldi-164", motion, channels=EVERYTHING)
    for channel in ("position", "velocity", "acceleration", "torque"):
        one, other = getattr(direct.history, channel), getattr(public.history, channel)
        assert np.array_equal(one.values, other.values), channel


def test_an_unknown_pymunk_is_stepped_by_its_methods(monkeypatch):
    monkeypatch.delattr("pymunk.batch.Buffer")
    assert _torque_error("juki-mf7923d", _motion(), _run("juki-mf7923d", _motion())[1]) < LOAD[Setting.TUNED]


def test_a_naive_run_finishes_and_is_as_rough_as_a_newcomers():
    motion = _motion()
    _, run = _run("juki-mf7923d", motion, Setting.NAIVE, EVERYTHING)
    signal = run.history.acceleration
    assert _error(signal, true_motion(mechanism("juki-mf7923d"), motion, signal.time)[2]) > NAIVE_ROUGHNESS
    assert run.steps == round(motion.duration / run.details["step"])
    assert np.all(run.history.torque.values >= 0.0)  # pymunk tells its size alone


# -- a free crank ------------------------------------------------------------------------------------------------------


def _true_end(closed, torque, duration, start_angle):
    def rate(_time, state):
        sweep = closed.sweep(np.asarray(state[0]))
        moment = torque + reduced.generalised_force(sweep) - reduced.damping_coefficient(sweep) * state[1]
        moment -= reduced.half_inertia_derivative(sweep) * state[1] ** 2
        return [state[1], float(moment / reduced.reduced_inertia(sweep))]

    return solve_ivp(rate, (0.0, duration), [start_angle, 0.0], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
@pytest.mark.parametrize(
    ("name", "torque", "duration"),
    [("juki-mf7923d", 0.01, 0.4), ("spring-and-damper", 0.0, 0.1), ("force-over-angle", 0.5, 0.04)],
)
def test_a_free_crank_moves_as_the_equation_of_motion_says(name, torque, duration, setting):
    closed = mechanism(name)
    model = scene(closed, Free(torque, duration), EVERYTHING, start_angle=0.4)
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    truth = _true_end(closed, torque, duration, 0.4)
    assert abs(truth[0] - 0.4) > 0.1  # it does move
    crank = [body.name for body in model.bodies].index(closed.linkage.crank)
    history = run.history
    scale = max(1.0, abs(truth[0]))
    assert history.position.values[-1, crank, 2] == pytest.approx(truth[0], abs=scale * FREE_ANGLE[setting])
    assert history.torque.values == pytest.approx(torque)
    start = np.array([(*b.acceleration, b.angular_acceleration if b.inertia else 0.0) for b in model.bodies])
    assert np.abs(history.acceleration.values[0] - start).max() < 1e-6 * np.abs(start).max()


def test_a_crank_that_gets_fast_is_followed_at_smaller_steps():
    model = scene(mechanism("double-crank"), Free(0.5, 0.5), frozenset({Channel.TORQUE}), start_angle=0.4)
    slow = dataclasses.replace(model, drive=Free(0.001, 0.5))
    fast_step, slow_step = (ENGINE.run(one, Setting.TUNED).details["sample_step"] for one in (model, slow))
    assert fast_step < 0.5 * slow_step


# -- nothing that is not asked for -------------------------------------------------------------------------------------


def test_only_the_channels_asked_for_come_back():
    for wanted in (frozenset({Channel.TORQUE}), frozenset({Channel.VELOCITY}), frozenset()):
        _, run = _run("juki-mf7923d", _motion(), channels=wanted)
        for channel in Channel:
            assert bool(getattr(run.history, channel.value)) == (channel in wanted)


def test_gravity_is_set_and_bodies_turn_only_where_they_do():
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES)
    light = dataclasses.replace(model, gravity=(0.0, 0.0))
    world = passes.build_world(exact_layout(light), iterations=10, error_bias=0.0)
    assert tuple(world.space.gravity) == (0.0, 0.0)
    straight = [body.name for body, real in zip(model.bodies, world.bodies, strict=True) if math.isinf(real.moment)]
    assert straight == ["needle_bar"]
    assert len(world.space.shapes) == 0
    assert len(world.bodies) == len(model.bodies)


def test_nothing_is_printed_and_no_file_is_left(capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for setting in Setting:
        _run("juki-mf7923d", _motion(), setting, EVERYTHING)
    assert capfd.readouterr() == ("", "")
    assert os.listdir(tmp_path) == []


# -- what cannot be done is a value ------------------------------------------------------------------------------------


def _changed(model, name, **changes):
    bodies = tuple(dataclasses.replace(b, **changes) if b.name == name else b for b in model.bodies)
    return dataclasses.replace(model, bodies=bodies)


@pytest.mark.parametrize(
    ("name", "changes", "words"),
    [
        ("coupler", {"mass": 0.0}, "mass 0"),  # each of these ends the process if pymunk gets it
        ("coupler", {"mass": -1.0}, "mass -1"),
        ("coupler", {"mass": math.nan}, "mass nan"),
        ("coupler", {"mass": math.inf}, "mass inf"),
        ("coupler", {"inertia": 0.0}, "inertia 0"),
        ("coupler", {"inertia": math.nan}, "inertia nan"),
        ("crank", {"inertia": None}, "no inertia"),
        ("coupler", {"position": (math.nan, 0.0)}, "not finite"),  # and each of these runs on as nonsense
        ("coupler", {"position": (0.001, 0.02)}, "in position"),
        ("coupler", {"velocity": (0.1, 0.0)}, "in velocity"),
    ],
)
def test_bodies_that_pymunk_must_not_get(name, changes, words):
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion("constant-speed")), NO_FORCES)
    model = _changed(model, name, **changes)
    for setting in Setting:
        run = ENGINE.run(model, setting)
        assert run.outcome is Outcome.UNSUPPORTED
        assert words in run.reason


def test_joints_and_loads_that_pymunk_must_not_get():
    model = scene(mechanism("rimoldi-164"), Prescribed(_motion()), NO_FORCES)
    assert _obstacle(model) is None
    loose = dataclasses.replace(model, pins=tuple(pin for pin in model.pins if GROUND in (pin.first, pin.second)))
    assert "degrees of freedom" in (_obstacle(loose) or "")
    stray = dataclasses.replace(model.pins[0], first="nobody")
    assert "'nobody'" in (_obstacle(dataclasses.replace(model, pins=(stray, *model.pins[1:]))) or "")
    heavy = dataclasses.replace(model, gravity=(0.0, math.nan))
    assert "gravity" in (_obstacle(heavy) or "")
    pull = AppliedForce("rod", (0.0, 0.0), Law(np.array([math.inf, 0.0])))
    assert "force on 'rod'" in (_obstacle(dataclasses.replace(model, forces=(pull,))) or "")
    endless = dataclasses.replace(model, drive=Free(0.0, math.inf))
    assert "free drive" in (_obstacle(endless) or "")


@pytest.mark.parametrize("name", ["parallelogram", "near-toggle"])
def test_an_angle_at_which_the_solver_gets_nowhere_is_named(name):
    run = ENGINE.run(scene(mechanism(name), Prescribed(_motion()), NO_FORCES), Setting.TUNED)
    assert run.outcome is Outcome.UNSUPPORTED
    assert "does not converge at a crank angle of" in run.reason


def test_the_same_linkage_away_from_that_angle_is_run():
    motion = _motion(speed=10.0)
    assert _torque_error("parallelogram", motion, _run("parallelogram", motion)[1]) < LOAD[Setting.TUNED]


def test_a_linkage_that_came_apart_is_not_passed_off_as_finished(monkeypatch):
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES)
    monkeypatch.setattr(passes, "check_joints", lambda *a: checks.check_joints(*a, share=1e-9))
    run = ENGINE.run(model, Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "is open by" in run.reason
    assert run.history is None


def test_a_crank_that_does_not_follow_is_not_passed_off_as_finished(monkeypatch):
    monkeypatch.setattr(passes, "mean_speeds", lambda segment, start, step, count: np.zeros(count))
    run = ENGINE.run(scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "rad from its motion" in run.reason


def test_passes_that_do_not_agree_are_not_passed_off_as_finished(monkeypatch):
    monkeypatch.setattr(passes, "LARGEST_DISAGREEMENT", 1e-12)
    run = ENGINE.run(scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "do not agree" in run.reason
