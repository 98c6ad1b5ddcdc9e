"""A crank is let go without a jolt, and being let go again and again makes its motion better, not worse."""

import dataclasses
import itertools

import numpy as np
import pytest

from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import free_motion
from comparisons.invariants import invariants
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.pymunk_adapter import released
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.pymunk_adapter.layout import exact_layout
from engines.pymunk_adapter.plans import METHODS
from engines.pymunk_adapter.space import Rig
from engines.scene import Channel, Free
from engines.stepping.cost import Cost
from tests.analytic.linkages import mechanism
from tests.engines.newton_euler import joint_forces, true_motion

pytest.importorskip("pymunk")

ENGINE = PymunkEngine()
X3 = dataclasses.replace(next(method for method in METHODS if method.name == "centred x3"), effort=60)
SPEED = 100.0  # rad/s at the start
STEP = 5e-4  # s

FIRST_SAMPLE = 1e-4  # of the peak; half of the centripetal forces would be 0.5
UNTRACED = 2e-6  # of the peak, at the samples around a release
IN_STEP = 1e-5  # relative; what releases leave of the joints' opening otherwise
LOST_ENERGY = 1e-6  # of all, in ninety turns
ROUNDING = 1e-12


def _spun(name, duration, channels=frozenset(Channel), torque=0.0, speed=SPEED):
    """A scene released at a speed, and its true motion."""
    closed = mechanism(name)
    model = scene(closed, Free(torque, duration), channels, start_angle=0.3, speed=speed)
    return model, free_motion(closed, torque=torque, start_angle=0.3, start_speed=speed, duration=duration)


def _finished(model, step=STEP, method=X3):
    run = ENGINE.run_method(model, method, step)
    assert run.outcome is Outcome.FINISHED, run.reason
    return run


@pytest.mark.parametrize("name", ["juki-mf7923d", "rimoldi-164"])
def test_the_first_sample_of_a_crank_let_go_at_speed_is_as_good_as_the_others(name):
    model, truth = _spun(name, 0.05)
    history = _finished(model).history
    time = history.acceleration.time
    position, _, acceleration = true_motion(mechanism(name), truth, time)
    turning = [body.inertia is not None for body in model.bodies]
    off = np.abs(history.acceleration.values - acceleration)
    scale = np.abs(acceleration).max(axis=0)
    assert (off[0, :, :2] / scale[:, :2].max()).max() < FIRST_SAMPLE
    assert (off[0, turning, 2] / scale[turning, 2]).max() < FIRST_SAMPLE
    forces, torque = joint_forces(model, position, acceleration)
    largest = max(np.abs(force).max() for force in forces.values())
    assert np.abs(torque).max() < 1e-6 * largest  # the truth is nobody's drive
    for joint, force in forces.items():
        assert np.abs(history.joint_force[joint].values[0] - force[0]).max() < FIRST_SAMPLE * largest, joint


def test_releases_leave_no_trace(monkeypatch):
    model, truth = _spun("rimoldi-164", 0.3)
    errors = {}
    for window in (150, 10**6):
        monkeypatch.setattr(released, "WINDOW", window)
        history = _finished(model).history
        exact = true_motion(mechanism("rimoldi-164"), truth, history.acceleration.time)[2]
        errors[window] = np.abs(history.acceleration.values - exact)[..., :2].max(axis=(1, 2)) / np.abs(exact).max()
    assert len(errors[150]) == 601
    around = np.concatenate([np.arange(at - 3, at + 30) for at in (150, 300, 450)])
    assert errors[150][around].max() < UNTRACED


def test_releases_keep_the_passes_in_step(monkeypatch):
    model, _ = _spun("juki-mf7923d", 2.0, frozenset({Channel.POSITION}))
    opened = {}
    for window in (500, 10**6):
        monkeypatch.setattr(released, "WINDOW", window)
        opened[window] = invariants.joint_gaps(ObservedMotion(model, _finished(model).history)).values.max()
    size = mechanism("juki-mf7923d").linkage.shortest_length()
    assert opened[500] < IN_STEP * size
    assert opened[10**6] > 10.0 * opened[500]


