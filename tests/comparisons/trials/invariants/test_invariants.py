"""The invariants pass every true motion and detect every fault in one, without the closed form."""

import dataclasses
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from analytic.description.crank_motion import REGIMES, CrankMotion, Segment, crank_motion
from analytic.description.linkage import ReleasedRegime, RotaryDamper
from analytic.description.loading import catalogue, load
from analytic.dynamics.joint_forces import reactions
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime
from comparisons.trials.invariants.checks import (
    _judge_signal,
    assur_groups,
    checks,
    closure,
    crank_phase,
    energy_balance,
    joint_gaps,
)
from comparisons.trials.invariants.inspection import (
    AssurGroups,
    Corrected,
    Inspection,
    speed_errors,
    undissipated_error,
)
from comparisons.trials.judging.limits import limit
from comparisons.trials.judging.records import Verdict, run_of
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.stress.cells import Conditions, StressVerdict, case
from engines.contract import Signal
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import pose_of, with_ground
from engines.scene import LEVELS, Channel
from tests.analytic.linkages import mechanism as sample
from tests.comparisons.true_motions import EVERYTHING, alarms, cut, judgement, true_history, with_signal

JUKI = "juki-mf7923d"

TESTED = sorted(str(path) for path in (Path(__file__).parents[3] / "linkages").glob("*.toml"))
TURNING = [*catalogue(), *(path for path in TESTED if "parallelogram" not in path)]
PRESS = next(path for path in TURNING if "laden-press" in path)
SOME = [JUKI, *(pytest.param(name, marks=pytest.mark.nightly) for name in ("rimoldi-164", "slotted-takeup"))]


@cache
def mechanism(name):
    return Mechanism(load(name))


@cache
def driven(name, regime="run-up-quintic", speed=100.0, start_angle=0.0):
    return Case(mechanism(name), crank_motion(regime, speed=speed, start_angle=start_angle))


@cache
def released(name, turns=5.0, *, speed=100.0, damping=0.0, torque=0.0, start_angle=0.3):
    """Let go at a speed, with one damper on the crank as all the damping there is."""
    linkage = load(name)
    damper = RotaryDamper((linkage.crank, "ground"), damping)
    linkage = dataclasses.replace(linkage, dampers=(damper,) if damping else ())
    own = ReleasedRegime("free", torque, start_angle, speed, turns * 2.0 * np.pi / speed)
    return case_of_file_regime(Mechanism(linkage), own)


def inspected(one, history):
    return Inspection(ObservedMotion(one.scene(EVERYTHING), history), assur_groups(one.mechanism))


def records(one, history):
    found = checks(one, ObservedMotion(one.scene(EVERYTHING), history), run_of(one, "tuned").blank)
    return {record.quantity: record for record in found}


# -- a true motion -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [JUKI, *(pytest.param(name, marks=pytest.mark.nightly) for name in TURNING[1:])])
def test_a_true_motion_raises_no_alarm(name):
    one = driven(name)
    found = judgement(one, true_history(one, 2401))
    assert (found.verdict, alarms(found)) == (StressVerdict.WITHIN, ())


@settings(max_examples=6)
@given(
    name=st.sampled_from(TURNING),
    regime=st.sampled_from(REGIMES),
    speed=st.floats(1.0, 1e4),
    start_angle=st.floats(-3.0, 3.0),
    count=st.integers(900, 1500),
)
@example(name=PRESS, regime="run-up-cubic", speed=1.0, start_angle=-1.0, count=900)  # one-way loads, at rest
def test_no_speed_ramp_or_start_raises_one(name, regime, speed, start_angle, count):
    motion = crank_motion(regime, speed=speed, start_angle=start_angle, ramp_time=60.0 / speed, hold_time=10.0 / speed)
    one = Case(mechanism(name), motion)
    assert alarms(judgement(one, true_history(one, count))) == ()


def toggle(excess):
    """A slider-crank whose rod is longer than its toggle by a share."""
    conditions = Conditions("slider-crank", link="rod", point="D", at=(0.05, 0.0), slope=(0.05, 0.0), excess=excess)
    return case(conditions)


