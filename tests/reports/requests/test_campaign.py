"""From the user's words to a request, and back to the command that asks for the same."""

import math
import re
import shlex
from pathlib import Path

import pytest

from analytic.description.loading import catalogue, find
from analytic.errors import LinkproofError, UnknownNameError
from analytic.machine_code.compiling import cores
from comparisons.campaign.campaign import cases
from comparisons.runs.failures import GIB
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds
from engines.contract import Setting
from engines.registry import engine_names
from reports.requests import campaign
from reports.requests.campaign import installed, left_out, linkages, request, requested_engines
from reports.requests.motions import prescribed
from reports.requests.options.campaign import CompareOptions, RunLimits
from reports.requests.options.declaring import command_line, stated
from reports.requests.running import Running, running
from tests.counting import calls


def test_no_words_mean_everything_tuned_on_the_default_ramp():
    wanted = request(CompareOptions())
    assert tuple(linkage.name for linkage in wanted.linkages) == catalogue()
    assert [motion.regime for motion in wanted.motions] == ["run-up"]
    assert wanted.settings == (Setting.TUNED,)
    assert wanted.engines == tuple(installed(engine_names()))
    assert wanted.with_invariants


def test_engines_that_are_not_installed_are_left_out_with_a_remark_unless_engines_are_named(monkeypatch):
    monkeypatch.setattr(campaign, "why_unavailable", lambda adapter: "not here" if adapter.name != "direct" else None)
    assert request(CompareOptions()).engines == ("direct",)
    assert left_out(("direct",)).startswith("not installed, left out: drake, exudyn, mujoco")
    assert left_out(("pymunk",)) == ""
    monkeypatch.setattr(campaign, "why_unavailable", lambda _: "not here")
    with pytest.raises(LinkproofError, match="no engine is installed: install one"):
        requested_engines(())


def test_words_become_si():
    choice = CompareOptions(speed=3000.0, ramp_time=0.2, hold_time=0.3, start_angle=90.0, clockwise=True)
    ((motion,), _) = prescribed(choice, [])
    assert motion.angle(0.0) == pytest.approx(math.pi / 2)
    assert motion.speed(0.5) == pytest.approx(-100.0 * math.pi)
    assert motion.duration == pytest.approx(0.5)


def test_a_variant_without_mechanisms_means_those_that_have_it():
    wanted = request(CompareOptions(variant="y-along"))
    assert [linkage.name for linkage in wanted.linkages] == ["rimoldi-164"]


def test_a_variant_that_a_named_mechanism_lacks_is_refused():
    with pytest.raises(UnknownNameError, match="variant of 'juki-mf7923d'"):
        request(CompareOptions(mechanisms=("juki-mf7923d",), variant="y-along"))


def test_gravity_can_be_left_out():
    assert all(linkage.gravity == (0.0, 0.0) for linkage in request(CompareOptions(gravity=False)).linkages)


def test_two_files_of_one_name_bear_the_names_of_their_folders(tmp_path):
    paths = [tmp_path / folder / "juki-mf7923d.toml" for folder in ("old", "new")]
    for path in paths:
        path.parent.mkdir()
        path.write_text(find("juki-mf7923d").read_text())
    names = [
        linkage.name for linkage in request(CompareOptions(mechanisms=("juki-mf7923d", *map(str, paths)))).linkages
    ]
    assert names == ["juki-mf7923d", "old-juki-mf7923d", "new-juki-mf7923d"]


def test_a_file_that_is_named_twice_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "mine.toml"
    path.write_text(find("juki-mf7923d").read_text())
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LinkproofError, match=r"both called '.*-mine'"):
        request(CompareOptions(mechanisms=("mine.toml", str(path))))


def test_a_quantity_leaves_the_invariants_out():
    assert not request(CompareOptions(mechanisms=("juki-mf7923d",), quantity=("Jeq",))).with_invariants


@pytest.mark.parametrize(
    "choice",
    [
        CompareOptions(),
        CompareOptions(
            mechanisms=("juki-mf7923d",),
            engine=("direct",),
            setting=("naive", "best"),
            quantity=("Mkr",),
            variant="as-printed",
            regime=("run-up", "constant-speed"),
        ),
        CompareOptions(speed=50.0, ramp_time=1.5, hold_time=0.0, start_angle=-30.0, clockwise=True, gravity=False),
        CompareOptions(mechanisms=("path with spaces/mine.toml",)),
    ],
)
def test_the_command_asks_for_the_same(choice):
    words = shlex.split(command_line("compare", choice))
    assert words[:2] == ["linkproof", "compare"]
    options = {"--variant": "variant", "--speed": "speed", "--ramp-time": "ramp_time", "--start-angle": "start_angle"}
    for option, name in options.items():
        if option in words:
            value = getattr(choice, name)
            assert words[words.index(option) + 1] == (value if isinstance(value, str) else f"{value:g}")
    assert ("--clockwise" in words) == choice.clockwise
    assert ("--no-gravity" in words) != choice.gravity
    assert [w for w in words[2:] if w in choice.mechanisms] == list(choice.mechanisms)


