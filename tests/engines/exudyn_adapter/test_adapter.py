"""exudyn against the closed form, joint by joint and load by load; what exudyn cannot do comes back as a value."""

import dataclasses
import os

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND, RotaryDamper
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import joint_forces
from analytic.kinematics.mechanism import Mechanism
from comparisons.judging.jumps import near_jumps
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.start_state import scene
from engines.contract import Origin, Outcome, Setting
from engines.exudyn_adapter.adapter import ExudynEngine
from engines.exudyn_adapter.model import Model
from engines.exudyn_adapter.recipes import TUNED
from engines.mechanics.joints import scene_size
from engines.scene import Channel, Free, Prescribed
from engines.stepping.histories import labelled
from tests.analytic.linkages import mechanism
from tests.engines.newton_euler import true_motion

exudyn = pytest.importorskip("exudyn")

ENGINE = ExudynEngine()
EVERYTHING = frozenset(Channel)
NO_FORCES = EVERYTHING - {Channel.JOINT_FORCE}

# Errors relative to the peak; made-up linkages are sharper than the needle mechanisms.
LOAD = {Setting.TUNED: 1e-4, Setting.BEST: 5e-7}  # torque, joint forces, accelerations
MOTION = {Setting.TUNED: 3e-6, Setting.BEST: 1e-9}  # positions and velocities: an integral smoother
ORIGIN = {Setting.TUNED: Origin.READ, Setting.BEST: Origin.EXTRAPOLATED}
NAIVE_ROUGHNESS = 1e-4  # a newcomer's torque is further off than this
FREE_ANGLE = {Setting.TUNED: 1e-5, Setting.BEST: 2e-8}  # rad after half a second
PACE = 100.0  # rad/s, about how fast the free cranks turn
UNREADABLE = 1e-9  # of a joint force's peak: rounding of the reading
CLOSED = 1e-10  # of the scene's size: joints hold on position level
GROWN = 3.0  # times an error of the first turns that one of the last may be

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
    kept = ~near_jumps(signal.time, motion)
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
    position, velocity, _ = true_motion(mechanism(name), motion, history.position.time)
    acceleration = true_motion(mechanism(name), motion, history.acceleration.time)[2]  # none at a jump
    assert {signal.origin for _, signal in labelled(history)} == {ORIGIN[setting]}
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
            kept = ~near_jumps(time, motion)
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
    assert run.steps == round(motion.duration / 1e-3)
    assert "fresh_starts" not in run.details


def test_samples_at_a_jump():
    motion = _motion("run-up")
    _, run = _run("juki-mf7923d", motion, channels=EVERYTHING)
    kink, history = motion.segments[0].end, run.history
    for signal, has_start, has_kink in (
        (history.position, True, True),
        (history.velocity, True, True),
        (history.acceleration, False, False),  # what it starts from is given, and at a jump it has two values
        (history.torque, False, False),  # the multipliers belong to steps
        *((force, False, False) for force in history.joint_force.values()),
    ):
        assert np.all(np.diff(signal.time) > 0.0)
        assert (signal.time[0] == 0.0) == has_start
        assert np.isclose(signal.time, kink).any() == has_kink
        assert signal.time[-1] == pytest.approx(motion.duration)


def test_nothing_drifts_over_many_turns():
    motion = crank_motion("constant-speed", ramp_time=3.0, hold_time=0.0)  # 50 turns
    model, run = _run("juki-mf7923d", motion)
    time = run.history.position.time
    gaps = ObservedMotion(model, run.history).joint_gaps(time)
    assert max(gap.max() for gap in gaps.values()) < CLOSED * scene_size(model)
    torque = run.history.torque
    error = np.abs(torque.values - _true_torque("juki-mf7923d", motion, torque.time))
    first, *_, last = np.array_split(error, 10)
    assert last.max() < GROWN * first.max()


@pytest.mark.parametrize("regime", ["run-up", "run-up-quintic", "constant-speed"])
def test_a_parallelogram_passes_its_change_points(regime):
    model = scene(mechanism("parallelogram"), Prescribed(_motion(regime)), NO_FORCES)
    for setting in (Setting.NAIVE, Setting.TUNED):
        run = ENGINE.run(model, setting)
        assert run.outcome is Outcome.FINISHED, run.reason
        number = [body.name for body in model.bodies].index("coupler")
        angle = run.history.position.values[:, number, 2]
        assert np.ptp(angle) < MOTION[Setting.TUNED]  # it does not turn, as long as the assembly stays what it was


# -- a free crank ------------------------------------------------------------------------------------------------------


def _free(name, torque, duration, start_angle):
    free = Free(torque, duration, PACE)
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
    assert run.history.torque is None  # it is given


# -- nothing that is not asked for -------------------------------------------------------------------------------------


def test_no_sensor_for_a_channel_nobody_reads():
    motion = _motion()
    bare = scene(mechanism("juki-mf7923d"), Prescribed(motion), ())
    assert Model(bare).described()["sensors"] == 0
    torque = dataclasses.replace(bare, channels=frozenset({Channel.TORQUE}))
    assert Model(torque).described()["sensors"] == 1
    run = ENGINE.run(torque, Setting.TUNED)
    assert run.history.position is run.history.velocity is run.history.acceleration is None
    assert run.history.joint_force == {}
    assert ENGINE.run(bare, Setting.TUNED).outcome is Outcome.FINISHED


def test_a_body_has_three_coordinates_and_no_weight_without_gravity():
    given = scene(mechanism("juki-mf7923d"), Prescribed(_motion()), ())
    for changed, loads in ((given, 3), (dataclasses.replace(given, gravity=(0.0, 0.0)), 0)):
        world = ENGINE.build(changed, TUNED)
        assert (world.mbs.systemData.ODE2Size(), world.mbs.systemData.NumberOfLoads()) == (9, loads)


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


def test_what_exudyn_gives_up_is_diverged_in_its_own_words():
    run = ENGINE.run(scene(mechanism("parallelogram"), Prescribed(_motion()), NO_FORCES), Setting.BEST)
    assert run.outcome is Outcome.DIVERGED
    assert "exudyn stopped at" in run.reason
    assert run.history is None
    assert run.solver_work > 0


def test_nothing_of_a_run_outlives_it(monkeypatch):
    """Else exudyn holds its functions and sensors for good, a tenth of a megabyte a run."""
    worlds, build = [], ENGINE.build
    monkeypatch.setattr(ENGINE, "build", lambda *given: worlds.append(build(*given)) or worlds[-1], raising=False)
    for name, setting in (("juki-mf7923d", Setting.TUNED), ("parallelogram", Setting.BEST)):  # the latter diverges
        ENGINE.run(scene(mechanism(name), Prescribed(_motion()), NO_FORCES), setting)
    assert len(worlds) >= 2
    assert all(world.container.NumberOfSystems() == 0 for world in worlds)
