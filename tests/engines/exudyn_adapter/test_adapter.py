"""exudyn against the closed form, joint by joint and load by load; what exudyn cannot do comes back as a value."""

import dataclasses
import math
import os

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND, RotaryDamper
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import joint_forces
from analytic.kinematics.mechanism import Mechanism
from comparisons.judging.deviations import near_jumps
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.exudyn_adapter import adapter, checks, recipes, stepping
from engines.exudyn_adapter.adapter import ExudynEngine
from engines.exudyn_adapter.model import Model
from engines.exudyn_adapter.readout import add_sensors
from engines.scene import Channel, Free, Prescribed
from tests.analytic.linkages import mechanism
from tests.engines.newton_euler import true_motion

exudyn = pytest.importorskip("exudyn")

ENGINE = ExudynEngine()
EVERYTHING = frozenset(Channel)
NO_FORCES = EVERYTHING - {Channel.JOINT_FORCE}

# Errors relative to the peak. The basic step is 5° of crank; made-up linkages are sharper than the needle mechanisms.
LOAD = {Setting.TUNED: 3e-5, Setting.BEST: 3e-7}  # torque, joint forces, accelerations
MOTION = {Setting.TUNED: 1e-6, Setting.BEST: 1e-9}  # positions and velocities: an integral smoother
NAIVE_ROUGHNESS = 1e-4  # a newcomer's torque is further off than this
RINGING = 1e-3  # what a kink leaves behind for ever if the run is not started anew there
LOOSE_ORDER = 0.5  # an observed order may be this much below the theoretical one
FREE_ANGLE = {Setting.TUNED: 1e-6, Setting.BEST: 2e-8}  # rad after half a second
UNREADABLE = 1e-9  # of a joint force's peak: rounding of the reading

NEEDLE = ["juki-mf7923d", "rimoldi-164"]
GRAVITY_ONLY = [
    "carried-slider",  # a slider that rides on a turning link
    "moving-guides",  # slots and sliders on links of every kind
    "ground-pin-in-slot",
    "scotch-yoke",  # a slot in a body that does not turn
    "shaper",  # pin masses merged into their slots
    "three-on-one-pin",
]


def _obstacle(model):
    """Why a scene is not run."""
    run = ENGINE.run(model, Setting.TUNED)
    return run.reason if run.outcome is Outcome.UNSUPPORTED else None


def _motion(regime="run-up-quintic", **changes):
    return crank_motion(regime, **{"ramp_time": 0.15, "hold_time": 0.03, "start_angle": 0.3, **changes})


def _run(name, motion, setting=Setting.TUNED, channels=NO_FORCES):
    model = scene(mechanism(name), Prescribed(motion), channels)
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    return model, run


def _true_torque(name, motion, time):
    return reduced.drive_torque(
        mechanism(name).sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time)
    )


def _error(signal, truth, motion):
    """Largest error over the truth's peak, component by component, away from acceleration jumps."""
    kept = ~near_jumps(signal.time, motion.jumps)
    difference, size = np.abs(signal.values - truth)[kept], np.abs(truth)
    axes = tuple(range(truth.ndim - 1)) if truth.ndim > 1 else 0
    return float(np.max(difference.max(axes) / np.maximum(size.max(axes), np.finfo(float).tiny)))


def _torque_error(name, motion, run):
    return _error(run.history.torque, _true_torque(name, motion, run.history.torque.time), motion)


@pytest.mark.parametrize("regime", ["run-up", "run-up-cubic", "run-up-quintic", "constant-speed"])
@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
@pytest.mark.parametrize("name", NEEDLE)
def test_motion_and_torque_follow_the_closed_form(name, setting, regime):
    motion = _motion(regime, ramp_time=0.2, clockwise=regime == "run-up-cubic")
    _, run = _run(name, motion, setting)
    history = run.history
    position, velocity, acceleration = true_motion(mechanism(name), motion, history.position.time)
    assert _error(history.position, position, motion) < MOTION[setting]
    assert _error(history.velocity, velocity, motion) < MOTION[setting]
    assert _error(history.acceleration, acceleration, motion) < LOAD[setting]
    assert _torque_error(name, motion, run) < LOAD[setting]


@pytest.mark.parametrize("name", [*NEEDLE, *GRAVITY_ONLY])
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
    assert _error(run.history.torque, torque, motion) < LOAD[Setting.TUNED]
    largest = max(np.abs(force).max() for force in truth.values())
    for joint, force in truth.items():
        if np.abs(force).max() > UNREADABLE * largest:
            peak = np.linalg.norm(force, axis=1).max()
            kept = ~near_jumps(time, motion.jumps)
            assert np.abs(forces[joint].values - force)[kept].max() < LOAD[Setting.TUNED] * peak, joint


