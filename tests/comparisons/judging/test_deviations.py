"""Deviations are relative to the reference's peak and leave out what has no single truth."""

import dataclasses
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from analytic.description.loading import load
from analytic.description.schema import EyeReference
from analytic.description.thread_path import ThreadEye, ThreadGuide, ThreadPath
from analytic.kinematics.mechanism import Mechanism
from comparisons.invariants.checks import checks
from comparisons.judging.deviations import NoSampleError, deviation, near_jumps
from comparisons.judging.quantities import QUANTITIES
from comparisons.judging.records import Verdict, blank_record
from comparisons.judging.verdicts import judge
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from engines.contract import Signal
from tests.comparisons.perfect_engine import perfect_motion


@pytest.fixture(scope="module")
def case():
    return Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up"))


@pytest.fixture(scope="module")
def motion(case):
    return perfect_motion(case.mechanism, case.motion)


def _with_torque(motion, torque):
    history = dataclasses.replace(motion.history, torque=Signal(motion.history.torque.time, torque))
    return ObservedMotion(motion.scene, history)


def test_a_thread_whose_feed_takes_a_full_turn_is_not_judged_on_a_swing():
    """The eye's lowest place is told by a full turn, which Watt's six-bar cannot make."""
    watt = load("watt-six-bar")
    guide = ThreadGuide("N", (0.0, 0.0, 0.0))
    thread = ThreadPath((guide, ThreadEye("E")), 0.0, "lengthening", EyeReference(eye="E", extreme="lowest"))
    case = Case(Mechanism(replace(watt, thread=thread)), watt.regimes[0].motion)
    with pytest.raises(NoSampleError, match="which it cannot make; give a crank angle as the reference"):
        deviation(case, QUANTITIES["thread_feed"], perfect_motion(case.mechanism, case.motion))


def test_a_known_error_is_found_where_it_is(case, motion):
    torque = motion.history.torque.values.copy()
    torque[700] += 1e-3
    found = deviation(case, QUANTITIES["Mkr"], _with_torque(motion, torque))
    assert found.error_max == pytest.approx(1e-3 / found.peak)
    assert found.worst_time == motion.history.torque.time[700]
    assert found.error_rms == pytest.approx(1e-3 / found.peak / np.sqrt(found.samples))


def _at_jump(motion, change, jump=0.6):
    torque = motion.history.torque.values.copy()
    kink = int(np.argmin(np.abs(motion.history.torque.time - jump)))
    torque[kink] = change(torque, kink)
    return _with_torque(motion, torque)


def test_samples_at_an_acceleration_jump_may_lie_between_its_two_values(case, motion):
    between = _at_jump(motion, lambda torque, kink: 0.5 * (torque[kink - 1] + torque[kink + 1]))
    found = deviation(case, QUANTITIES["Mkr"], between)
    assert found.error_max < 1e-12
    assert found.error_at_jumps < 1e-12
    assert found.left_out == 3 + 5  # a millisecond on either side, the hundredth of the shortest piece


def test_the_window_at_a_jump_is_the_regimes_and_not_the_engines(case):
    """A sample outside it is judged like any other, however long the engine's steps are."""
    coarse = perfect_motion(case.mechanism, case.motion, 141)  # steps of 5 ms
    found = deviation(case, QUANTITIES["Mkr"], _at_jump(coarse, lambda torque, kink: torque[kink], 0.6))
    assert found.left_out == 2
    late = deviation(case, QUANTITIES["Mkr"], _at_jump(coarse, lambda torque, kink: 3.0 * torque[kink], 0.605))
    assert late.error_max > 0.1


@pytest.mark.parametrize("jump", [0.0, 0.6])
def test_a_torque_three_times_too_large_at_a_jump_is_over_the_limit(case, motion, jump):
    found = deviation(case, QUANTITIES["Mkr"], _at_jump(motion, lambda torque, kink: 3.0 * torque[kink], jump))
    assert found.error_max < 1e-12
    assert found.error_at_jumps > 0.1
    record = replace(blank_record(case, "tuned"), quantity="Mkr", error_max=found.error_max)
    assert judge(record).outcome == Verdict.PASSED
    judged = judge(replace(record, error_at_jumps=found.error_at_jumps))
    assert (judged.outcome, judged.error_max) == (Verdict.OVER_LIMIT, found.error_at_jumps)


def test_at_the_start_the_torque_may_be_that_of_a_crank_at_rest(case, motion):
    still = Case(case.mechanism, CrankMotion("rest", (Segment(0.0, 1.0, (float(case.motion.angle(0.0)),)),)))
    resting = _at_jump(motion, lambda *_: float(still.at(np.zeros(1)).torque[0]), 0.0)
    assert deviation(case, QUANTITIES["Mkr"], resting).error_at_jumps < 1e-12


def test_what_is_interpolated_across_a_jump_is_not_held_against_an_engine():
    """A power from a torque and a speed that have clocks of their own."""
    abrupt = Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up", ramp_time=1e-3, hold_time=0.05))
    shifted = perfect_motion(abrupt.mechanism, abrupt.motion, 202, shift=0.5)
    found = deviation(abrupt, QUANTITIES["Peq"], shifted)
    assert found.error_max < 1e-4
    assert found.error_at_jumps < 1e-4
    assert deviation(abrupt, QUANTITIES["Mkr"], shifted).error_at_jumps < 1e-12


def test_a_smooth_ramp_leaves_nothing_out(case):
    smooth = Case(case.mechanism, crank_motion("run-up-quintic"))
    found = deviation(smooth, QUANTITIES["Mkr"], perfect_motion(smooth.mechanism, smooth.motion, 701))
    assert found.left_out == 0


def test_reduced_inertia_is_not_asked_of_a_crank_at_rest(case, motion):
    found = deviation(case, QUANTITIES["Jeq"], motion)
    assert 0 < found.left_out < 0.1 * found.samples


def test_a_sample_missing_on_the_jump_does_not_widen_the_gap():
    time = np.delete(np.arange(11.0), 5)
    assert time[near_jumps(time, (5.0,))].tolist() == [3.0, 4.0, 6.0, 7.0]


def test_each_side_of_a_jump_has_its_own_step():
    time = np.concatenate([np.arange(0.0, 5.0), np.arange(5.0, 7.0, 0.5)])
    assert time[near_jumps(time, (5.0,))].tolist() == [3.0, 4.0, 5.0, 5.5, 6.0]


def test_jumps_are_two_steps_wide():
    time = np.arange(11.0)
    assert np.flatnonzero(near_jumps(time, (5.0,))).tolist() == [3, 4, 5, 6, 7]


def test_what_is_zero_for_want_of_any_mass_is_not_judged(case, motion):
    links = {name: dataclasses.replace(link, mass=0.0) for name, link in case.mechanism.linkage.links.items()}
    for name, link in links.items():
        links[name] = dataclasses.replace(link, inertia=None if link.inertia is None else 0.0)
    bare = Case(Mechanism(dataclasses.replace(case.mechanism.linkage, links=links)), case.motion)
    still = perfect_motion(bare.mechanism, bare.motion)
    for name in ("Jeq", "Teq", "Mkr", "Peq"):
        with pytest.raises(NoSampleError, match="is zero throughout, as no link has a mass"):
            deviation(bare, QUANTITIES[name], still)
    assert deviation(bare, QUANTITIES["S"], still).error_max < 1e-9
    records = {record.quantity: record for record in checks(bare, still, blank_record(bare, "tuned"))}
    undefined = {name for name, record in records.items() if record.outcome == Verdict.UNDEFINED}
    assert undefined == {"energy_balance", "torque_two_routes", "force_balance"}
