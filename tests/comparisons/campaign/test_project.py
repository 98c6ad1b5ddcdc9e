"""A project file is searched upwards from a linkage and read; a wrong one is refused in one sentence."""

import re
from pathlib import Path

import pytest

from analytic.errors import LinkproofError
from comparisons.campaign.project import BASELINE, Project, find_project, read_project
from comparisons.judging.limits import read_limits, shipped_limits

WHOLE = """
linkages = ["linkages/*.toml", "press.toml"]
engines = ["exudyn", "own"]
settings = ["tuned"]
regimes = ["run-up"]
time_limit = 30
memory_limit = 1.5
baseline = "held/baseline.json"
[[limit]]
quantities = ["Mkr"]
value = 0.25
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "linkages").mkdir()
    for name in ("press.toml", "linkages/b.toml", "linkages/a.toml"):
        (tmp_path / name).write_text("")
    return tmp_path


def test_a_project_sets_linkages_engines_limits_and_bounds(folder):
    (folder / "linkproof.toml").write_text(WHOLE)
    found = find_project(folder / "linkages" / "a.toml")
    assert found is not None
    assert [path.name for path in found.linkages] == ["a.toml", "b.toml", "press.toml"]
    assert (found.engines, found.settings, found.regimes) == (("exudyn", "own"), ("tuned",), ("run-up",))
    assert (found.time_limit, found.memory_limit) == (30.0, 1.5)
    assert found.baseline == folder / "held" / "baseline.json"
    assert found.limits.limit("Mkr", "tuned", "run-up").value == 0.25


def test_an_empty_file_is_a_project_of_defaults(folder):
    (folder / "linkproof.toml").write_text("")
    assert find_project(folder) == Project(folder, folder / BASELINE, limits=shipped_limits())


def test_without_a_file_there_is_no_project(folder):
    assert find_project(folder / "press.toml") is None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("engines = [", "linkproof.toml:1: not valid TOML"),
        ("engine = []", "unknown key 'engine': did you mean 'engines'"),
        ("engines = 'exudyn'", "engines: expected a list of words"),
        ("engines = ['']", "engines #1: expected a list of words in quotes, got ''"),
        ("limit = []", "limit: expected tables .*, each with quantities and a value, got"),
        ("time_limit = 0", "time_limit: expected a positive number, got 0"),
        ("baseline = ''", "baseline: expected the name of a file"),
        ("allow_new = 1", "allow_new: expected true or false, got 1"),
        ("linkages = ['*.tml']", "got none that match"),
        ("linkages = ['/etc/*.toml']", "linkages: expected a place beneath its folder, got '/etc"),
        ("linkages = ['**/../**/*.toml']", "linkages: expected a place beneath its folder"),
        ("linkages = ['*/*.toml']", "linkages: expected a place beneath its folder, got 'away/outside.toml'"),
        ("linkages = ['leads.toml']", "linkages: expected a place beneath its folder"),
        ('linkages = ["\\u0000"]', "linkages #1: expected no control characters"),
        ("baseline = 'away/outside.json'", "baseline: expected a place beneath its folder"),
    ],
)
def test_a_wrong_project_is_refused(folder, tmp_path_factory, text, words):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "outside.toml").write_text("")
    (folder / "away").symlink_to(elsewhere)
    (folder / "leads.toml").symlink_to(elsewhere / "outside.toml")
    (folder / "linkproof.toml").write_text(text)
    with pytest.raises(LinkproofError, match=words):
        read_project(folder / "linkproof.toml")


def test_links_within_a_project_are_followed(folder):
    (folder / "again").symlink_to("linkages")
    (folder / "linkproof.toml").write_text("linkages = ['again/*.toml']\nbaseline = 'again/baseline.json'")
    found = read_project(folder / "linkproof.toml")
    assert [path.name for path in found.linkages] == ["a.toml", "b.toml"]
    assert found.baseline == folder / "again" / "baseline.json"


def test_the_files_that_the_documentation_shows_are_read(folder):
    text = (Path(__file__).parents[3] / "docs" / "command-line.md").read_text(encoding="utf-8")
    limits, project = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    (folder / "limits.toml").write_text(limits, encoding="utf-8")
    (folder / "linkproof.toml").write_text(project, encoding="utf-8")
    assert read_limits(folder / "limits.toml").limit("Mkr", "tuned", "run-up", "press").reason.startswith("a tenth of")
    assert read_project(folder / "linkproof.toml").linkages