TRUE = {
    "25 samples": lambda: (driven(JUKI), 25),
    "150 samples": lambda: (driven(JUKI), 150),
    "a peak between two samples": lambda: (toggle(1e-2), 301),
    "a narrower one": lambda: (toggle(1e-6), 301),
    "a still narrower one": lambda: (toggle(1e-8), 1201),
    "a released crank": lambda: (released(JUKI), 1501),
    "a released crank with torque and damping": lambda: (released(JUKI, damping=0.5, torque=2.0), 1501),
}


@pytest.mark.parametrize("name", TRUE)
def test_few_samples_a_spike_or_a_release_raise_none(name):
    one, count = TRUE[name]()
    assert alarms(judgement(one, true_history(one, count))) == ()


def test_the_velocity_may_have_a_clock_of_its_own():
    one = driven(JUKI)
    assert alarms(judgement(one, true_history(one, 2801, shift=0.5))) == ()


# -- one thing wrong ---------------------------------------------------------------------------------------------------


FAULTS = {
    "a jerked body": ("velocity", lambda values, _: values + _bump(values, 500)),
    "a lost body": ("position", lambda values, _: values + _bump(values, 700)),
    "a torque that comes late": ("torque", lambda values, _: np.roll(values, 12)),
    "a torque without its peaks": ("torque", lambda values, _: np.clip(values, *np.quantile(values, [0.02, 0.98]))),
}


def _bump(values, at):
    """Three samples of the last body a good deal off."""
    off = np.zeros_like(values)
    off[at : at + 3, -1, 0] = 0.05 * np.max(np.abs(values))
    return off


@pytest.mark.parametrize("name", SOME)
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_one_signal_is_caught(name, fault):
    signal, change = FAULTS[fault]
    one = driven(name)
    found = judgement(one, with_signal(true_history(one), signal, change))
    assert alarms(found), fault
    assert found.verdict is not StressVerdict.MISSED


@settings(max_examples=6)
@given(
    name=st.sampled_from(TURNING),
    signal=st.sampled_from(["velocity", "acceleration", "torque"]),
    scale=st.one_of(st.floats(-2.0, 0.98), st.floats(1.02, 5.0)),
)
def test_whatever_is_scaled_is_caught(name, signal, scale):
    one = driven(name)
    assert alarms(judgement(one, with_signal(true_history(one, 601), signal, lambda values, _: scale * values)))


@settings(max_examples=6)
@given(name=st.sampled_from(TURNING), lag=st.floats(0.011, 3.0), ahead=st.booleans())
def test_a_crank_off_its_drive_is_caught(name, lag, ahead):
    one = driven(name)
    found = judgement(one, true_history(one, 601, lag=-lag if ahead else lag))
    assert found.verdict is StressVerdict.CAUGHT
    assert "crank_phase" in alarms(found)


@pytest.mark.parametrize("name", SOME)
@pytest.mark.parametrize("scale", [0.98, 1.02])
def test_a_wrong_force_in_any_one_joint_is_caught(name, scale):
    one = driven(name)
    history = true_history(one)
    for joint, signal in history.joint_force.items():
        forces = {**history.joint_force, joint: Signal(signal.time, scale * signal.values)}
        found = judgement(one, dataclasses.replace(history, joint_force=forces))
        assert "force_balance" in alarms(found), joint
        assert {*alarms(found)} <= {"force_balance", "weight_on_frame"}, joint


@pytest.mark.parametrize("regime", ["run-up", "constant-speed"])
@pytest.mark.parametrize("name", ["fork-takeup", JUKI])
def test_gravity_of_9_80_is_caught_by_the_weight_on_the_frame_alone(name, regime):
    one, linkage = driven(name, regime), mechanism(name).linkage
    history = true_history(one, 1401, mechanism=Mechanism(dataclasses.replace(linkage, gravity=(0.0, -9.80))))
    assert alarms(judgement(one, history)) == ("weight_on_frame",)
    off = records(one, history)["weight_on_frame"].error_max
    assert off == pytest.approx(0.01 / 9.81, rel=1e-3)


