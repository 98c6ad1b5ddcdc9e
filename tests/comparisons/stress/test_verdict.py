"""Every verdict has its run; an engine that lies is caught, and a cell says why."""

from functools import cache

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.judging.records import Verdict
from comparisons.reference.case import Case
from comparisons.stress import verdict
from comparisons.stress.cell_result import StressVerdict, blank_result
from comparisons.stress.scenes import Conditions
from comparisons.stress.scenes import case as stress_case
from comparisons.stress.verdict import judged
from engines.contract import Outcome, Run
from tests.comparisons.true_motions import CELL, EVERYTHING, judgement, true_history, with_signal


@cache
def case():
    return Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up-quintic"))


def scaled(name, factor):
    return with_signal(true_history(case(), 601), name, lambda values, _: factor * values)


def test_the_truth_is_within_every_limit():
    found = judgement(case(), true_history(case(), 601))
    assert (found.verdict, found.reason, found.wrong, found.alarms) == (StressVerdict.WITHIN, "", "", ())
    assert found.nearest.error_max < found.nearest.limit
    assert found.worst_check.error_max < found.worst_check.limit


def test_an_engine_that_lies_is_caught_with_what_gave_it_away():
    found = judgement(case(), scaled("torque", 1.5))
    assert found.verdict is StressVerdict.CAUGHT
    assert found.wrong.startswith("torque off by 0.5 of its peak")
    assert "Flagged: " in found.reason
    assert "the torque is 0.33 of its peak away from what the motion takes at " in found.reason
    assert {"torque_two_routes", "energy_balance"} <= set(found.alarms)


def test_an_open_joint_is_named():
    names = [body.name for body in case().scene(EVERYTHING).bodies]

    def opened(values, _):
        values[300, names.index("needle_bar"), 1] += 0.002
        return values

    found = judgement(case(), with_signal(true_history(case(), 601), "position", opened))
    assert found.verdict is StressVerdict.CAUGHT
    assert "joint D is open by 0.13 of the shortest link at 0.35 s" in found.reason


def test_a_deviation_over_its_limit_that_is_no_wrong_motion_is_over_limit():
    found = judgement(case(), scaled("torque", 1.001))
    assert found.verdict is StressVerdict.OVER
    assert found.nearest.quantity in ("Mkr", "Peq")
    assert found.reason == f"{found.nearest.quantity} off by 0.001 of its peak"


def test_the_limits_are_those_of_the_setting():
    history = scaled("torque", 1.00003)
    assert judgement(case(), history, "tuned").verdict is StressVerdict.WITHIN
    assert judgement(case(), history, "best").verdict is StressVerdict.OVER


def test_what_no_invariant_sees_is_missed(monkeypatch):
    true_checks = verdict.checks

    def blind(*arguments):
        return tuple(
            verdict.replace(record, outcome=Verdict.PASSED.value, error_max=0.0) for record in true_checks(*arguments)
        )

    monkeypatch.setattr(verdict, "checks", blind)
    found = judgement(case(), scaled("torque", 1.5))
    assert found.verdict is StressVerdict.MISSED
    assert found.reason.endswith("No check flagged it")


def test_an_invariant_that_fails_the_truth_is_an_alarm(monkeypatch):
    true_checks = verdict.checks

    def nervous(*arguments):
        return tuple(
            verdict.replace(record, outcome=Verdict.OVER_LIMIT.value, error_max=1.0)
            if record.quantity == "energy_balance"
            else record
            for record in true_checks(*arguments)
        )

    monkeypatch.setattr(verdict, "checks", nervous)
    found = judgement(case(), true_history(case(), 601))
    assert (found.verdict, found.alarms) == (StressVerdict.ALARM, ("energy_balance",))
    assert found.reason.startswith("right, yet 1 of the energy scale has no source")


def test_a_joint_over_its_limit_is_a_deviation_and_no_false_alarm():
    """Open by 1.3e-4 of the shortest link, and every quantity within its limit."""
    names = [body.name for body in case().scene(EVERYTHING).bodies]

    def opened(values, _):
        values[:, names.index("coupler"), 0] += 2e-6
        return values

    found = judgement(case(), with_signal(true_history(case(), 601), "position", opened))
    assert (found.verdict, found.alarms) == (StressVerdict.OVER, ("joint_gap",))
    assert found.reason.startswith("joint ")


@pytest.mark.parametrize("outcome", [Outcome.DIVERGED, Outcome.UNSUPPORTED, Outcome.UNAVAILABLE])
def test_what_gave_no_motion_keeps_its_reason(outcome):
    found = judged(blank_result(CELL, "m"), case(), case().scene(EVERYTHING), Run(outcome, "because"), "tuned")
    assert (found.verdict, found.reason) == (StressVerdict(outcome.value), "because")
    assert found.worst_check is None


def test_numbers_beyond_all_bounds_are_wrong_and_still_numbers():
    found = judgement(case(), with_signal(true_history(case(), 601), "velocity", lambda values, _: 1e200 * values))
    assert found.verdict is StressVerdict.CAUGHT
    assert np.isfinite(found.nearest.error_max)
    assert np.isfinite(found.worst_check.error_max)


def test_six_true_samples_are_caught_for_what_lies_between_them():
    found = judgement(case(), true_history(case(), 6))
    assert found.verdict is StressVerdict.CAUGHT
    assert found.wrong == "0.8 of the duration has no samples"
    assert found.nearest.error_max < found.nearest.limit
    assert set(found.alarms) == {"closure", "crank_phase", "torque_two_routes", "force_balance"}


def test_a_motion_with_a_regime_of_its_own_is_held_to_the_limits_of_the_like():
    turned = stress_case(Conditions("juki-mf7923d", motion="reversal", hold_turns=0.5))
    assert judgement(turned, true_history(turned, 901), "best").verdict is StressVerdict.WITHIN