def test_conditions_tell_campaigns_apart():
    choices = [
        CompareOptions(),
        CompareOptions(speed=2000.0),
        CompareOptions(clockwise=True),
        CompareOptions(start_angle=1.0),
    ]
    assert len({choice.conditions for choice in choices}) == len(choices)


def test_no_words_mean_the_default_limits():
    assert running(RunLimits()) == Running(DEFAULT_BOUNDS, cores(), None)
    assert stated(RunLimits()) == {}


def test_limits_become_bounds_and_stay_with_the_command():
    limits = RunLimits(time_limit=90.0, memory_limit=0.5, jobs=0)
    assert running(RunLimits(time_limit=90.0, memory_limit=0.5)).bounds == Bounds(90.0, GIB // 2)
    assert running(RunLimits(jobs=0)).processes == 0
    assert stated(limits) == {"time-limit": ("90",), "memory-limit": ("0.5",)}


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (RunLimits(time_limit=-1.0), "--time-limit: expected a positive finite number of s, got -1"),
        (RunLimits(time_limit=math.nan), "got nan"),
        (RunLimits(memory_limit=0.0), "--memory-limit: expected a positive finite number of GiB, got 0"),
        (RunLimits(jobs=-2), "--jobs: expected a number of processes, or 0 for none, got -2"),
        (RunLimits(memory_limit=1.0, jobs=0), "leave one of the two out"),
    ],
)
def test_impossible_limits_are_refused(limits, words):
    with pytest.raises(LinkproofError, match=words):
        running(limits)


@pytest.mark.parametrize(
    ("choice", "words"),
    [
        (CompareOptions(speed=0.0), "--speed: expected a finite number of rpm other than 0, got 0"),
        (
            CompareOptions(speed=1e14),
            "--speed: expected a finite number of rpm other than 0 up to 9.55e\\+12, got 1e\\+14",
        ),
        (CompareOptions(ramp_time=0.0), "--ramp-time: expected a positive finite number of s, got 0"),
        (CompareOptions(hold_time=-1.0), "--hold-time: expected a finite, not negative number of s, got -1"),
        (CompareOptions(start_angle=math.inf), "--start-angle: expected a finite number of degrees, got inf"),
        (CompareOptions(regime=("constant-speed",), ramp_time=0.0, hold_time=0.0), "--hold-time: expected a positive"),
        (CompareOptions(regime=("constant-speed", "run-up"), ramp_time=0.0), "--ramp-time: expected a positive"),
    ],
)
def test_what_no_crank_can_do_is_refused_in_the_units_of_the_option(choice, words):
    with pytest.raises(LinkproofError, match=words):
        request(choice)


def test_a_constant_speed_needs_no_ramp():
    (motion,) = request(CompareOptions(regime=("constant-speed",), ramp_time=0.0, hold_time=0.1)).motions
    assert motion.duration == pytest.approx(0.1)


def test_the_command_keeps_every_digit():
    angle = 78.79541471699513
    assert f"--start-angle {angle!r}" in command_line("compare", CompareOptions(start_angle=angle))


def test_gravity_is_on_where_the_linkage_has_it(tmp_path):
    weightless = tmp_path / "weightless.toml"
    weightless.write_text(re.sub("^gravity.*$", "", find("juki-mf7923d").read_text(), flags=re.MULTILINE))
    conditions = {
        case.mechanism.linkage.name: case.conditions
        for case in cases(request(CompareOptions(mechanisms=("juki-mf7923d", str(weightless)))))
    }
    assert conditions["juki-mf7923d"].endswith(", gravity on")
    assert conditions["weightless"].endswith(", gravity off")


def test_a_linkage_file_is_read_once_and_its_text_kept(monkeypatch):
    reads = calls(monkeypatch, Path, "read_text")
    chosen = linkages(CompareOptions(mechanisms=("juki-mf7923d", "rimoldi-164"), variant="as-printed", gravity=False))
    assert [linkage.variant for linkage in chosen] == ["as-printed", "as-printed"]
    assert [path.stem for (path,) in reads if path.suffix == ".toml"] == ["juki-mf7923d", "rimoldi-164"]
    assert chosen[0].text.startswith("# Juki MF-7923D")
