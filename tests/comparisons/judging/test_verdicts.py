"""A record is judged by its limit, by what was recorded before and at jumps; judging again changes nothing else."""

from dataclasses import replace

import pytest

from comparisons.judging.baseline import Baseline, Place
from comparisons.judging.limits import LimitTable, shipped_limits, with_rows
from comparisons.judging.records import Record, Verdict
from comparisons.judging.verdicts import Standard, deciding, judge, shipped_standard
from engines.contract import Origin

RECORD = Record("m", "v", "run-up", "c", "e", "1", "tuned", quantity="Mkr", error_max=1e-5)
LIMIT = shipped_limits().limit("Mkr", "tuned", "run-up").value


def _loose(value: float) -> LimitTable:
    return with_rows([{"quantities": ["Mkr"], "value": value}], "limits.toml")


@pytest.mark.parametrize(
    ("change", "outcome", "words"),
    [
        ({}, Verdict.PASSED, ""),
        ({"error_max": 1.01 * LIMIT}, Verdict.OVER_LIMIT, "is over its limit"),
        ({"error_max": float("nan")}, Verdict.OVER_LIMIT, "is over its limit"),
        ({"error_at_jumps": 1.01 * LIMIT}, Verdict.OVER_LIMIT, "at an acceleration jump"),
        ({"origin": Origin.COMPUTED}, Verdict.COMPUTED, "computed by the adapter"),
        ({"outcome": Verdict.DIVERGED, "error_max": None, "detail": "why"}, Verdict.DIVERGED, "why"),
        ({"outcome": Verdict.UNDEFINED, "detail": "why"}, Verdict.UNDEFINED, "why"),
    ],
)
def test_a_record_is_held_against_its_limit(change, outcome, words):
    found = judge(replace(RECORD, **change))
    assert found.outcome == outcome
    assert words in found.detail
    assert judge(found).outcome == outcome


def test_another_standard_gives_another_verdict_of_the_same_error():
    failed = judge(replace(RECORD, error_max=2.0 * LIMIT))
    passed = Standard(_loose(3.0 * LIMIT)).judge(failed)
    assert (passed.outcome, passed.detail, passed.limit) == (Verdict.PASSED, "", pytest.approx(3.0 * LIMIT))
    assert shipped_standard().judge(passed) == failed


def test_growth_over_the_baseline_fails_within_the_limit():
    empty = Baseline({}, {"m": Place("m.toml", "0")})
    standard = Standard(shipped_limits(), empty.recorded([replace(RECORD, error_max=1e-6)], {}))
    assert standard.judge(replace(RECORD, error_max=2.9e-6)).outcome == Verdict.PASSED
    grown = standard.judge(replace(RECORD, error_max=3.1e-6))
    assert (grown.outcome, grown.baseline) == (Verdict.OVER_LIMIT, pytest.approx(3e-6))


def test_naive_records_decide_only_where_nothing_else_ran():
    naive = replace(RECORD, setting="naive")
    assert list(deciding([naive, RECORD])) == [RECORD]
    assert list(deciding([naive])) == [naive]
