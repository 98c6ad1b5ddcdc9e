"""A saved folder is verified, merged with others and written as CSV."""

import csv
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.campaign.results import load as load_results
from comparisons.folders.merging import folders_to_merge, merge
from comparisons.folders.studies import COLUMNS, write_tables
from comparisons.folders.verification import verify
from comparisons.judging.limits import Limit, with_rows
from comparisons.judging.records import CURVE, Record
from comparisons.runs.record_file import CURVES, RECORDS
from comparisons.runs.study_folder import DOCUMENT, SUMS
from tests.comparisons.folders.saved_campaign import changed, row, save_campaign

OBSERVED = CURVE.index("observed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return save_campaign(tmp_path_factory.mktemp("sent") / "results", load("juki-mf7923d"))


def _found(folder, into, edit):
    return {(one.place.rpartition(": ")[2], one.sentence) for one in verify(changed(folder, into, edit)).findings}


def test_nothing_differs_in_a_folder_as_it_was_written(folder):
    found = verify(folder)
    assert found.findings == ()
    assert found.curves == sum(record.error_max is not None for record in found.records) > 8
    assert found.figures > 4
    assert found.texts == 1
    assert found.notes[0] == "judged by the limits of this version, which are the folder's"


def test_an_error_that_contradicts_its_curve_is_a_finding(folder, tmp_path):
    found = _found(folder, tmp_path / "b", lambda _, run: row(run, "Mkr").update(error_max=1e-5))
    assert {place for place, _ in found} == {"Mkr"}
    assert any(words.startswith("its error_max is 1e-05, its curve's is ") for _, words in found)


def test_a_curve_that_was_smoothed_is_judged_by_what_it_shows(folder, tmp_path):
    def bend(_, run):
        run["curves"]["Mkr"][OBSERVED, -5] += 0.5 * row(run, "Mkr")["peak"]

    found = _found(folder, tmp_path / "b", bend)
    assert {place for place, _ in found} == {"Mkr"}
    assert any(words.startswith("saved as passed, judged over-limit: error 0.5 of peak") for _, words in found)


def test_a_vector_is_judged_by_its_magnitudes_where_they_are_further_off(folder, tmp_path):
    def bend(_, run):
        name = [*run["curves"]][-1]
        assert name.startswith("joint_force:")
        run["curves"][name][OBSERVED, -5] += row(run, name)["peak"]

    assert any("judged over-limit" in words for _, words in _found(folder, tmp_path / "b", bend))


def test_a_changed_text_shows_in_checksum_reference_and_key_figures(folder, tmp_path):
    def heavier(told, _):
        text = told["descriptions"][0]["text"]
        told["descriptions"][0]["text"] = text.replace("0.64\n", "0.6464\n", 1)
        assert told["descriptions"][0]["text"] != text

    words = " | ".join(f"{place}: {sentence}" for place, sentence in _found(folder, tmp_path / "b", heavier))
    assert "its text has the checksum" in words
    assert "the saved reference differs from the closed form of the folder's text by" in words
    assert "Mkr.peak was" in words


def test_limits_of_the_sender_are_noted_and_those_of_the_receiver_judge(tmp_path):
    own = with_rows([Limit(quantities=["Mkr"], value=1e-30, reason="none")], "own")
    folder = save_campaign(tmp_path / "a", load("juki-mf7923d"), limits=own)
    by_theirs = verify(folder)
    assert by_theirs.findings == ()
    assert by_theirs.notes[0].endswith("of which this version has not: Mkr 1e-30 (none)")
    (tmp_path / "mine.toml").write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 1e-9\n', encoding="utf-8")
    by_ours = {one.place.rpartition(": ")[2]: one.sentence for one in verify(folder, tmp_path / "mine.toml").findings}
    assert by_ours == {"Mkr": "its limit is 1e-30, judged by 1e-09; passed by both"}


def test_a_folder_of_judge_is_refused(folder, tmp_path):
    copy = changed(folder, tmp_path / "b", lambda told, _: told.update(judgement=["right"]))
    with pytest.raises(LinkproofError, match="got one of judge: judge the tool's own files again"):
        verify(copy)


@pytest.fixture(scope="module")
def elsewhere(folder, tmp_path_factory):
    def machine(told, _):
        told["environment"]["machine"] = "another"

    return changed(folder, tmp_path_factory.mktemp("two") / "results", machine)


def test_folders_of_one_name_are_merged_whole_under_two_names(folder, elsewhere, tmp_path):
    merged = merge(folders_to_merge([folder, elsewhere]), tmp_path / "both")
    assert [one.path for one in merged] == [tmp_path / "both" / "results", tmp_path / "both" / "results~2"]
    assert merged[1].machine == "another"
    for source, one in zip((folder, elsewhere), merged, strict=True):
        for name in ("mechanisms.json", *(f"compare/{part}" for part in (DOCUMENT, SUMS, RECORDS, CURVES))):
            assert (one.path / name).read_bytes() == (source / name).read_bytes()


def test_what_is_merged_can_be_merged_again(folder, elsewhere, tmp_path):
    merge(folders_to_merge([folder]), tmp_path / "one")
    again = folders_to_merge([tmp_path / "one", elsewhere])
    assert [one.path for one in again] == [tmp_path / "one" / "results", elsewhere]


def test_a_run_that_one_machine_made_twice_is_refused(folder, tmp_path):
    with pytest.raises(LinkproofError, match="expected every run once, got compare juki-mf7923d/as-built/run-up/"):
        folders_to_merge([folder, changed(folder, tmp_path / "b", lambda *_: None)])


def test_a_folder_with_nothing_in_it_and_a_damaged_list_are_refused(tmp_path):
    with pytest.raises(LinkproofError, match="nothing to merge in"):
        folders_to_merge([tmp_path])
    for text in ("[]", '{"format": 1, "folders": ["../../secret"]}', '{"format": 1, "folders": []}'):
        (tmp_path / "merged.json").write_text(text, encoding="utf-8")
        with pytest.raises(LinkproofError, match="is no list of merged folders"):
            folders_to_merge([tmp_path])


def test_every_run_is_a_file_with_a_row_per_sample_and_every_digit(folder, tmp_path):
    results = load_results(folder)
    (path,) = write_tables(results, tmp_path / "csv")
    assert path.name == "juki-mf7923d_as-built_run-up_direct_tuned.csv"
    with path.open(encoding="utf-8", newline="") as opened:
        head, *rows = csv.reader(opened)
    assert tuple(head) == COLUMNS
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
