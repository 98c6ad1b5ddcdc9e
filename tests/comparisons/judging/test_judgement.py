"""Limits, the baseline, and a record judged by both."""

import itertools
import json
from dataclasses import replace

import pytest

from analytic.description.crank_motion import REGIMES
from analytic.errors import LinkproofError
from comparisons.judging.baseline import Baseline, Place, read_baseline, regime_key
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
PLACES = {"m": Place("m.toml", "0a"), "b-press": Place("b/press.toml", "0b"), "c-press": Place("c/press.toml", "0c")}
WORDS = {"e": {"Mkr": "much"}}
EMPTY = Baseline({}, PLACES)


def _with(*records, figures=()):
    return EMPTY.recorded(records, dict(figures))


def test_recording_allows_three_times_the_value_and_keeps_other_records():
    other = replace(RECORD, engine="other")
    found = _with(RECORD, other).recorded([replace(RECORD, error_max=2e-5)], {})
    assert found.allowed(RECORD) == pytest.approx(6e-5)
    assert found.allowed(other) == pytest.approx(3 * 1.235e-5)


def test_what_is_not_the_same_run_has_a_baseline_of_its_own():
    found = _with(RECORD)
    for change in ({"conditions": "2000 rpm"}, {"variant": "w"}, {"regime": "s"}, {"setting": "best"}):
        assert found.allowed(replace(RECORD, **change)) is None


def test_round_off_is_never_judged_by_growth():
    assert _with(replace(RECORD, error_max=1e-15)).allowed(RECORD) == pytest.approx(1e-7)


def test_a_file_holds_what_was_recorded_and_says_what_changed_since(tmp_path):
    key = "m", "v", regime_key("r", "c")
    _with(RECORD, figures={key: {"Mkr.peak": 0.123456789012}}.items()).write(tmp_path / "b.json")
    back = read_baseline(tmp_path / "b.json", PLACES)
    assert back.allowed(RECORD) == pytest.approx(3 * 1.235e-5)
    assert back.figures(RECORD) == {"Mkr.peak": 0.123456789}
    assert back.changed() == ()
    assert read_baseline(tmp_path / "b.json", {"m": Place("m.toml", "ff")}).changed() == ("m.toml",)
    assert read_baseline(tmp_path / "none.json", PLACES).allowed(RECORD) is None


def test_a_file_is_the_same_for_the_same_records_in_any_order(tmp_path):
    records = [RECORD, replace(RECORD, engine="a"), replace(RECORD, quantity="Jeq")]
    _with(*records).write(tmp_path / "one.json")
    _with(*reversed(records)).write(tmp_path / "two.json")
    assert (tmp_path / "one.json").read_bytes() == (tmp_path / "two.json").read_bytes()


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "\ufeff{}",
        json.dumps({"format": 1, "linkages": {"a": {"checksum": "0"}}}),
        json.dumps({"format": 1, "linkages": {"a": {"checksum": "0", "variants": {"v": {"r": {"errors": WORDS}}}}}}),
    ],
)
def test_a_damaged_baseline_is_refused_in_one_sentence(tmp_path, text):
    (tmp_path / "b.json").write_text(text, encoding="utf-8")
    with pytest.raises(LinkproofError, match=r"expected a baseline of linkproof in .*, got a damaged file"):
        read_baseline(tmp_path / "b.json", PLACES)


def test_a_baseline_of_another_version_or_none_is_not_called_damaged(tmp_path):
    (tmp_path / "b.json").write_text('{"format": 9, "linkages": {}}', encoding="utf-8")
    with pytest.raises(LinkproofError, match=r"expected a baseline of format 1 in .*, got format 9: read it with"):
        read_baseline(tmp_path / "b.json", PLACES)
    with pytest.raises(
        LinkproofError, match=r"expected a baseline of linkproof in .*, got 'Is a directory'; check it$"
    ):
        read_baseline(tmp_path, PLACES)


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


def test_growth_over_the_baseline_fails_within_the_limit():
    empty = Baseline({}, {"m": Place("m.toml", "0")})
    standard = Standard(shipped_limits(), empty.recorded([replace(JUDGED, error_max=1e-6)], {}))
    assert standard.judge(replace(JUDGED, error_max=2.9e-6)).outcome == Verdict.PASSED
    grown = standard.judge(replace(JUDGED, error_max=3.1e-6))
    assert (grown.outcome, grown.baseline) == (Verdict.OVER_LIMIT, pytest.approx(3e-6))


def test_naive_records_decide_only_where_nothing_else_ran():
    naive = replace(JUDGED, setting="naive")
    assert list(deciding([naive, JUDGED])) == [JUDGED]
    assert list(deciding([naive])) == [naive]


def test_an_uncovered_quantity_says_what_to_add():
    with pytest.raises(LookupError, match="add one with its reason"):
        limit("colour", "tuned", "run-up")
