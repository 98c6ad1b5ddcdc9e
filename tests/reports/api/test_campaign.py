"""From options to a campaign, its limits and earlier results, and back to the command that repeats it."""

import math
import re
import shlex
from pathlib import Path

import pytest

from analytic.description.loading import find, read
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.trials.campaign.campaign import each_case
from comparisons.trials.judging.limits import read_limits
from reports.api.campaign import campaign, files, request, run_resources
from reports.api.options import CompareOptions, RunLimits, StandardOptions, command_line

JUKI = "juki-mf7923d"


def names(options):
    return [linkage.name for linkage in request(options).linkages]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, ""),
        (
            {"mechanisms": (JUKI,), "engine": ("direct",), "setting": ("naive", "best"), "variant": "as-printed"},
            f"{JUKI} --variant as-printed --engine direct --setting naive --setting best",
        ),
        (
            {"speed": 50.0, "start_angle": 78.79541471699513, "clockwise": True, "gravity": False},
            "--speed 50 --start-angle 78.79541471699513 --clockwise --no-gravity",
        ),
        ({"mechanisms": ("path with spaces/mine.toml",)}, "'path with spaces/mine.toml'"),
    ],
)
def test_the_command_repeats_the_request(options, words):
    assert shlex.split(command_line("compare", CompareOptions(**options))) == shlex.split(f"linkproof compare {words}")


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
        run_resources(RunLimits(**limits))


def test_gravity_is_on_where_the_linkage_has_it(tmp_path):
    weightless = tmp_path / "weightless.toml"
    weightless.write_text(re.sub("^gravity.*$", "", find(JUKI).read_text(), flags=re.MULTILINE))
    options = CompareOptions(mechanisms=(JUKI, str(weightless)))
    conditions = {case.mechanism.linkage.name: case.conditions for case in each_case(request(options))}
    assert conditions[JUKI].endswith(", gravity on")
    assert conditions["weightless"].endswith(", gravity off")
    assert all(linkage.gravity == (0.0, 0.0) for linkage in request(CompareOptions(gravity=False)).linkages)


ROOT = Path(__file__).parents[3]


def test_files_of_one_name_have_as_many_folders_before_it_as_tell_them_apart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    paths = ("a/press.toml", "a/parts/press.toml", "b/parts/press.toml")
    for path in map(Path, paths):
        path.parent.mkdir(parents=True)
        path.write_text(read("juki-mf7923d").text, encoding="utf-8")
    found = [file.name for file in files(CompareOptions(mechanisms=paths))]
    assert found == ["a-press", "a-parts-press", "b-parts-press"]
    with pytest.raises(LinkproofError, match=r"both called '.*-press'"):
        request(CompareOptions(mechanisms=(paths[0], str(tmp_path / paths[0]))))


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
    found = read_limits(tmp_path / "limits.toml").limit("Mkr", "tuned", "run-up", "press", "mujoco")
    assert found.reason.startswith("a tenth")
