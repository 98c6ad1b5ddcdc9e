"""``verify``, ``diff``, ``merge`` and ``report`` of saved folders: exit codes, pages, refusals."""

import json

import pytest

from analytic.description.loading import load
from comparisons.folders.verification import verify
from tests.commands import linkproof, refused
from tests.comparisons.folders.saved_campaign import changed, row, save_campaign


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return save_campaign(tmp_path_factory.mktemp("sent") / "a", load("juki-mf7923d"))


@pytest.fixture(scope="module")
def worse(folder, tmp_path_factory):
    """The same from another machine, with an error over its limit."""

    def edit(document, run):
        document["environment"]["machine"] = "another"
        row(run, "Mkr").update(error_max=0.5, outcome="over-limit", detail="too far")

    return changed(folder, tmp_path_factory.mktemp("worse") / "b", edit)


def test_verify_fails_where_something_differs(folder, worse, tmp_path):
    done = linkproof("verify", folder)
    assert (done.returncode, done.stdout.endswith("nothing differs\n")) == (0, True)
    done = linkproof("verify", worse, "--json", tmp_path / "found.json")
    assert done.returncode == 1
    assert "its error_max is 0.5, its curve's is" in done.stdout
    document = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert len(document["findings"]) == len(verify(worse).findings)


def test_diff_fails_where_something_is_beyond_limits(folder, worse):
    same = linkproof("diff", folder, folder)
    assert (same.returncode, same.stdout.splitlines()[-1][-24:]) == (0, "0 moved; 0 beyond limits")
    done = linkproof("diff", folder, worse, "--verbose")
    assert done.returncode == 1
    assert "5.0e-1 ✗" in done.stdout
    assert "seconds are not compared" in done.stdout
    document = json.loads(linkproof("diff", folder, worse, "--json", "-").stdout)
    assert [move["after"]["quantity"] for move in document["moves"]] == ["Mkr"]
    assert document["beyond"] == 1


def test_merge_writes_a_report_by_hardware_which_is_rebuilt_and_not_judged_as_one_campaign(folder, worse, tmp_path):
    both = tmp_path / "both"
    done = linkproof("merge", folder, worse, "--out", both)
    assert done.returncode == 0, done.stderr
    page = (both / "index.html").read_text(encoding="utf-8")
    assert page.index("another") < page.index("From machine to machine")
    for name in ("a", "b"):
        assert f'href="{name}/index.html"' in page
        assert (both / name / "index.html").is_file()
    assert "1 moved; 1 beyond limits" in page.replace("\u00a0", " ")
    (both / "index.html").unlink()
    assert linkproof("report", both).returncode == 0
    assert (both / "index.html").read_text(encoding="utf-8") == page
    assert "is merged: leave the options out" in refused("report", both, "--png")
    for words in (("verify", both), ("diff", folder, both)):
        assert f"got the merged '{both}': name one in it, such as '{both / 'a'}'" in refused(*words)


def test_report_writes_csv_and_no_page(folder, tmp_path):
    assert linkproof("report", folder, "--csv", tmp_path / "csv").returncode == 0
    assert [path.suffix for path in (tmp_path / "csv").iterdir()] == [".csv"]
    assert "--csv writes curves and no pages" in refused("report", folder, "--csv", tmp_path / "csv", "--png")
