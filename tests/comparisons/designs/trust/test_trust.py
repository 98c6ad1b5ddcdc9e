"""What is said of engines over a sample: a flaw is found where it is put, and what chance does is told from a rule."""

import math

import numpy as np
import pytest

from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.designs.parameters import parameter
from comparisons.designs.trust.sample import hypercube, sample
from comparisons.designs.trust.trust import TRANSMISSION, DesignStanding, telling, trust
from comparisons.judging.records import Verdict
from reports.command_line.motion_choice import MotionChoice, motions
from tests.comparisons.designs.engines_with_flaws import SHORT, SHORTEST
from tests.comparisons.designs.samples import NAMES, RIMOLDI, made_up, record
from tests.comparisons.faults import announce

MOTION = motions(MotionChoice(speed=300.0, ramp_time=0.1, hold_time=0.1))


def judged(values, fails):
    found = made_up(values, [math.nan] * len(values))
    records = [
        record(one.number, Verdict.OVER_LIMIT if bad else Verdict.PASSED, 2e-3 if bad else 1e-4)
        for one, bad in zip(found.designs, fails, strict=True)
    ]
    (engine,) = trust(found, records).engines
    return engine


def expected_standing(design):
    if design.values[0] < SHORTEST * 1e3:
        return DesignStanding.NO_RESULT
    return DesignStanding.OVER if design.values[0] < SHORT * 1e3 else DesignStanding.WITHIN


def test_an_engine_with_a_flaw_is_found_to_give_way_where_it_is(tmp_path, monkeypatch):
    announce(tmp_path, "flawed", {"short-sighted": "tests.comparisons.designs.engines_with_flaws:ShortSighted"})
    monkeypatch.syspath_prepend(str(tmp_path))
    parameters = [parameter(RIMOLDI, name) for name in NAMES]
    drawn = sample(RIMOLDI, parameters, hypercube(np.array([[166.0, 178.0], [0.1, 0.3]]), 0), 16, MOTION)
    linkages = tuple(one.linkage for one in drawn.designs)
    request = CampaignRequest(linkages, MOTION, "300 rpm", ("direct", "short-sighted"))
    records = [one for result in compare(request) for one in (*result.records, *result.invariants)]
    right, wrong = trust(drawn, records).engines
    assert (right.engine, right.count(DesignStanding.WITHIN), right.rule, right.safe) == ("direct", 17, None, None)
    assert (right.bound, wrong.bound) == (3.0 / 16, None)
    expected = {one.number: expected_standing(one) for one in drawn.designs}
    assert {run.design: run.standing for run in wrong.runs} == expected
    assert set(expected.values()) == {DesignStanding.NO_RESULT, DesignStanding.OVER, DesignStanding.WITHIN}
    failing = sum(standing is not DesignStanding.WITHIN for standing in expected.values())
    rule, (side, count) = wrong.rule, wrong.safe
    assert (rule.side.feature, rule.side.unit, rule.side.below) == ("rod.B.x", "mm", True)
    lengths = [one.values[0] for one in drawn.designs]
    longest = max(one for one in lengths if one < SHORT * 1e3)
    assert longest < rule.side.value < min(one for one in lengths if one > longest)
    assert (rule.failing, rule.others) == ((failing, failing), (0, 17 - failing))
    assert rule.tells
    assert (side.feature, side.below, count) == ("rod.B.x", False, 17 - failing)
    assert wrong.worst.standing is DesignStanding.OVER
    assert wrong.worst.share > 1.0


def test_the_best_rule_is_that_of_all_thresholds():
    """Against a loop over every parameter, threshold and side."""
    random = np.random.default_rng(7)
    for _ in range(20):
        values = np.column_stack([random.integers(0, 6, 12), random.normal(size=12)]).astype(float)
        fails = random.random(12) < 0.2 + 0.6 * (values[:, 1] > 0.3)
        if fails.all() or not fails.any():
            continue
        rule = judged(values, fails).rule
        best = max(
            abs(np.mean(side[fails]) - np.mean(side[~fails]))
            for column in values.T
            for cut in column
            for side in (column < cut, column > cut)
        )
        (failing, of), (also, others) = rule.failing, rule.others
        assert (of, others) == (fails.sum(), (~fails).sum())
        assert failing / of - also / others == pytest.approx(best)
        assert max(telling(column, fails) for column in values.T) == pytest.approx(best)


def test_failures_at_random_are_not_explained():
    """Of many samples without any rule about one in twenty is told one: that is the level of the test."""
    random = np.random.default_rng(3)
    samples = [(random.random((16, 2)), random.permutation(16) < 5) for _ in range(60)]
    told = [judged(values, fails).rule.tells for values, fails in samples]
    assert sum(told) < 10
    clear = random.random((16, 2))
    assert judged(clear, clear[:, 0] < np.sort(clear[:, 0])[5]).rule.tells


def test_transmission_angles_tell_where_they_do():
    found = made_up(np.random.default_rng(1).random((12, 1)), np.linspace(5.0, 60.0, 12).tolist())
    records = [record(n, Verdict.OVER_LIMIT if n <= 4 else Verdict.PASSED, 1e-3) for n in range(1, 13)]
    (one,) = trust(found, records).engines
    assert (one.rule.side.feature, one.rule.side.below, one.rule.side.value) == (TRANSMISSION, True, 22.5)
    assert (one.safe[0].feature, one.safe[0].value, one.safe[1]) == (TRANSMISSION, 25.0, 8)


def test_what_was_not_judged_has_not_passed():
    lost = (Verdict.UNSUPPORTED, Verdict.SUITE_ERROR, Verdict.CRASHED, Verdict.TIMED_OUT)
    records = [record(1, Verdict.PASSED, 1e-4), record(6, Verdict.PASSED, 1e-4)]
    records += [record(number, outcome) for number, outcome in enumerate(lost, start=2)]
    (one,) = trust(made_up(np.linspace(0.0, 1.0, 6)[:, None]), records).engines
    assert [one.count(standing) for standing in DesignStanding] == [2, 0, 2, 2]
    assert one.bound is None
    assert one.safe[1] == 1  # one of the two ends: what is not judged ends a range as what fails does


def test_a_design_stands_as_its_worst_record_does():
    records = [
        record(1, Verdict.PASSED, 5e-4),
        record(1, Verdict.OVER_LIMIT, 3e-3, quantity="S"),
        record(1, Verdict.NOT_PROVIDED, quantity="joint_force:A"),
        record(1, Verdict.COMPUTED, 5e-1, quantity="Jeq"),
    ]
    found = trust(made_up(np.zeros((1, 1))), records)
    (one,) = found.engines
    (run,) = one.runs
    assert (run.standing, run.quantity, run.share) == (DesignStanding.OVER, "S", pytest.approx(3.0))
    assert (one.rule, one.bound) == (None, None)
    assert found.told["runs"][0]["standing"] == "over a limit"
