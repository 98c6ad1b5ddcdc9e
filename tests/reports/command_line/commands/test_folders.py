"""verify, diff, merge and report --csv, as they are typed."""

import json

import pytest
from typer.testing import CliRunner

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.folders.verification import verify
from reports.command_line.app import app
from tests.comparisons.folders.saved_campaign import changed, row, save_campaign


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return save_campaign(tmp_path_factory.mktemp("sent") / "a", load("juki-mf7923d"))


@pytest.fixture(scope="module")
def worse(folder, tmp_path_factory):
    """The same from another machine, with an error over its limit."""

    def edit(told, run):
        told["environment"]["machine"] = "another"
        row(run, "Mkr").update(error_max=0.5, outcome="over-limit", detail="too far")

    return changed(folder, tmp_path_factory.mktemp("worse") / "b", edit)


def _typed(*words):
    return CliRunner().invoke(app, list(map(str, words)))


def test_verify_ends_well_where_nothing_differs_and_tells_what_does(folder, worse, tmp_path):
    done = _typed("verify", folder)
    assert done.exit_code == 0
    assert done.stdout.endswith("nothing differs\n")
    done = _typed("verify", worse, "--json", tmp_path / "found.json")
    assert done.exit_code == 1
    assert "its error_max is 0.5, its curve's is" in done.stdout
    told = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert len(told["findings"]) == len(verify(worse).findings)


def test_diff_ends_with_1_where_something_is_beyond_limits(folder, worse):
    same = _typed("diff", folder, folder)
    assert (same.exit_code, same.stdout.splitlines()[-1][-24:]) == (0, "0 moved; 0 beyond limits")
    done = _typed("diff", folder, worse, "--verbose")
    assert done.exit_code == 1
    assert "5.0e-1 ✗" in done.stdout
    assert "seconds are not compared" in done.stdout
    told = json.loads(_typed("diff", folder, worse, "--json", "-").stdout)
    assert [move["after"]["quantity"] for move in told["moves"]] == ["Mkr"]
    assert told["beyond"] == 1


def test_merge_writes_a_report_by_hardware_and_pages_of_every_folder(folder, worse, tmp_path):
    done = _typed("merge", folder, worse, "--out", tmp_path / "both")
    assert done.exit_code == 0, done.output
    page = (tmp_path / "both" / "index.html").read_text(encoding="utf-8")
    assert page.index("another") < page.index("From machine to machine")
    for name in ("a", "b"):
        assert f'href="{name}/index.html"' in page
        assert (tmp_path / "both" / name / "index.html").is_file()
    assert "1 moved; 1 beyond limits" in page.replace("\u00a0", " ")
    (tmp_path / "both" / "index.html").unlink()
    assert _typed("report", tmp_path / "both").exit_code == 0
    assert (tmp_path / "both" / "index.html").read_text(encoding="utf-8") == page
    assert isinstance(_typed("report", tmp_path / "both", "--png").exception, LinkproofError)


def test_report_writes_csv_and_no_page(folder, tmp_path):
    done = _typed("report", folder, "--csv", tmp_path / "csv")
    assert done.exit_code == 0
    assert [path.suffix for path in (tmp_path / "csv").iterdir()] == [".csv"]
    refused = _typed("report", folder, "--csv", tmp_path / "csv", "--png")
    assert isinstance(refused.exception, LinkproofError)


def test_a_merged_folder_is_not_judged_as_one_campaign(folder, worse, tmp_path):
    assert _typed("merge", folder, worse, "--out", tmp_path / "both").exit_code == 0
    for words in (("verify", tmp_path / "both"), ("diff", folder, tmp_path / "both")):
        with pytest.raises(LinkproofError, match=r"got the merged '.*both': name one in it, such as '.*both/a'"):
            CliRunner().invoke(app, list(map(str, words)), catch_exceptions=False)
