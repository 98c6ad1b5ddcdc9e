"""From options to the request of a campaign, and back to the command that repeats it."""

import math

import pytest

from analytic.description.loading import catalogue, find
from analytic.errors import LinkproofError
from analytic.machine_code.compiling import cores
from comparisons.runs.run_engine import GIB
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds
from engines.contract import Setting
from engines.registry import engine_names
from reports.requests import campaign
from reports.requests.campaign import Running, installed, missing_engines, request, running
from reports.requests.campaign_options import CompareOptions, RunLimits
from reports.requests.options import changed_options

JUKI = "juki-mf7923d"


def names(options):
    return [linkage.name for linkage in request(options).linkages]


def test_the_defaults_are_everything_tuned_on_the_usual_ramp():
    default = request(CompareOptions())
    assert tuple(linkage.name for linkage in default.linkages) == catalogue()
    assert [motion.regime for motion in default.motions] == ["run-up"]
    assert (default.settings, default.engines) == ((Setting.TUNED,), tuple(installed(engine_names())))
    assert default.with_invariants
    assert not request(CompareOptions(mechanisms=(JUKI,), quantity=("Jeq",))).with_invariants


def test_engines_that_are_not_installed_are_left_out_with_a_remark_unless_engines_are_named(monkeypatch):
    monkeypatch.setattr(campaign, "why_unavailable", lambda adapter: "not here" if adapter.name != "direct" else None)
    assert request(CompareOptions()).engines == ("direct",)
    assert missing_engines(("direct",)).startswith("not installed, left out: drake, exudyn, mujoco")
    assert missing_engines(engine_names()) == ""


def test_two_files_of_one_name_have_the_names_of_their_folders_before_theirs(tmp_path, monkeypatch):
    paths = [tmp_path / folder / f"{JUKI}.toml" for folder in ("old", "new")]
    for path in paths:
        path.parent.mkdir()
        path.write_text(find(JUKI).read_text())
    assert names(CompareOptions(mechanisms=(JUKI, *map(str, paths)))) == [JUKI, f"old-{JUKI}", f"new-{JUKI}"]
    monkeypatch.chdir(tmp_path / "old")
    with pytest.raises(LinkproofError, match=rf"both called '.*-{JUKI}'"):
        request(CompareOptions(mechanisms=(paths[0].name, str(paths[0]))))


def test_limits_become_bounds_and_stay_with_the_command():
    assert (running(RunLimits()), changed_options(RunLimits())) == (Running(DEFAULT_BOUNDS, cores(), None), {})
    assert running(RunLimits(time_limit=90.0, memory_limit=0.5)).bounds == Bounds(90.0, GIB // 2)
    assert running(RunLimits(jobs=0)).processes == 0
    limits = RunLimits(time_limit=90.0, memory_limit=0.5, jobs=0)
    assert changed_options(limits) == {"time-limit": ("90",), "memory-limit": ("0.5",)}


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"time_limit": -1.0}, "--time-limit: expected a positive finite number of s, got -1"),
        ({"time_limit": math.nan}, "got nan"),
        ({"memory_limit": 0.0}, "--memory-limit: expected a positive finite number of GiB, got 0"),
        ({"jobs": -2}, "--jobs: expected a number of processes, or 0 for none, got -2"),
        ({"memory_limit": 1.0, "jobs": 0}, "leave one of the two out"),
        ({"jobs": 2, "scheduler": "local:2"}, "--jobs and --scheduler exclude each other"),
    ],
)
def test_impossible_limits_are_refused(limits, words):
    with pytest.raises(LinkproofError, match=words):
        running(RunLimits(**limits))
