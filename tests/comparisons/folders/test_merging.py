"""Folders of several machines are joined whole, and no run is in twice."""

import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.folders.merging import folders_of, merge
from comparisons.runs.record_file import CURVES, RECORDS
from comparisons.runs.study_folder import DOCUMENT, SUMS
from tests.comparisons.folders.saved_campaign import changed, save_campaign


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return save_campaign(tmp_path_factory.mktemp("one") / "results", load("juki-mf7923d"))


@pytest.fixture(scope="module")
def elsewhere(folder, tmp_path_factory):
    def machine(told, _):
        told["environment"]["machine"] = "another"

    return changed(folder, tmp_path_factory.mktemp("two") / "results", machine)


def test_folders_of_one_name_are_kept_apart_and_whole(folder, elsewhere, tmp_path):
    merged = merge(folders_of([folder, elsewhere]), tmp_path / "both")
    assert [one.path for one in merged] == [tmp_path / "both" / "results", tmp_path / "both" / "results~2"]
    assert merged[1].machine == "another"
    for source, one in zip((folder, elsewhere), merged, strict=True):
        for name in ("mechanisms.json", *(f"compare/{part}" for part in (DOCUMENT, SUMS, RECORDS, CURVES))):
            assert (one.path / name).read_bytes() == (source / name).read_bytes()


def test_what_is_merged_can_be_merged_again(folder, elsewhere, tmp_path):
    merge(folders_of([folder]), tmp_path / "one")
    again = folders_of([tmp_path / "one", elsewhere])
    assert [one.path for one in again] == [tmp_path / "one" / "results", elsewhere]


def test_a_run_that_one_machine_made_twice_is_refused(folder, tmp_path):
    with pytest.raises(LinkproofError, match="expected every run once, got compare juki-mf7923d/as-built/run-up/"):
        folders_of([folder, changed(folder, tmp_path / "b", lambda *_: None)])


def test_a_folder_that_holds_something_is_not_written_into(folder, tmp_path):
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(LinkproofError, match="expected a new or an empty folder to merge into"):
        merge(folders_of([folder]), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_a_folder_with_nothing_in_it_and_a_damaged_list_are_refused(tmp_path):
    with pytest.raises(LinkproofError, match="nothing to merge in"):
        folders_of([tmp_path])
    for text in ("[]", '{"format": 1, "folders": ["../../secret"]}', '{"format": 1, "folders": []}'):
        (tmp_path / "merged.json").write_text(text, encoding="utf-8")
        with pytest.raises(LinkproofError, match="is no list of merged folders"):
            folders_of([tmp_path])
