"""Records and their file: complete, without NaN, the same when read back."""

import re

import pytest

from analytic.errors import LinkproofError
from comparisons.runs.study_folder import save_study
from comparisons.work_precision.records import KIND, Bench, by_quantity, load, save
from tests.comparisons.bench_rows import points, row, setting_row

KEYS = {
    "mechanism", "regime", "engine", "setting", "step", "errors", "seconds", "repeats", "steps", "outcome",
}  # fmt: skip


def _document():
    noise = {"work": "w", "samples": [1e-3, 1.2e-3]}
    extent = {"budget": 1.0, "repeats": 5, "patience": 0.6}
    told = {"command": "bench", "conditions": "", "environment": {}, "first_use": [], "mechanisms": [], "methods": []}
    own = {
        "noise": noise,
        "extent": extent,
        "costs": [],
        "quantities": ["Mkr"],
    }
    return {**told, **own}


def test_a_point_has_the_keys_that_readers_of_the_file_use():
    (point,) = (one.data for one in points([row(), row(quantity="Jeq")]))
    assert set(point) >= KEYS
    assert [one["quantity"] for one in point["errors"]] == ["Mkr", "Jeq"]
    assert {"unit", "error_max", "error_rms", "peak"} <= set(point["errors"][0])


def test_what_is_saved_is_what_is_loaded(tmp_path):
    records = [row(), setting_row("best", None, None, outcome="crashed", repeats=(), detail="died by signal 6")]
    save(tmp_path, Bench(_document(), points(records)))
    found = load(tmp_path)
    assert found.records == tuple(records)
    assert found.noise.samples == (1e-3, 1.2e-3)


@pytest.mark.parametrize(
    ("place", "words"),
    [
        (("records", 0, "setting"), "setting"),
        (("records", 0, "errors", 0, "error_max"), "0.error_max"),
        (("noise", "samples", 0), "noise.samples.0"),
        (("extent", "repeats"), "extent.repeats"),
        (("methods",), "methods"),
    ],
)
def test_a_document_of_another_form_is_refused_with_the_place(tmp_path, place, words):
    told = {**_document(), "records": [point.data for point in points([row()])]}
    part = told
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = {"x": 1}
    save_study(tmp_path, KIND, told, (("0", one, {}) for one in told.pop("records")))
    with pytest.raises(LinkproofError, match=rf"{re.escape(words)}.*run bench with --out again"):
        load(tmp_path)


def test_a_point_that_did_not_finish_stands_in_every_quantity_asked_for():
    failed, finished = points([row(error_max=None, outcome="diverged")]), points([row()])
    assert [(one.quantity, one.finished) for one in by_quantity(failed, ("Jeq", "phi"))] == [
        ("Jeq", False),
        ("phi", False),
    ]
    assert [one.quantity for one in by_quantity(finished, ("Jeq", "phi"))] == ["Mkr"]


def test_a_quantity_that_an_engine_does_not_tell_is_not_provided_there_alone():
    (point,) = points([row(lacking={"Jeq": "Jeq not offered"})])
    told = {one.quantity: (one.outcome, one.detail, one.finished) for one in by_quantity([point], ("Mkr", "Jeq"))}
    assert told == {"Mkr": ("finished", "", True), "Jeq": ("not-provided", "Jeq not offered", False)}


def test_a_record_without_error_or_time_has_not_finished():
    assert row().finished
    assert not row(error_max=None).finished
    assert not row(outcome="timed-out").finished