@pytest.mark.parametrize("name", ["force-over-angle", "spring-and-damper"])
def test_the_frame_carries_forces_and_springs_beside_the_weight(name):
    one = Case(sample(name), crank_motion("constant-speed", speed=20.0, ramp_time=0.4))
    assert records(one, true_history(one))["weight_on_frame"].error_max < 1e-6


def test_a_sample_on_a_jump_weighs_nothing():
    """The turn of the mean begins at a jump of the acceleration, where an engine shows the mean of both forces."""
    one = Case(mechanism(JUKI), crank_motion("run-up", speed=100.0, ramp_time=0.08 * np.pi, hold_time=0.02 * np.pi))
    history = true_history(one, 1001)
    for force in history.joint_force.values():
        force.values[800] = 0.5 * (force.values[799] + force.values[801])
    assert records(one, history)["weight_on_frame"].error_max < 1e-6


def test_forces_may_have_clocks_of_their_own():
    """The last joint's begins late; the others are read between their samples, up to a jump of the acceleration."""
    one = driven(JUKI, "run-up")
    history, (*others, last) = true_history(one, 1201), one.joint_names()
    coarse = true_history(one, 1000).joint_force
    late = Signal(history.torque.time[200:], history.joint_force[last].values[200:])
    forces = {**{name: coarse[name] for name in others}, last: late}
    record = records(one, dataclasses.replace(history, joint_force=forces))["force_balance"]
    assert (record.outcome, record.error_max < 1e-6) == ("passed", True)


def test_a_guide_that_pulls_along_itself_is_caught():
    one = driven(JUKI)
    history = true_history(one)
    (guide,) = (name for name in history.joint_force if " on " in name)
    signal = history.joint_force[guide]
    along = 0.02 * np.max(np.abs(signal.values)) * np.array([0.0, 1.0])
    forces = {**history.joint_force, guide: Signal(signal.time, signal.values + along)}
    assert "force_balance" in alarms(judgement(one, dataclasses.replace(history, joint_force=forces)))


def test_another_linkage_is_caught_by_what_its_joints_lack():
    """A rod longer by 3e-5 opens its joint by as little, and near the toggle moves the slider by 40 times as much."""
    one, other = toggle(1e-5), toggle(4e-5)
    found = judgement(one, true_history(one, 1201, mechanism=other.mechanism))
    assert found.verdict is StressVerdict.CAUGHT
    assert "joint_gap" not in alarms(found)
    assert "closure" in alarms(found)


# -- a spike beside a toggle -----------------------------------------------------------------------------------------


def spike(name, degrees, clockwise=False):
    """A passage so close to a toggle that torque and energy rise and fall within some samples."""
    path = Path(__file__).with_name("spikes") / f"{name}.toml"
    motion = crank_motion("run-up-quintic", start_angle=np.radians(degrees), clockwise=clockwise)
    return Case(Mechanism(load(str(path))), motion)


SPIKES = [
    pytest.param(("near-toggle", 78.8), id="near-toggle"),
    pytest.param(("random-218", 78.79541471699513), id="random-218", marks=pytest.mark.nightly),
    pytest.param(("random-315", 31.065246489508237, True), id="random-315", marks=pytest.mark.nightly),
]


@pytest.mark.parametrize("where", SPIKES)
def test_a_spike_raises_no_alarm_and_its_energy_balance_is_undefined(where):
    one = spike(*where)
    found = records(one, true_history(one, 1401))
    energy = found.pop("energy_balance")
    assert {record.outcome for record in found.values()} == {Verdict.PASSED}
    assert energy.outcome == Verdict.UNDEFINED
    assert energy.error_max > energy.limit


@pytest.mark.parametrize("signal", ["torque", "velocity", "acceleration"])
@pytest.mark.parametrize("where", SPIKES)
def test_a_fault_within_a_spike_is_caught(where, signal):
    one = spike(*where)
    history = true_history(one, 1401)
    size = np.abs(getattr(history, signal).values).reshape(1401, -1).max(axis=1)
    inside = np.abs(np.arange(1401) - np.argmax(size)) <= 2
    wrong = with_signal(
        history, signal, lambda values, _: np.where(inside.reshape(-1, *[1] * (values.ndim - 1)), 0.97, 1.0) * values
    )
    assert Verdict.OVER_LIMIT in {record.outcome for record in records(one, wrong).values()}


