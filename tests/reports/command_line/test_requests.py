"""From the user's words to a request, and back to the command that asks for the same."""

import math
import shlex

import pytest

from analytic.description.loading import catalogue, find
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.runs.failures import GIB
from comparisons.runs.workers import DEFAULT_BOUNDS, cores
from engines.contract import Setting
from engines.registry import engine_names
from reports.command_line import requests
from reports.command_line.requests import Choice, Effort, request


def test_no_words_mean_everything_tuned_on_the_default_ramp():
    wanted = request(Choice())
    assert tuple(linkage.name for linkage in wanted.linkages) == catalogue()
    assert [motion.regime for motion in wanted.motions] == ["run-up"]
    assert wanted.settings == (Setting.TUNED,)
    assert wanted.engines == engine_names()
    assert wanted.with_invariants


def test_words_become_si():
    choice = Choice(speed=3000.0, ramp_time=0.2, hold_time=0.3, start_angle=90.0, clockwise=True)
    (motion,) = requests.motions(choice)
    assert motion.angle(0.0) == pytest.approx(math.pi / 2)
    assert motion.speed(0.5) == pytest.approx(-100.0 * math.pi)
    assert motion.duration == pytest.approx(0.5)


def test_a_variant_without_mechanisms_means_those_that_have_it():
    wanted = request(Choice(variant="y-along"))
    assert [linkage.name for linkage in wanted.linkages] == ["rimoldi-164"]


def test_a_variant_that_a_named_mechanism_lacks_is_refused():
    with pytest.raises(UnknownNameError, match="variant of 'juki-mf7923d'"):
        request(Choice(("juki-mf7923d",), variant="y-along"))


def test_gravity_can_be_left_out():
    assert all(linkage.gravity == (0.0, 0.0) for linkage in request(Choice(gravity=False)).linkages)


def test_two_files_of_one_name_are_refused(tmp_path):
    copy = tmp_path / "juki-mf7923d.toml"
    copy.write_text(find("juki-mf7923d").read_text())
    with pytest.raises(LinkproofError, match="both called 'juki-mf7923d'"):
        request(Choice(("juki-mf7923d", str(copy))))


def test_a_quantity_leaves_the_invariants_out():
    assert not request(Choice(("juki-mf7923d",), quantities=("Jeq",))).with_invariants


@pytest.mark.parametrize(
    "choice",
    [
        Choice(),
        Choice(("juki-mf7923d",), "as-printed", ("run-up", "constant-speed"), ("direct",), ("naive", "best"), ("Mkr",)),
        Choice(speed=50.0, ramp_time=1.5, hold_time=0.0, start_angle=-30.0, clockwise=True, gravity=False),
        Choice(("path with spaces/mine.toml",)),
    ],
)
def test_the_command_asks_for_the_same(choice):
    words = shlex.split(choice.command)
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
    choices = [Choice(), Choice(speed=2000.0), Choice(clockwise=True), Choice(start_angle=1.0), Choice(gravity=False)]
    assert len({choice.conditions for choice in choices}) == len(choices)


def test_no_words_mean_the_usual_effort():
    Effort().check()
    assert Effort().bounds == DEFAULT_BOUNDS
    assert Effort().processes == cores()
    assert Effort().words == ""


def test_limits_become_bounds_and_stay_with_the_command():
    effort = Effort(time_limit=90.0, memory_limit=0.5, jobs=0)
    assert (effort.bounds.seconds, effort.bounds.memory, effort.processes) == (90.0, GIB // 2, 0)
    assert effort.words == " --time-limit 90 --memory-limit 0.5"


@pytest.mark.parametrize(
    ("effort", "words"),
    [
        (Effort(time_limit=-1.0), "--time-limit: expected a positive finite number of s, got -1"),
        (Effort(time_limit=math.nan), "got nan"),
        (Effort(memory_limit=0.0), "--memory-limit: expected a positive finite number of GiB, got 0"),
        (Effort(jobs=-2), "--jobs: expected a number of processes, or 0 for none, got -2"),
        (Effort(memory_limit=1.0, jobs=0), "leave one of the two out"),
    ],
)
def test_impossible_efforts_are_refused(effort, words):
    with pytest.raises(LinkproofError, match=words):
        effort.check()
