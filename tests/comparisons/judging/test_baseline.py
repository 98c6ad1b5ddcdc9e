"""The baseline is written, read and applied."""

import dataclasses

import pytest

from analytic.errors import LinkproofError
from comparisons.judging import baseline
from comparisons.judging.records import Record

RECORD = Record(
    mechanism="m", variant="v", regime="r", conditions="c", engine="e", engine_version="1", setting="tuned",
    quantity="Mkr", unit="N m", error_max=1.23456e-5, error_rms=1e-6, limit=1e-4, baseline=None, outcome="passed",
    detail="", peak=1.0, worst_time=0.1, samples=10, left_out=0, seconds=1.0, setup_seconds=0.1, steps=100,
)  # fmt: skip


@pytest.fixture
def table(tmp_path, monkeypatch):
    monkeypatch.setattr(baseline, "TABLE", tmp_path / "baseline.json")
    baseline.recorded.cache_clear()
    yield
    baseline.recorded.cache_clear()


@pytest.mark.usefixtures("table")
def test_nothing_is_held_before_the_first_recording():
    assert baseline.allowed(RECORD) is None


@pytest.mark.usefixtures("table")
def test_recording_allows_three_times_the_value_and_keeps_other_records():
    assert baseline.record_all([RECORD, dataclasses.replace(RECORD, engine="other")]) == 2
    assert baseline.allowed(RECORD) == pytest.approx(3 * 1.235e-5)
    baseline.record_all([dataclasses.replace(RECORD, error_max=2e-5)])
    assert baseline.allowed(RECORD) == pytest.approx(6e-5)
    assert baseline.allowed(dataclasses.replace(RECORD, engine="other")) == pytest.approx(3 * 1.235e-5)


@pytest.mark.usefixtures("table")
def test_round_off_is_never_judged_by_growth():
    baseline.record_all([dataclasses.replace(RECORD, error_max=1e-15)])
    assert baseline.allowed(RECORD) == pytest.approx(1e-7)


@pytest.mark.usefixtures("table")
def test_other_conditions_have_other_baselines():
    baseline.record_all([RECORD])
    assert baseline.allowed(dataclasses.replace(RECORD, conditions="2000 rpm")) is None


@pytest.mark.usefixtures("table")
@pytest.mark.parametrize("text", ["{", "[1]", '{"a": 1}', '{"a": {"Mkr": "much"}}', "\ufeff{}"])
def test_a_damaged_baseline_is_said_in_one_sentence(text):
    baseline.TABLE.write_text(text, encoding="utf-8")
    for use in (lambda: baseline.allowed(RECORD), lambda: baseline.record_all([RECORD])):
        with pytest.raises(LinkproofError, match=r"expected recorded deviations in .*, got a damaged file"):
            use()


def test_failed_runs_are_not_recorded(table):
    assert baseline.record_all([dataclasses.replace(RECORD, error_max=None)]) == 0