@pytest.mark.parametrize("name", ["force-over-angle", "spring-and-damper"])
@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
def test_every_kind_of_load_reaches_the_crank(name, setting):
    motion = _motion("run-up")
    assert _torque_error(name, motion, _run(name, motion, setting)[1]) < LOAD[setting]


def test_a_damper_between_two_turning_links():
    linkage = mechanism("rimoldi-164").linkage
    damped = Mechanism(dataclasses.replace(linkage, dampers=(RotaryDamper(("rocker", "rod"), 1e-3),)))
    motion = _motion()
    run = ENGINE.run(scene(damped, Prescribed(motion), NO_FORCES), Setting.TUNED)
    time = run.history.torque.time
    truth = reduced.drive_torque(damped.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time))
    assert np.abs(truth - _true_torque("rimoldi-164", motion, time)).max() > LOAD[Setting.TUNED] * np.abs(truth).max()
    assert _error(run.history.torque, truth, motion) < LOAD[Setting.TUNED]


def test_a_naive_run_finishes_and_is_as_rough_as_a_newcomers():
    motion = _motion()
    _, run = _run("juki-mf7923d", motion, Setting.NAIVE, EVERYTHING)
    error = _torque_error("juki-mf7923d", motion, run)
    assert NAIVE_ROUGHNESS < error < 100.0 * NAIVE_ROUGHNESS
    assert run.steps == round(motion.duration / run.details["step"])


@pytest.mark.parametrize(("divisions", "order"), [((1,), 2), ((1, 3), 4), ((1, 3, 5), 6)])
def test_order_of_convergence(monkeypatch, divisions, order):
    motion, errors = _motion(), []
    for steps in (30, 60):
        rule, levels = recipes.TRAPEZOIDAL, len(divisions)
        recipe = recipes.Recipe(
            rule=rule, divisions=divisions, tolerance=1e-13, steps_per_turn=steps, levels=levels, turns=1.0
        )
        monkeypatch.setattr(adapter, "setting_recipe", lambda _scene, _setting, recipe=recipe: recipe)
        errors.append(_torque_error("rimoldi-164", motion, _run("rimoldi-164", motion)[1]))
    assert math.log2(errors[0] / errors[1]) > order - LOOSE_ORDER


def test_without_consistent_accelerations_the_torque_rings(monkeypatch):
    motion = _motion("run-up", hold_time=0.06)
    good = _torque_error("juki-mf7923d", motion, _run("juki-mf7923d", motion)[1])
    whole = stepping.projected_state

    def without(*given, **how):
        return dataclasses.replace(whole(*given, **how), acceleration=np.zeros(8))

    monkeypatch.setattr(stepping, "projected_state", without)
    bad = _torque_error("juki-mf7923d", motion, _run("juki-mf7923d", motion)[1])
    assert good < LOAD[Setting.TUNED]
    assert bad > RINGING


def test_samples_at_a_jump():
    motion = _motion("run-up")
    _, run = _run("juki-mf7923d", motion)
    kink = motion.segments[0].end
    acceleration, torque = run.history.acceleration, run.history.torque
    (number,) = np.flatnonzero(np.isclose(acceleration.time, kink))
    truth = true_motion(mechanism("juki-mf7923d"), motion, acceleration.time[[number]])[2]
    assert acceleration.values[[number]] == pytest.approx(truth, rel=LOAD[Setting.TUNED], abs=RINGING)
    assert not np.isclose(torque.time, kink).any()  # it has two values there
    assert torque.time[0] > 0.0  # the multipliers belong to steps
    assert np.all(np.diff(torque.time) > 0.0)


def test_a_sharp_linkage_gets_more_passes_than_a_smooth_one():
    motion = _motion(ramp_time=0.3)
    _, smooth = _run("centric-slider-crank", motion)
    _, sharp = _run("double-crank", motion)
    assert smooth.details["divisions"] == "1 3"
    assert sharp.details["divisions"].startswith("1 3 5")
    assert _torque_error("double-crank", motion, sharp) < LOAD[Setting.TUNED]


# -- a free crank ------------------------------------------------------------------------------------------------------


def _free(name, torque, duration, start_angle):
    free = Free(torque, duration)
    return scene(mechanism(name), free, NO_FORCES, start_angle=start_angle)


