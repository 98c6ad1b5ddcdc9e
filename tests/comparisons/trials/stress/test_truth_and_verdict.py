"""The faults of a motion, and the verdict that follows."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime
from comparisons.trials.campaign import campaign
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.stress.cells import Conditions
from comparisons.trials.stress.cells import case as stress_case
from comparisons.trials.stress.verdict import WRONG, StressVerdict, wrong_signals
from engines.contract import Signal
from tests.comparisons.true_motions import EVERYTHING, alarms, cut, judgement, true_history, with_signal


@cache
def case(name="juki-mf7923d", regime="run-up-quintic"):
    return Case(Mechanism(load(name)), crank_motion(regime))


def found(one, history):
    return wrong_signals(one, ObservedMotion(one.scene(EVERYTHING), history))


@pytest.mark.parametrize(("name", "regime"), [("juki-mf7923d", "run-up"), ("slotted-takeup", "constant-speed")])
def test_nothing_is_wrong_of_the_truth(name, regime):
    one = case(name, regime)
    assert found(one, true_history(one, 301)) == []


@pytest.mark.parametrize("share", [0.5, 2.0])
@pytest.mark.parametrize("own", [False, True])
def test_a_joint_force_that_is_off_is_wrong(share, own):
    linkage = load("slotted-takeup")
    one = case_of_file_regime(Mechanism(linkage), linkage.regimes[0]) if own else case("slotted-takeup")
    history = true_history(one, 3001 if own else 301)
    joint, force = next(iter(history.joint_force.items()))
    values = force.values.copy()
    values[150] += share * WRONG * np.max(np.hypot(*values.T)) * np.array([0.6, 0.8])
    changed = replace(history, joint_force={**history.joint_force, joint: Signal(force.time, values)})
    assert [words.partition(" off by")[0] for words in found(one, changed)] == [f"force in joint '{joint}'"] * (
        share > 1.0
    )


@pytest.mark.parametrize("share", [0.5, 2.0])
@pytest.mark.parametrize(("name", "words"), [("position", "place"), ("velocity", "velocity")])
def test_one_body_off_is_named_beyond_the_limit_alone(name, words, share):
    one = case()
    history = true_history(one, 301)
    names = [body.name for body in one.scene(EVERYTHING).bodies]

    def change(values, _):
        arm = 0.0416  # the coupler's to its farther pin, m
        peak = arm if name == "position" else np.max(np.hypot(*values[:, :, :2].T))
        values[150, names.index("needle_bar"), 1] += share * WRONG * peak
        return values

    said = found(one, with_signal(history, name, change))
    assert bool(said) is (share > 1.0)
    assert all(sentence.startswith(f"{words} of body 'needle_bar' off by 0.02 of the") for sentence in said)


def test_torque_at_an_acceleration_jump_is_not_judged():
    one = case(regime="run-up")
    history = true_history(one, 701)
    at = int(np.argmin(np.abs(history.torque.time - 0.6)))

    def spike(values, _):
        values[at - 1 : at + 2] *= 10.0
        return values

    assert found(one, with_signal(history, "torque", spike)) == []


def test_what_is_missing_is_wrong_too():
    one = case(regime="constant-speed")
    history = true_history(one, 301)
    assert any("no samples" in words for words in found(one, cut(history, lambda t: np.abs(t - 0.35) > 0.05)))
    assert found(one, cut(history, lambda t: (t > 0.0) & (t < t[-1]))) == []


def test_the_angle_of_a_mass_at_a_pin_means_nothing():
    one = case("slotted-takeup")
    names = [body.name for body in one.scene(EVERYTHING).bodies]
    history = true_history(one, 301)

    def turned(values, _):
        values[:, names.index("slot_slider"), 2] = 17.0
        return values

    assert found(one, with_signal(history, "position", turned)) == []


def scaled(name, factor):
    return with_signal(true_history(case(), 601), name, lambda values, _: factor * values)


def test_the_truth_is_within_every_limit():
    found = judgement(case(), true_history(case(), 601))
    assert (found.verdict, found.reason, found.wrong, alarms(found)) == (StressVerdict.WITHIN, "", "", ())
    assert found.errors[0].error_max < found.errors[0].limit
    assert found.invariants[0].error_max < found.invariants[0].limit


def test_a_wrong_motion_is_caught_with_the_checks_that_flag_it():
    found = judgement(case(), scaled("torque", 1.5))
    assert found.verdict is StressVerdict.CAUGHT
    assert found.wrong.startswith("drive torque off by 0.5 of the peak")
    assert "Flagged: " in found.reason
    assert "the torque is 0.33 of its peak away from what the motion takes at " in found.reason
    assert {"torque_two_routes", "energy_balance"} <= set(alarms(found))


def test_a_deviation_over_its_limit_that_is_no_wrong_motion_is_over_limit():
    found = judgement(case(), scaled("torque", 1.001))
    assert found.verdict is StressVerdict.OVER
    assert found.errors[0].quantity in ("Mkr", "Peq")
    assert found.reason == f"{found.errors[0].quantity} off by 0.001 of its peak"


def test_what_no_invariant_sees_is_missed(monkeypatch):
    true_checks = campaign.checks

    def blind(*arguments):
        return tuple(check._replace(outcome="passed", error_max=0.0) for check in true_checks(*arguments))

    monkeypatch.setattr(campaign, "checks", blind)
    found = judgement(case(), scaled("torque", 1.5))
    assert found.verdict is StressVerdict.MISSED
    assert found.reason.endswith("No check flagged it")


def test_an_invariant_that_fails_the_truth_is_an_alarm(monkeypatch):
    true_checks, failed = campaign.checks, {"outcome": "over-limit", "error_max": 1.0}

    def nervous(*arguments):
        return tuple(
            check._replace(**failed) if check.quantity == "energy_balance" else check
            for check in true_checks(*arguments)
        )

    monkeypatch.setattr(campaign, "checks", nervous)
    found = judgement(case(), true_history(case(), 601))
    assert (found.verdict, alarms(found)) == (StressVerdict.ALARM, ("energy_balance",))
    assert found.reason.startswith("right, yet 1 of the energy scale has no source")


def test_a_joint_over_its_limit_is_a_deviation_and_no_false_alarm():
    """Open by 1.3e-4 of the shortest link, and every quantity within its limit."""
    names = [body.name for body in case().scene(EVERYTHING).bodies]

    def opened(values, _):
        values[:, names.index("coupler"), 0] += 2e-6
        return values

    found = judgement(case(), with_signal(true_history(case(), 601), "position", opened))
    assert (found.verdict, alarms(found)) == (StressVerdict.OVER, ("joint_gap",))
    assert found.reason.startswith("joint ")


def test_a_reversal_has_the_limits_of_similar_motions():
    turned = stress_case(Conditions("juki-mf7923d", motion="reversal", hold_turns=0.5))
    assert judgement(turned, true_history(turned, 901), "best").verdict is StressVerdict.WITHIN


def test_the_limits_are_those_of_the_setting():
    history = scaled("torque", 1.00003)
    assert judgement(case(), history, "tuned").verdict is StressVerdict.WITHIN
    assert judgement(case(), history, "best").verdict is StressVerdict.OVER


def test_numbers_beyond_all_bounds_are_wrong_and_still_numbers():
    found = judgement(case(), with_signal(true_history(case(), 601), "velocity", lambda values, _: 1e200 * values))
    assert found.verdict is StressVerdict.CAUGHT
    assert np.isfinite(found.errors[0].error_max)
    assert np.isfinite(found.invariants[0].error_max)
