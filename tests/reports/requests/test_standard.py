"""The campaign of ``compare``: names of equal files, limits and earlier results."""

import re
from pathlib import Path

import pytest

from analytic.description.loading import read
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.judging.limits import read_limits
from reports.requests.campaign import campaign, files
from reports.requests.options import CompareOptions, StandardOptions, command_line

ROOT = Path(__file__).parents[3]


def test_files_of_one_name_have_as_many_folders_before_it_as_tell_them_apart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    paths = ("a/press.toml", "a/parts/press.toml", "b/parts/press.toml")
    for path in map(Path, paths):
        path.parent.mkdir(parents=True)
        path.write_text(read("juki-mf7923d").text, encoding="utf-8")
    names = [file.name for file in files(CompareOptions(mechanisms=paths))]
    assert names == ["a-press", "a-parts-press", "b-parts-press"]


def test_the_words_ask_for_the_same_standard():
    mine = StandardOptions(limits=Path("my limits.toml"), against=Path("b.csv"), record=Path("c.csv"))
    words = "linkproof compare --limits 'my limits.toml' --against b.csv"
    assert command_line("compare", CompareOptions(), mine) == words


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            {"against": Path("nix.csv")},
            "expected recorded results, got 'nix.csv', which does not exist",
        ),
        ({"against": ROOT / "tests"}, "no results of compare in"),
        ({"record": Path("press.toml")}, "--record press.toml: the suffix must be .csv"),
        ({"record": ROOT / "README.md" / "a.csv"}, "cannot write"),
    ],
)
def test_what_cannot_be_read_or_written_is_refused_before_any_run(options, words):
    with pytest.raises(LinkproofError, match=words):
        campaign(CompareOptions(engine=("direct",)), StandardOptions(**options))


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ('mechanisms = ["juki-mf7923"]', "unknown mechanism of limit 1 'juki-mf7923': did you mean 'juki-mf7923d'"),
        ('regimes = ["runup"]', "unknown regime of limit 1 'runup': did you mean 'run-up'"),
    ],
)
def test_a_limit_that_would_never_apply_is_refused(tmp_path, row, words):
    (tmp_path / "limits.toml").write_text(f'[[limit]]\nquantities = ["Mkr"]\nvalue = 1e-3\n{row}\n')
    with pytest.raises(UnknownNameError, match=words):
        campaign(CompareOptions(engine=("direct",)), StandardOptions(limits=tmp_path / "limits.toml"))


def test_the_limits_that_the_documentation_shows_are_read(tmp_path):
    (rows,) = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "command-line.md").read_text("utf-8"), re.DOTALL)
    (tmp_path / "limits.toml").write_text(rows, encoding="utf-8")
    assert read_limits(tmp_path / "limits.toml").limit("Mkr", "tuned", "run-up", "press").reason.startswith("a tenth")