# -- what cannot be judged ---------------------------------------------------------------------------------------------


def test_few_samples_leave_what_is_integrated_undefined_and_nothing_else():
    one = driven(JUKI)
    found = records(one, true_history(one, 150))
    left = {name: record for name, record in found.items() if record.outcome != Verdict.PASSED}
    assert left.keys() == {"energy_balance", "weight_on_frame"}
    for record in left.values():
        assert record.outcome == Verdict.UNDEFINED
        assert "error estimate" in record.detail


def test_an_energy_balance_shows_its_error_estimate_where_that_is_larger():
    one = driven(JUKI)
    history = true_history(one, 1401)
    balance = energy_balance(inspected(one, history))
    record = records(one, history)["energy_balance"]
    assert record.outcome == Verdict.PASSED
    assert record.error_max * record.peak == pytest.approx(np.max(balance.error_estimate))
    assert np.all(np.abs(balance.gained) <= balance.error_estimate + 1e-12 * record.peak)


def test_an_invariant_without_a_sample_is_undefined():
    blank = run_of(driven(JUKI), "tuned").blank._replace(quantity="closure")
    nowhere = Signal(np.linspace(0.0, 1.0, 30), np.full(30, np.nan))
    record = _judge_signal(blank, nowhere, 1.0, 30)
    assert (record.outcome, record.error_max, record.left_out) == (Verdict.UNDEFINED, None, 30)
    assert record.detail


# -- what is not told --------------------------------------------------------------------------------------------------


def test_samples_half_a_turn_apart_are_not_the_motion():
    one = driven(JUKI, "constant-speed")
    found = judgement(one, cut(true_history(one), lambda t: np.abs(t - 0.6 * t[-1]) > 0.15 * t[-1]))
    assert found.verdict is StressVerdict.CAUGHT
    assert "crank_phase" in alarms(found)


# -- single ones -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def motion():
    one = driven(JUKI)
    return ObservedMotion(one.scene(EVERYTHING), true_history(one, 2801))


def test_a_body_out_of_place_opens_its_joints_and_no_others(motion):
    moved = with_signal(motion.history, "position", lambda values, _: values + _at(values, 1000, 1))
    wrong = ObservedMotion(motion.scene, moved)
    gaps = joint_gaps(wrong).values
    assert gaps[1000] == pytest.approx(1e-6, rel=0.5)
    assert gaps[999] < 1e-15
    name = motion.scene.bodies[1].name
    for joint, gap in wrong.joint_gaps(wrong.signal(Channel.POSITION).time).items():
        touched = [pin.name for pin in motion.scene.pins if name in {pin.first, pin.second}]
        assert bool(gap[1000] > 1e-8) is (joint in touched)


def _at(values, sample, body):
    off = np.zeros_like(values)
    off[sample, body, 0] = 1e-6
    return off


def test_both_routes_to_the_torque_agree_at_standstill_too(motion):
    by_power = Inspection(motion, assur_groups(mechanism(JUKI))).torque_required()
    torque = motion.history.torque
    assert by_power.time[0] == 0.0
    np.testing.assert_allclose(by_power.values, torque.values, atol=1e-10 * np.abs(torque.values).max())


def test_energy_is_balanced_across_acceleration_jumps():
    one = driven("rimoldi-164", "run-up")
    seen = inspected(one, true_history(one, 2801))
    peak = seen.motion.kinetic_energy(seen.motion.history.velocity.time).max()
    assert np.abs(energy_balance(seen).gained).max() < 1e-6 * peak


# -- assembly modes and change points ----------------------------------------------------------------------------------


def _unequal(excess, **changes):
    return case(
        Conditions(
            "parallel-cranks", link="rocker", point="B", at=(0.025, 0.0), slope=(0.025, 0.0), start_angle=90.0,
            excess=excess, motion="constant-speed", turns=1.4, **changes,
        )
    )  # fmt: skip


