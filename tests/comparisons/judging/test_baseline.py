"""A baseline is recorded, written, read and applied; two files of one name have an entry each."""

import dataclasses
import json

import pytest

from analytic.errors import LinkproofError
from comparisons.judging.baseline import Baseline, Place, read_baseline, regime_key
from comparisons.judging.records import Record

RECORD = Record(
    mechanism="m", variant="v", regime="r", conditions="c", engine="e", engine_version="1", setting="tuned",
    quantity="Mkr", unit="N m", error_max=1.23456e-5, limit=1e-4, peak=1.0,
)  # fmt: skip
PLACES = {"m": Place("m.toml", "0a"), "b-press": Place("b/press.toml", "0b"), "c-press": Place("c/press.toml", "0c")}
WORDS = {"e": {"Mkr": "much"}}
EMPTY = Baseline({}, PLACES)


def _with(*records, figures=()):
    return EMPTY.recorded(records, dict(figures))


def test_nothing_is_held_before_the_first_recording():
    assert EMPTY.allowed(RECORD) is None
    assert Baseline().allowed(RECORD) is None


def test_recording_allows_three_times_the_value_and_keeps_other_records():
    other = dataclasses.replace(RECORD, engine="other")
    found = _with(RECORD, other).recorded([dataclasses.replace(RECORD, error_max=2e-5)], {})
    assert found.allowed(RECORD) == pytest.approx(6e-5)
    assert found.allowed(other) == pytest.approx(3 * 1.235e-5)


def test_what_is_not_the_same_run_has_a_baseline_of_its_own():
    found = _with(RECORD)
    for change in ({"conditions": "2000 rpm"}, {"variant": "w"}, {"regime": "s"}, {"setting": "best"}):
        assert found.allowed(dataclasses.replace(RECORD, **change)) is None


def test_two_files_of_one_name_stand_side_by_side():
    first, second = (dataclasses.replace(RECORD, mechanism=name) for name in ("b-press", "c-press"))
    found = _with(first, dataclasses.replace(second, error_max=3e-5))
    assert found.allowed(first) == pytest.approx(3 * 1.235e-5)
    assert found.allowed(second) == pytest.approx(9e-5)


def test_round_off_is_never_judged_by_growth():
    assert _with(dataclasses.replace(RECORD, error_max=1e-15)).allowed(RECORD) == pytest.approx(1e-7)


def test_failed_runs_are_not_recorded():
    assert _with(dataclasses.replace(RECORD, error_max=None)).allowed(RECORD) is None


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
    records = [RECORD, dataclasses.replace(RECORD, engine="a"), dataclasses.replace(RECORD, quantity="Jeq")]
    _with(*records).write(tmp_path / "one.json")
    _with(*reversed(records)).write(tmp_path / "two.json")
    assert (tmp_path / "one.json").read_bytes() == (tmp_path / "two.json").read_bytes()


@pytest.mark.parametrize(
    "text",
    ["{", "[1]", "{}", "\ufeff{}"]
    + [json.dumps({"format": 1, "linkages": entry}) for entry in ([], {"a": 1}, {"a": {"checksum": "0"}})]
    + [
        json.dumps(
            {
                "format": 1,
                "linkages": {"a": {"checksum": "0", "variants": {"v": {"r": {"errors": WORDS}}}}},
            }
        )
    ],
)
def test_a_damaged_baseline_is_said_in_one_sentence(tmp_path, text):
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
