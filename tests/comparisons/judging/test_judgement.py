"""Limits, and a record judged by them."""

import itertools
from dataclasses import replace

import pytest

from analytic.description.crank_motion import REGIMES
from analytic.errors import LinkproofError
from comparisons.judging.limits import (
    USER_REASON,
    Limit,
    LimitTable,
    Standard,
    deciding,
    judge,
    limit,
    read_limits,
    shipped_limits,
    shipped_standard,
    with_rows,
)
from comparisons.judging.quantities import QUANTITIES
from comparisons.judging.records import Record, Verdict
from comparisons.stress.verdict import ALARMS as INVARIANTS
from engines.contract import Origin, Setting

GIVEN = {"Mkr", "Peq"}  # by the drive of a released crank, not results


def test_the_table_is_complete():
    for quantity in (*QUANTITIES, *INVARIANTS, "joint_force:A"):
        for setting, regime in itertools.product(Setting, [*REGIMES, "a-regime-of-its-own"]):
            if quantity in GIVEN and regime not in REGIMES:
                continue
            row = limit(quantity, setting, regime)
            least_strict = 0.06 if setting is Setting.NAIVE else 0.02  # no looser than what the sources claim
            assert 0.0 < row.value <= least_strict, (quantity, setting, regime)
            assert len(row.reason.split()) > 4, (quantity, setting, regime)


def test_rows_of_a_user_go_before_the_table(tmp_path):
    path = tmp_path / "limits.toml"
    path.write_text('[[limit]]\nquantities = ["Mkr"]\nmechanisms = ["press"]\nregimes = ["own"]\nvalue = 0.5\n')
    table = read_limits(path)
    own = table.limit("Mkr", "tuned", "a-regime-of-its-own", "press")
    assert (own.value, own.reason) == (0.5, USER_REASON)
    for quantity, regime, mechanism in ("Jeq", "free", "press"), ("Mkr", "run-up", "press"), ("Mkr", "free", "other"):
        assert table.limit(quantity, "tuned", regime, mechanism) == limit(quantity, "tuned", regime)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[limit", "limits.toml:1: not valid TOML"),
        ("", "limit is missing: expected tables [[limit]]"),
        ("limits = 3", "limits.toml:1: limits: unknown key 'limits': did you mean 'limit'"),
        ("limit = [3]", "limit #1: expected tables [[limit]]"),
        ('[[limit]]\nquantities = ["Mkr"]', "limit #1.value is missing: expected a positive share"),
        ('[[limit]]\nquantities = ["Mkr"]\nvalue = nan', "limits.toml:3: limit #1.value"),
        ('[[limit]]\nquantities = "Mkr"\nvalue = 1', "limit #1.quantities: expected a list of quantities"),
        (
            '[[limit]]\nquantities = ["Mkr"]\nvalue = 1\nsettings = ["tune"]',
            "unknown setting of .*limit 1 'tune': .*tuned",
        ),
        ('[[limit]]\nquantities = ["Mrk"]\nvalue = 1', "unknown quantity of .*limit 1 'Mrk': .*Mkr"),
        ('[[limit]]\nquantities = ["Mkr"]\nvalue = 1\nreasons = ""', "limit #1.reasons: unknown key 'reasons'"),
    ],
)
def test_a_wrong_table_is_refused_in_one_sentence(tmp_path, text, words):
    (tmp_path / "limits.toml").write_text(text)
    with pytest.raises(LinkproofError, match=words.replace("[[limit]]", r"\[\[limit\]\]")):
        read_limits(tmp_path / "limits.toml")


def test_an_unreadable_file_is_refused_in_one_sentence(tmp_path):
    for path in (tmp_path, tmp_path / "none.toml"):
        with pytest.raises(
            LinkproofError, match=r"expected a TOML file of limits at '.*', got '[A-Z][a-z ]+'; check it$"
        ):
            read_limits(path)


RECORD = Record(
    mechanism="m", variant="v", regime="r", conditions="c", engine="e", engine_version="1", setting="tuned",
    quantity="Mkr", unit="N m", error_max=1.23456e-5, limit=1e-4, peak=1.0,
)  # fmt: skip

JUDGED = Record("m", "v", "run-up", "c", "e", "1", "tuned", quantity="Mkr", error_max=1e-5)
LIMIT = shipped_limits().limit("Mkr", "tuned", "run-up").value


def _loose(value: float) -> LimitTable:
    return with_rows([Limit(quantities=["Mkr"], value=value)], "limits.toml")


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
def test_a_record_is_judged_by_its_limit(change, outcome, words):
    found = judge(replace(JUDGED, **change))
    assert found.outcome == outcome
    assert words in found.detail
    assert judge(found).outcome == outcome


def test_another_standard_gives_another_verdict_of_the_same_error():
    failed = judge(replace(JUDGED, error_max=2.0 * LIMIT))
    passed = Standard(_loose(3.0 * LIMIT)).judge(failed)
    assert (passed.outcome, passed.detail, passed.limit) == (Verdict.PASSED, "", pytest.approx(3.0 * LIMIT))
    assert shipped_standard().judge(passed) == failed


def test_naive_records_decide_only_where_nothing_else_ran():
    naive = replace(JUDGED, setting="naive")
    assert list(deciding([naive, JUDGED])) == [JUDGED]
    assert list(deciding([naive])) == [naive]


def test_an_uncovered_quantity_says_what_to_add():
    with pytest.raises(LookupError, match="add one with its reason"):
        limit("colour", "tuned", "run-up")