def _parallel(one, count=1201):
    """The smooth way through both change points: rocker parallel to the crank, coupler to the frame."""
    history = true_history(one, count)
    time = history.position.time
    angle, speed, arm = one.motion.angle(time), one.motion.speed(time), 0.025
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    names = [body.name for body in one.scene(EVERYTHING).bodies]
    coupler, rocker = names.index("coupler"), names.index("rocker")
    position, velocity = history.position.values.copy(), history.velocity.values.copy()
    acceleration = history.acceleration.values.copy()
    position[:, coupler], velocity[:, coupler], acceleration[:, coupler] = 0.0, 0.0, 0.0
    position[:, coupler, :2] = arm * circle + [0.03, 0.0]
    velocity[:, coupler, :2] = arm * speed[:, None] * np.stack([-circle[:, 1], circle[:, 0]], axis=1)
    acceleration[:, coupler, :2] = -arm * speed[:, None] ** 2 * circle
    position[:, rocker, 2], velocity[:, rocker, 2], acceleration[:, rocker, 2] = angle, speed, 0.0
    signals = {"position": position, "velocity": velocity, "acceleration": acceleration}
    return dataclasses.replace(history, **{name: Signal(time, values) for name, values in signals.items()})


def test_a_linkage_that_takes_the_smooth_way_through_a_change_point_is_caught_by_its_mode():
    one = _unequal(1e-7)
    history = _parallel(one)
    seen = inspected(one, history)
    assert joint_gaps(seen.motion).values.max() < 1e-4 * 0.025
    mode = seen.assembly_mode()
    assert mode.values.max() > 0.5
    assert (
        mode.values[mode.time < 0.2 * one.motion.duration / 1.4].max() < 1e-3
    )  # the first change point is at 1/4 turn
    found = judgement(one, history)
    assert found.verdict is StressVerdict.CAUGHT
    assert "assembly_mode" in alarms(found)


def test_of_equal_lengths_the_smooth_way_is_the_right_one_and_the_other_is_caught():
    one = _unequal(0.0)
    found = judgement(one, _parallel(one))
    assert found.verdict is StressVerdict.WITHIN
    turned_back = Mechanism(one.mechanism.linkage)
    turned_back.structure = turned_back.structure.with_signs((1,))
    with np.errstate(all="ignore"):
        found = judgement(one, true_history(one, 1200, mechanism=turned_back))
    assert found.verdict is StressVerdict.CAUGHT
    assert "assembly_mode" in alarms(found)


def test_two_groups_in_their_other_modes_do_not_hide_each_other():
    """The determinant of the whole linkage has its sign back; those of its groups have not."""
    name = "slotted-takeup"
    signs = tuple(-dyad.sign for dyad in mechanism(name).structure.dyads)
    assert signs == (1, 1)
    other = Mechanism(load(name))
    other.structure = other.structure.with_signs(signs)
    one = driven(name)
    history = true_history(one, mechanism=other)
    true, seen = (inspected(one, h) for h in (true_history(one), history))
    whole = [np.sign(np.prod(found.on(Channel.POSITION).determinants, axis=1)) for found in (true, seen)]
    np.testing.assert_array_equal(*whole)
    assert "assembly_mode" in alarms(judgement(one, history))


@pytest.mark.parametrize("beside", [0.0, 1e-5])  # rad from the change point to the nearest sample
def test_the_smooth_way_through_change_points_raises_no_alarm(beside):
    motion = CrankMotion("constant-speed", (Segment(0.0, 0.1, (math.pi - 3.0 + beside, 60.0)),))
    one = Case(sample("parallelogram"), motion)
    found = records(one, _parallel(one, 1401))
    left = {name: record.outcome for name, record in found.items() if record.outcome != Verdict.PASSED}
    assert left == {"force_balance": Verdict.UNDEFINED}


