"""Records and their file: complete, without NaN, the same when read back."""

import json
import re

import pytest

from analytic.errors import LinkproofError
from comparisons.work_precision import records as bench_records
from comparisons.work_precision.records import FORMAT, Bench, by_quantity, load, rows, save
from tests.comparisons.bench_rows import points, row, setting_row

KEYS = {
    "mechanism", "regime", "engine", "setting", "step", "errors", "seconds_min", "seconds_median", "steps", "outcome",
}  # fmt: skip


def _document(records):
    noise = {"work": "w", "samples": [1e-3, 1.2e-3]}
    extent = {"budget": 1.0, "repeats": 5, "patience": 0.6}
    told = {"command": "bench", "conditions": "", "environment": {}, "first_use": [], "mechanisms": [], "methods": []}
    own = {"noise": noise, "extent": extent, "costs": [], "quantities": ["Mkr"], "records": rows(points(records))}
    return {"format": FORMAT, **told, **own}


def test_a_point_has_the_keys_that_readers_of_the_file_use():
    (point,) = rows(points([row(), row(quantity="Jeq")]))
    assert set(point) >= KEYS
    assert set(point["errors"]) == {"Mkr", "Jeq"}
    assert set(point["errors"]["Jeq"]) == {"unit", "error_max", "error_rms", "peak", "order", "on_front"}


def test_what_is_saved_is_what_is_loaded(tmp_path):
    records = [row(), setting_row("best", None, None, outcome="crashed", repeats=(), detail="died by signal 6")]
    save(tmp_path / bench_records.FILE, _document(records))
    found = load(tmp_path)
    assert found.records == tuple(records)
    assert found.noise.samples == (1e-3, 1.2e-3)
    assert load(tmp_path / bench_records.FILE).records == tuple(records)


def test_the_file_is_json_with_a_record_to_a_line(tmp_path):
    text = bench_records.text(_document([row(), row(step=1.0)]))
    assert json.loads(text)["records"][1]["step"] == 1.0
    assert sum(line.startswith('{"mechanism"') for line in text.splitlines()) == 2
    with pytest.raises(ValueError, match="not JSON compliant"):
        bench_records.text(_document([row(error_max=float("nan"))]))


@pytest.mark.parametrize(
    "content", ["", "{}", '{"format": 3}', '{"format": 3, "quantities": [], "records": [{}]}', "[1]"]
)
def test_a_file_that_is_no_benchmark_is_refused(tmp_path, content):
    (tmp_path / bench_records.FILE).write_text(content)
    with pytest.raises(LinkproofError, match="is no benchmark"):
        load(tmp_path)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("records", 0, "setting"), None),
        (("records", 0, "errors", "Mkr", "error_max"), "1"),
        (("noise", "samples", 0), -1.0),
        (("extent", "repeats"), {}),
        (("methods",), "none"),
    ],
)
def test_a_damaged_file_is_refused_with_the_place(tmp_path, place, value):
    document = _document([row()])
    part = document
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = value
    save(tmp_path / bench_records.FILE, document)
    with pytest.raises(LinkproofError, match=re.escape(".".join(map(str, place)))):
        load(tmp_path)


def test_a_file_of_an_older_format_is_refused_with_the_cure(tmp_path):
    (tmp_path / bench_records.FILE).write_text('{"format": 2, "records": []}')
    with pytest.raises(LinkproofError, match="in format 3, got 2: run bench again"):
        load(tmp_path)


def test_a_point_that_did_not_finish_stands_in_every_quantity_asked_for():
    failed, finished = points([row(error_max=None, outcome="diverged")]), points([row()])
    assert [(one.quantity, one.finished) for one in by_quantity(failed, ("Jeq", "phi"))] == [
        ("Jeq", False),
        ("phi", False),
    ]
    assert [one.quantity for one in by_quantity(finished, ("Jeq", "phi"))] == ["Mkr"]


def test_a_quantity_that_an_engine_does_not_tell_is_not_provided_there_alone():
    (point,) = points([row(left_out={"Jeq": "Jeq not offered"})])
    told = {one.quantity: (one.outcome, one.detail, one.finished) for one in by_quantity([point], ("Mkr", "Jeq"))}
    assert told == {"Mkr": ("finished", "", True), "Jeq": ("not-provided", "Jeq not offered", False)}


def test_a_folder_without_one_is_refused(tmp_path):
    with pytest.raises(LinkproofError, match="no benchmark at"):
        load(tmp_path)


def test_a_record_without_error_or_time_has_not_finished():
    assert row().finished
    assert not row(error_max=None).finished
    assert not row(outcome="timed-out").finished
    assert Bench(_document([row()])).records[0].repeats == (1e-2, 1.2e-2)
