"""From options to a campaign, its limits and earlier results, and back to the command that repeats it."""

import math
import re
import shlex
from pathlib import Path

import pytest

import linkproof
from analytic.description.loading import find, read
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.trials.campaign.campaign import each_case
from comparisons.trials.judging.limits import read_limits
from reports.api.campaign import chosen_linkages, request, run_bounds
from reports.api.options import Bounds, Motion

JUKI = "juki-mf7923d"


FAST = {"engine": "direct", "quantity": "Jeq", "bounds": Bounds(jobs=0)}


@pytest.mark.parametrize(
    ("motion", "options", "words"),
    [
        ({}, {}, ""),
        ({"variant": "as-printed"}, {"setting": ("naive", "best")}, "--setting naive --setting best "
         "--variant as-printed"),
        ({"speed": -50.0, "start_angle": 78.79541471699513, "gravity": False}, {},
         "--speed -50 --start-angle 78.79541471699513 --no-gravity"),
        ({}, {"limits": Path("my limits.toml"), "record": "c.csv", "junit": "j.xml"}, "--limits 'my limits.toml'"),
    ],
)  # fmt: skip
def test_the_command_repeats_the_request(motion, options, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("my limits.toml").write_text('[[limit]]\nquantities = ["Jeq"]\nvalue = 1\nreason = "mine"\n')
    found = linkproof.compare(JUKI, Motion(**motion), **FAST, **options)
    assert shlex.split(found.command)[:5] == ["linkproof", "compare", JUKI, "--engine", "direct"]
    assert {*shlex.split(words)} <= {*shlex.split(found.command)}
    assert "c.csv" not in found.command


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"time_limit": -1.0}, "--time-limit: expected a positive finite number of s, got -1"),
        ({"time_limit": math.nan}, "got nan"),
        ({"memory_limit": 0.0}, "--memory-limit: expected a positive finite number of GiB, got 0"),
        ({"jobs": -2}, "--jobs: expected a number of processes, or 0 for none, got -2"),
        ({"memory_limit": 1.0, "jobs": 0}, "leave one of the two out"),
    ],
)
def test_impossible_limits_are_refused(limits, words):
    with pytest.raises(LinkproofError, match=words):
        run_bounds(Bounds(**limits))


def test_gravity_is_on_where_the_linkage_has_it(tmp_path):
    weightless = tmp_path / "weightless.toml"
    weightless.write_text(re.sub("^gravity.*$", "", find(JUKI).read_text(), flags=re.MULTILINE))
    linkages, _ = chosen_linkages((JUKI, weightless), Motion())
    conditions = {case.mechanism.linkage.name: case.conditions for case in each_case(request(linkages, Motion()))}
    assert conditions[JUKI].endswith(", gravity on")
    assert conditions["weightless"].endswith(", gravity off")
    assert all(linkage.gravity == (0.0, 0.0) for linkage in chosen_linkages((), Motion(gravity=False))[0])


ROOT = Path(__file__).parents[3]


def test_files_of_one_name_have_as_many_folders_before_it_as_tell_them_apart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    paths = ("a/press.toml", "a/parts/press.toml", "b/parts/press.toml")
    for path in map(Path, paths):
        path.parent.mkdir(parents=True)
        path.write_text(read("juki-mf7923d").text, encoding="utf-8")
    found = [file.name for file in chosen_linkages(paths, Motion())[1]]
    assert found == ["a-press", "a-parts-press", "b-parts-press"]
    with pytest.raises(LinkproofError, match=r"both called '.*-press'"):
        chosen_linkages((paths[0], tmp_path / paths[0]), Motion())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"against": Path("nix.csv")}, "expected recorded results, got 'nix.csv', which does not exist"),
        ({"against": ROOT / "tests"}, "no results of compare in"),
        ({"record": Path("press.toml")}, "--record press.toml: the suffix must be .csv"),
    ],
)
def test_what_cannot_be_read_or_written_is_refused_before_any_run(options, words):
    with pytest.raises(LinkproofError, match=words):
        linkproof.compare(engine="direct", **options)


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
        linkproof.compare(engine="direct", limits=tmp_path / "limits.toml")


def test_the_limits_that_the_documentation_shows_are_read(tmp_path):
    (rows,) = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "command-line.md").read_text("utf-8"), re.DOTALL)
    (tmp_path / "limits.toml").write_text(rows, encoding="utf-8")
    found = read_limits(tmp_path / "limits.toml").limit("Mkr", "tuned", "run-up", "press", "mujoco")
    assert found.reason.startswith("a tenth")