def test_samples_go_on_evenly_over_releases(monkeypatch):
    monkeypatch.setattr(released, "WINDOW", 120)
    model, _ = _spun("juki-mf7923d", 0.2)
    history = _finished(model).history
    assert len(history.position.time) == 401
    assert len(history.velocity.time) == 400
    signals = [getattr(history, channel.value) for channel in set(Channel) - {Channel.JOINT_FORCE}]
    for signal in (*signals, *history.joint_force.values()):
        assert len(signal.time) == len(signal.values)
        assert np.ptp(np.diff(signal.time)) < ROUNDING
    assert history.position.time[-1] == pytest.approx(0.2, abs=ROUNDING)


@pytest.mark.parametrize("channel", [Channel.VELOCITY, Channel.TORQUE, Channel.JOINT_FORCE])
def test_what_releases_need_to_see_is_not_handed_back(monkeypatch, channel):
    monkeypatch.setattr(released, "WINDOW", 100)
    model, _ = _spun("juki-mf7923d", 0.15, frozenset({channel}))
    whole, _ = _spun("juki-mf7923d", 0.15)
    history, complete = _finished(model).history, _finished(whole).history
    for other in Channel:
        assert bool(getattr(history, other.value)) == (other is channel)
    if channel is Channel.VELOCITY:
        assert np.abs(history.velocity.values - complete.velocity.values).max() < 1e-9 * SPEED


def test_a_crank_that_nothing_slows_down_keeps_its_energy():
    closed = Mechanism(dataclasses.replace(mechanism("juki-mf7923d").linkage, gravity=(0.0, 0.0)))
    wanted = frozenset({Channel.POSITION, Channel.VELOCITY})
    model = scene(closed, Free(0.0, 6.0), wanted, start_angle=0.3, speed=SPEED)
    run = ENGINE.run(model, Setting.TUNED)
    assert run.outcome is Outcome.FINISHED, run.reason
    energy = ObservedMotion(model, run.history).kinetic_energy(run.history.velocity.time)
    assert np.ptp(run.history.position.values[:, [body.name for body in model.bodies].index(model.crank), 2]) > 560.0
    assert np.ptp(energy) < LOST_ENERGY * energy[0]


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
def test_read_outs_stay_in_phase_over_many_turns(setting):
    closed = mechanism("slotted-takeup")
    model, truth = _spun("slotted-takeup", 3.0, frozenset({Channel.POSITION, Channel.VELOCITY}), 0.025, 0.0)
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    signal = run.history.position
    exact = true_motion(closed, truth, signal.time)[0]
    crank = [body.name for body in model.bodies].index(model.crank)
    assert exact[-1, crank, 2] - exact[0, crank, 2] > 20.0 * 2.0 * np.pi
    limit = {Setting.TUNED: 1e-5, Setting.BEST: 3e-7}[setting]
    assert np.abs(signal.values[..., 2] - exact[..., 2])[:, crank].max() < limit
    reach = np.abs(exact[..., :2]).max()
    assert np.abs(signal.values - exact)[..., :2].max() < limit * reach


def test_the_disagreement_about_a_long_motion_is_not_too_small():
    model, truth = _spun("slotted-takeup", 2.0, frozenset({Channel.POSITION}), 0.025, 0.0)
    rig = Rig(model, exact_layout(model), 60, checked=False)
    crank = rig.layout.crank
    disagreements, errors = [], []
    for step in (2e-3, 1e-3):
        history, left = released.followed(rig, model.drive, step, (3, 5, 7), Cost())
        position = history.position
        disagreements.append(left)
        errors.append(np.abs(position.values[:, crank, 2] - truth.angle(position.time)).max())
    assert all(left > error for left, error in zip(disagreements, errors, strict=True))
    assert all(finer < coarser / 4.0 for coarser, finer in itertools.pairwise(disagreements))
