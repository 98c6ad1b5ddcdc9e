"""Curves as CSV hold every digit of the dataset."""

import csv
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.campaign.results import load as load_results
from comparisons.folders.tables import HEAD, write_tables
from comparisons.judging.records import Record
from tests.comparisons.folders.saved_campaign import save_campaign


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return save_campaign(tmp_path_factory.mktemp("sent") / "a", load("juki-mf7923d"))


def test_every_run_is_a_file_with_a_row_per_sample_and_every_digit(folder, tmp_path):
    results = load_results(folder)
    (path,) = write_tables(results, tmp_path / "csv")
    assert path.name == "juki-mf7923d_as-built_run-up_direct_tuned.csv"
    with path.open(encoding="utf-8", newline="") as opened:
        head, *rows = csv.reader(opened)
    assert tuple(head) == HEAD
    assert len(rows) == sum(curve.shape[1] for curve in results.runs[0].curves.values())
    mine = [row for row in rows if row[0] == "Mkr"]
    assert {row[1] for row in mine} == {"N m"}
    columns = np.array([[float(value) for value in row[2:]] for row in mine]).T
    np.testing.assert_array_equal(columns, results.curve(results.records[0].run, "Mkr"))


def test_names_that_no_file_can_have_are_written_otherwise_and_numbered(tmp_path):
    records = [
        Record("p/q", "v", "run-up", "", "e", "", setting, quantity="Mkr", unit="N m", error_max=0.0)
        for setting in ("a:b", "A?B")
    ]
    told: Any = SimpleNamespace(records=records, curve=lambda *_: (np.zeros(1),) * 4)
    assert [path.name for path in write_tables(told, tmp_path)] == [
        "p-q_v_run-up_e_a-b.csv",
        "p-q_v_run-up_e_A-B~2.csv",
    ]


def test_a_campaign_without_a_curve_has_no_tables(folder, tmp_path):
    results = load_results(folder)
    told = replace(results, runs=tuple(replace(run, errors=()) for run in results.runs))
    with pytest.raises(LinkproofError, match="got none: no run of the campaign finished"):
        write_tables(told, tmp_path / "csv")
    assert not (tmp_path / "csv").exists()