def test_a_wrong_torque_at_a_change_point_is_caught_by_the_smooth_curve_over_it():
    one = Case(sample("parallelogram"), CrankMotion("constant-speed", (Segment(0.0, 0.1, (math.pi - 3.0, 60.0)),)))
    history = _parallel(one, 1401)
    beside = np.abs(one.motion.angle(history.torque.time) - math.pi) < 0.02
    peak = np.max(np.abs(history.torque.values))
    wrong = with_signal(history, "torque", lambda values, _: values + np.where(beside, 0.01 * peak, 0.0))
    found = records(one, wrong)["torque_two_routes"]
    assert found.error_max == pytest.approx(0.01, rel=0.02)
    assert abs(one.motion.angle(found.worst_time) - math.pi) < 0.02


# -- a released crank --------------------------------------------------------------------------------------------------


def test_the_angle_turned_before_the_first_acceleration_is_not_the_engines_error():
    one = released(JUKI, speed=100.0, torque=0.5, turns=3.0)
    history = true_history(one)
    late = Signal(history.acceleration.time[4:], history.acceleration.values[4:])
    seen = inspected(one, dataclasses.replace(history, acceleration=late))
    assert np.max(crank_phase(seen).values) < 1e-12


def test_tiny_dissipation_is_caught_over_many_turns():
    """It takes less than the energy's own limit, and still puts the crank some hundredths of a radian behind."""
    turns = 30
    one, lossy = released(JUKI, turns), released(JUKI, turns, damping=2.2e-8)
    history = true_history(dataclasses.replace(lossy, mechanism=one.mechanism), 100 * turns)
    found = judgement(one, history)
    assert found.verdict is StressVerdict.CAUGHT
    assert alarms(found) == ("crank_phase",)


def test_a_wrong_start_that_fits_itself_is_caught():
    one, fast = released(JUKI), released(JUKI, speed=100.5, turns=5.0 * 1.005)
    found = judgement(one, true_history(dataclasses.replace(fast, mechanism=one.mechanism)))
    assert found.verdict is StressVerdict.CAUGHT
    assert "crank_phase" in alarms(found)


def test_a_crank_that_rests_at_its_turning_point_is_caught():
    """Its energy is right for ever; only the equation of motion forbids it."""
    one = released(JUKI, turns=2.0, speed=3.0)
    angle = one.motion.angle(np.linspace(0.0, one.motion.duration, 4001))
    turning = int(np.argmax(np.abs(one.motion.speed(np.linspace(0.0, one.motion.duration, 4001))) < 1e-2))
    assert 0 < turning < 3500
    history = true_history(one, 4001)

    def rests(values, _):
        values[turning:] = values[turning]
        return values

    def still(values, _):
        values[turning:] = 0.0
        return values

    for name, change in (("position", rests), ("velocity", still), ("acceleration", still)):
        history = with_signal(history, name, change)
    found = judgement(one, history)
    assert np.ptp(angle) > 0.1
    assert found.verdict is StressVerdict.CAUGHT
    assert "torque_two_routes" in alarms(found)


def test_a_speed_its_acceleration_does_not_make_is_caught():
    """Held back by a damper, the crank has forgotten its start within a sample; a slow engine has not."""
    one = released(JUKI, damping=0.5, torque=2.0, speed=10.0, turns=1.0)
    history = true_history(one, 401)
    assert closure(inspected(one, history))["drift"].values.max() < limit("closure", "tuned", "own").value
    slow = with_signal(
        history, "velocity", lambda values, time: values * (1.0 + 0.2 * np.exp(-time / 0.01))[:, None, None]
    )
    drift = closure(inspected(one, slow))["drift"]
    assert drift.values.max() > 0.1


# The joints' equations of an observed motion: groups and assembly modes, corrections, relaxation.


def jacobian(groups, position):
    equations = groups.equations
    return equations.jacobian(equations.arms(pose_of(with_ground(position) / equations.metres)))


NAMES = ["juki-mf7923d", "tests/linkages/moving-guides.toml"]


@cache
def truth(name):
    case = Case(Mechanism(load(name)), crank_motion("run-up-quintic", start_angle=0.4))
    return case, true_history(case, 101)


def groups_of(case):
    return AssurGroups(JointEquations(case.scene(EVERYTHING)), assur_groups(case.mechanism))


