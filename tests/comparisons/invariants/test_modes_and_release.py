"""Invariants at change points, in other assembly modes, and of a released crank."""

import dataclasses
import math

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import Case
from comparisons.invariants.checks import checks, closure, crank_phase, joint_gaps
from comparisons.invariants.inspection import Inspection
from comparisons.judging.limits import limit
from comparisons.judging.records import Verdict, blank_record
from comparisons.observed_motion import ObservedMotion
from comparisons.stress.cells import Conditions, case
from comparisons.stress.verdict import StressVerdict
from engines.contract import Signal
from engines.scene import Channel
from tests.analytic.linkages import mechanism as sample
from tests.comparisons.invariants.checked_motions import JUKI, driven, mechanism, released
from tests.comparisons.true_motions import EVERYTHING, judgement, true_history, with_signal

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
    seen = ObservedMotion(one.scene(EVERYTHING), history)
    assert joint_gaps(seen).values.max() < 1e-4 * 0.025
    mode = Inspection(seen).assembly_mode()
    assert mode.values.max() > 0.5
    assert (
        mode.values[mode.time < 0.2 * one.motion.duration / 1.4].max() < 1e-3
    )  # the first change point is at 1/4 turn
    found = judgement(one, history)
    assert found.verdict is StressVerdict.CAUGHT
    assert "assembly_mode" in found.alarms


def test_of_equal_lengths_the_smooth_way_is_the_right_one_and_the_other_is_caught():
    one = _unequal(0.0)
    found = judgement(one, _parallel(one))
    assert found.verdict is StressVerdict.WITHIN
    turned_back = Mechanism(one.mechanism.linkage)
    turned_back.structure = turned_back.structure.with_signs((1,))
    with np.errstate(all="ignore"):
        found = judgement(one, true_history(one, 1200, mechanism=turned_back))
    assert found.verdict is StressVerdict.CAUGHT
    assert "assembly_mode" in found.alarms


def test_two_groups_in_their_other_modes_do_not_hide_each_other():
    """The determinant of the whole linkage has its sign back; those of its groups have not."""
    name = "slotted-takeup"
    signs = tuple(-dyad.sign for dyad in mechanism(name).structure.dyads)
    assert signs == (1, 1)
    other = Mechanism(load(name))
    other.structure = other.structure.with_signs(signs)
    one = driven(name)
    history = true_history(one, mechanism=other)
    true, seen = (Inspection(ObservedMotion(one.scene(EVERYTHING), h)) for h in (true_history(one), history))
    whole = [np.sign(np.prod(found.on(Channel.POSITION).determinants, axis=1)) for found in (true, seen)]
    np.testing.assert_array_equal(*whole)
    assert "assembly_mode" in judgement(one, history).alarms


def test_the_force_balance_is_undefined_where_a_change_point_is_passed():
    one = _unequal(0.0)
    motion = ObservedMotion(one.scene(EVERYTHING), _parallel(one))
    records = {record.quantity: record for record in checks(one, motion, blank_record(one, "tuned"))}
    assert records["force_balance"].outcome == Verdict.UNDEFINED
    assert "no bound where the linkage passes its change point at" in records["force_balance"].detail
    assert records["assembly_mode"].outcome == Verdict.PASSED


@pytest.mark.parametrize("beside", [0.0, 1e-5])  # rad from the change point to the nearest sample
def test_the_smooth_way_through_change_points_raises_no_alarm(beside):
    motion = CrankMotion("constant-speed", (Segment(0.0, 0.1, (math.pi - 3.0 + beside, 60.0)),))
    one = Case(sample("parallelogram"), motion)
    motion = ObservedMotion(one.scene(EVERYTHING), _parallel(one, 1401))
    records = checks(one, motion, blank_record(one, "tuned"))
    assert {record.quantity for record in records if record.outcome != Verdict.PASSED} == {"force_balance"}


def test_a_wrong_torque_at_a_change_point_is_caught_by_the_smooth_curve_over_it():
    one = Case(sample("parallelogram"), CrankMotion("constant-speed", (Segment(0.0, 0.1, (math.pi - 3.0, 60.0)),)))
    history = _parallel(one, 1401)
    beside = np.abs(one.motion.angle(history.torque.time) - math.pi) < 0.02
    peak = np.max(np.abs(history.torque.values))
    wrong = with_signal(history, "torque", lambda values, _: values + np.where(beside, 0.01 * peak, 0.0))
    records = {
        r.quantity: r for r in checks(one, ObservedMotion(one.scene(EVERYTHING), wrong), blank_record(one, "tuned"))
    }
    assert records["torque_two_routes"].error_max == pytest.approx(0.01, rel=0.02)
    assert abs(one.motion.angle(records["torque_two_routes"].worst_time) - math.pi) < 0.02


# -- a released crank --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("damping", "torque"), [(0.0, 0.0), (0.5, 2.0)])
def test_a_released_crank_raises_none(damping, torque):
    one = released(JUKI, damping=damping, torque=torque)
    assert judgement(one, true_history(one, 1501)).alarms == ()


def test_the_angle_turned_before_the_first_acceleration_is_not_the_engines_error():
    one = released(JUKI, speed=100.0, torque=0.5, turns=3.0)
    history = true_history(one)
    late = Signal(history.acceleration.time[4:], history.acceleration.values[4:])
    seen = Inspection(ObservedMotion(one.scene(EVERYTHING), dataclasses.replace(history, acceleration=late)))
    assert np.max(crank_phase(seen).values) < 1e-12


def test_tiny_dissipation_is_caught_over_many_turns():
    """It takes less than the energy's own limit, and still puts the crank some hundredths of a radian behind."""
    turns = 30
    one, lossy = released(JUKI, turns), released(JUKI, turns, damping=2.2e-8)
    history = true_history(dataclasses.replace(lossy, mechanism=one.mechanism), 100 * turns)
    found = judgement(one, history)
    assert found.verdict is StressVerdict.CAUGHT
    assert found.alarms == ("crank_phase",)


def test_a_wrong_start_that_fits_itself_is_caught():
    one, fast = released(JUKI), released(JUKI, speed=100.5, turns=5.0 * 1.005)
    found = judgement(one, true_history(dataclasses.replace(fast, mechanism=one.mechanism)))
    assert found.verdict is StressVerdict.CAUGHT
    assert "crank_phase" in found.alarms


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
    assert "torque_two_routes" in found.alarms


def test_a_speed_its_acceleration_does_not_make_is_caught():
    """Held back by a damper, the crank has forgotten its start within a sample; a slow engine has not."""
    one = released(JUKI, damping=0.5, torque=2.0, speed=10.0, turns=1.0)
    history = true_history(one, 401)
    seen = ObservedMotion(one.scene(EVERYTHING), history)
    assert closure(Inspection(seen))["drift"].values.max() < limit("closure", "tuned", "own").value
    slow = with_signal(
        history, "velocity", lambda values, time: values * (1.0 + 0.2 * np.exp(-time / 0.01))[:, None, None]
    )
    drift = closure(Inspection(ObservedMotion(one.scene(EVERYTHING), slow)))["drift"]
    assert drift.values.max() > 0.1