def _true_angle(name, torque, duration, start_angle):
    closed = mechanism(name)

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
    run = ENGINE.run(_free(name, torque, duration, 0.4), setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    truth = _true_angle(name, torque, duration, 0.4)
    assert abs(truth[0] - 0.4) > 0.1  # it does move
    crank = [body.name for body in _free(name, torque, duration, 0.4).bodies].index(mechanism(name).linkage.crank)
    scale = max(1.0, abs(truth[0]))
    assert run.history.position.values[-1, crank, 2] == pytest.approx(truth[0], abs=scale * FREE_ANGLE[setting])
    assert run.history.torque.values == pytest.approx(torque)


# -- nothing that is not asked for -------------------------------------------------------------------------------------


def test_no_sensor_for_a_channel_nobody_reads():
    motion = _motion()
    bare = scene(mechanism("juki-mf7923d"), Prescribed(motion), ())
    assert add_sensors(Model(bare)).sensors == ()
    torque = dataclasses.replace(bare, channels=frozenset({Channel.TORQUE}))
    assert len(add_sensors(Model(torque)).sensors) == 1
    run = ENGINE.run(torque, Setting.TUNED)
    assert run.history.position is run.history.velocity is run.history.acceleration is None
    assert run.history.joint_force == {}
    assert ENGINE.run(bare, Setting.TUNED).outcome is Outcome.FINISHED


def test_a_body_that_cannot_turn_has_no_angle_and_no_weight_without_gravity():
    model = Model(scene(mechanism("juki-mf7923d"), Prescribed(_motion()), ()))
    assert model.turning == {"crank", "coupler"}
    model.mbs.Assemble()
    assert model.mbs.systemData.ODE2Size() == 8
    assert model.mbs.systemData.NumberOfLoads() == 3
    light = dataclasses.replace(model.scene, gravity=(0.0, 0.0))
    assert Model(light).mbs.systemData.NumberOfLoads() == 0


def test_nothing_is_printed_and_no_file_is_left(capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = exudyn.config.printToConsole
    for setting in Setting:
        _run("juki-mf7923d", _motion(), setting, EVERYTHING)
    ENGINE.run(scene(mechanism("parallelogram"), Prescribed(_motion()), NO_FORCES), Setting.TUNED)
    assert capfd.readouterr() == ("", "")
    assert os.listdir(tmp_path) == []
    assert exudyn.config.printToConsole == before


# -- what cannot be done is a value ------------------------------------------------------------------------------------


def _changed_body(model, name, **changes):
    bodies = tuple(dataclasses.replace(b, **changes) if b.name == name else b for b in model.bodies)
    return dataclasses.replace(model, bodies=bodies)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"position": (0.001, 0.02)}, "in position"),
        ({"velocity": (0.1, 0.0)}, "in velocity"),
        ({"acceleration": (0.0, 1e5)}, "in acceleration"),
        ({"mass": math.nan}, "mass nan"),
        ({"inertia": -1e-5}, "inertia -1e-05"),
    ],
)
def test_a_start_that_does_not_fit_is_refused(changes, words):
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion("constant-speed")), NO_FORCES)
    model = _changed_body(model, "coupler", **changes)
    run = ENGINE.run(model, Setting.TUNED)
    assert run.outcome is Outcome.UNSUPPORTED
    assert words in run.reason


def test_a_crank_that_is_not_where_its_drive_has_it_is_refused():
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES)
    elsewhere = dataclasses.replace(model, drive=Prescribed(_motion(start_angle=1.0)))
    assert "the crank starts" in (_obstacle(elsewhere) or "")


def test_a_joint_said_twice_is_refused():
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES)
    assert _obstacle(model) is None
    twice = dataclasses.replace(model, pins=(*model.pins, dataclasses.replace(model.pins[0], name="again")))
    assert "repeat 2" in (_obstacle(twice) or "")
    assert ENGINE.run(twice, Setting.TUNED).outcome is Outcome.UNSUPPORTED


def test_a_joint_left_out_is_refused():
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES)
    loose = dataclasses.replace(model, pins=tuple(pin for pin in model.pins if GROUND in (pin.first, pin.second)))
    assert "degrees of freedom" in (_obstacle(loose) or "")


@pytest.mark.parametrize(
    ("regime", "words"), [("run-up-quintic", "exudyn stopped at"), ("run-up", "passed a dead or change point")]
)
def test_a_change_point_ends_as_diverged_with_a_reason(regime, words):
    run = ENGINE.run(scene(mechanism("parallelogram"), Prescribed(_motion(regime)), NO_FORCES), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert words in run.reason
    assert run.history is None
    assert run.steps > 0


def test_a_linkage_that_came_apart_is_not_passed_off_as_finished(monkeypatch):
    monkeypatch.setattr(checks, "LARGEST_GAP", 0.0)
    run = ENGINE.run(scene(mechanism("juki-mf7923d"), Prescribed(_motion()), NO_FORCES), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "is open by" in run.reason