def off(name, level, size, seed=3):
    """A true history with one level off by random errors of a size, and the errors."""
    case, history = truth(name)
    signal = getattr(history, LEVELS[level].value)
    groups = groups_of(case)
    equations = groups.equations
    scale = np.max(np.abs(signal.values)) if level else 1.0
    error = size * scale * np.random.default_rng(seed).normal(size=signal.values.shape)
    error *= (equations.column[:-1] != equations.size) * equations.metres
    changed = dataclasses.replace(history, **{LEVELS[level].value: Signal(signal.time, signal.values + error)})
    return Corrected(ObservedMotion(case.scene(EVERYTHING), changed), groups, signal.time), error


@pytest.mark.parametrize(("name", "level"), [(NAMES[0], 0), (NAMES[0], 1), (NAMES[1], 2)])
def test_a_correction_is_the_error_turned_round(name, level):
    instants, error = off(name, level, 1e-7)
    error = error / instants.equations.metres
    assert np.max(np.abs(instants.correction(level)[:, :-1] + error)) < 1e-5 * np.max(np.abs(error))


@pytest.mark.parametrize("name", NAMES)
def test_a_velocity_that_fits_a_wrong_position_lacks_what_the_right_one_asks_for(name):
    instants, _ = off(name, 0, 1e-4)
    case, history = truth(name)
    equations = instants.equations
    matrix = equations.jacobian(equations.arms(pose_of(instants.corrected(0))))
    speed = case.motion.speed(instants.time)[:, None] * equations.crank_unit(len(matrix))
    right = equations.spread(np.linalg.solve(matrix, speed[..., None])[..., 0])
    true = with_ground(history.velocity.values) / equations.metres * (equations.column != equations.size)
    assert np.max(np.abs(true - right)) < 1e-5 * np.max(np.abs(true))
    corrected = instants.corrected(1) * (equations.column != equations.size)
    assert np.max(np.abs(corrected - true)) < 1e-5 * np.max(np.abs(true))


@pytest.mark.parametrize("name", NAMES)
def test_reactions_are_the_closed_forms(name):
    case, history = truth(name)
    scene = case.scene(EVERYTHING)
    instants = Corrected(ObservedMotion(scene, history), groups_of(case), history.position.time)
    time = history.position.time
    forces = reactions(case.sweep(time), case.motion.speed(time), case.motion.acceleration(time)).forces
    peak = max(np.max(np.abs(force)) for force in forces.values())
    for number, joint in enumerate([*scene.pins, *scene.guided]):
        assert np.max(np.abs(instants.forces[:, number] - forces[joint.name].T)) < 1e-12 * peak
    torque = history.torque.values
    assert np.max(np.abs(instants.torque - torque)) < 1e-12 * np.max(np.abs(torque))


@pytest.mark.parametrize("rate", [0.0, 0.3, 1e6])
def test_an_energy_error_decays_at_its_rate(rate):
    """A steady source s against a decay r makes s/r (1 − e^{−rt}): known at every sample, however coarse."""
    time = np.linspace(0.0, 2.0, 41)
    left = undissipated_error(3.0 * time, np.full(41, rate), time)
    exact = 3.0 * time if rate == 0.0 else 3.0 / rate * -np.expm1(-rate * time)
    np.testing.assert_allclose(left, exact, rtol=1e-10)


@pytest.mark.parametrize("rate", [0.0, 30.0, 1e9])
@pytest.mark.parametrize("excess", [0.0, 0.1])
def test_a_speed_is_compared_with_its_acceleration_however_stiff(rate, excess):
    """ω' = g − r ω from rest, over within 1/r. A wrong speed obeys that equation too, but is not what it leads to."""
    time = np.linspace(0.0, 1.0, 201)
    speed = 2.0 * time if rate == 0.0 else 2.0 / rate * -np.expm1(-rate * time)
    claimed = speed * (1.0 + excess * np.exp(-time / 0.3))
    found = speed_errors(time, claimed, 2.0 - rate * claimed, np.full(201, rate), 0.0)
    peak = np.max(speed)
    if excess:
        assert np.max(found) > 5.0 * limit("closure", "tuned", "own").value * peak
    else:
        assert np.max(found) < 1e-6 * peak
