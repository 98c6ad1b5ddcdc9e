"""MJX and MuJoCo Warp against the closed form, and the clock that drives them."""

import sys
from xml.etree.ElementTree import fromstring

import pytest

from comparisons.trials.conformance.trial import case, scene_of
from comparisons.trials.judging.limits import limit
from engines.contract import Origin, Outcome, Setting
from engines.registry import engine
from engines.scene import Prescribed
from tests.engines.closed_form import errors_of, history_of, installed

NAMES = ("mjx", "mujoco-warp")
QUANTITIES = {"torque": "Mkr", "position": "S", "velocity": "v", "acceleration": "a"}  # all others are joints


@pytest.mark.nightly
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("sample", ["four-bar", "quick return", "damper"])  # a hinge is cut; a slot; a tendon
def test_motion_torque_and_every_joint_force_are_those_of_the_closed_form(name, sample):
    history = history_of(installed(name), scene_of(sample))
    errors = errors_of(history, case(sample).mechanism, case(sample).motion)
    regime = case(sample).motion.regime
    bounds = {
        key: limit(QUANTITIES.get(key.removeprefix("angular "), "joint_force"), "tuned", regime, name).value
        for key in errors
    }
    assert {key: errors[key] for key in errors if errors[key] > bounds[key]} == {}
    assert {signal.origin for signal in (history.torque, *history.joint_force.values())} == {Origin.READ}


@pytest.mark.parametrize("name", NAMES)
def test_the_clock_is_the_last_body_and_the_driven_joint_follows_it(name):
    adapter = engine(name)
    given = adapter.model(scene_of("slider-crank"), adapter.settings[Prescribed][Setting.TUNED])
    root = fromstring(given["xml"])
    assert root.findall(".//body")[-1].get("name") == "/clock"
    drive = root.find("equality/joint")
    assert (drive.get("joint1"), drive.get("joint2"), drive.get("polycoef")) == ("crank", "/clock", "0 1 0 0 0")


@pytest.mark.parametrize("name", NAMES)
def test_an_absent_engine_is_unavailable_and_a_free_crank_unsupported(name, monkeypatch):
    adapter = engine(name)
    monkeypatch.setitem(sys.modules, adapter.package, None)
    run = adapter.run(scene_of("four-bar"), Setting.TUNED)
    assert (run.outcome, f"[{name}]'" in run.reason) == (Outcome.UNAVAILABLE, True)
    assert "free" in adapter.obstacle(scene_of("released"))
