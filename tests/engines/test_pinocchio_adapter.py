"""Pinocchio against the closed form: torque, every joint's force and motion, its order, and what it does not take."""

import dataclasses
import re
from pathlib import Path

import pytest

from analytic.description.crank_motion import crank_motion
from engines.contract import Setting
from engines.pinocchio_adapter import PinocchioEngine
from engines.scene import PinJoint, Prescribed
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import driven, error_of, errors_of, installed, run_of

SHORT = crank_motion("run-up", ramp_time=0.06, hold_time=0.02, start_angle=0.3)
LIMIT = 2e-6  # of the peak; all but carried-slider, near a toggle, is below 1e-7
KINDS = [
    "rimoldi-164",  # pins, and a guide on the ground
    "slotted-takeup",  # a mass on a pin in a slot that turns, and a damper on the crank
    "carried-slider",  # a body that slides and turns with its host
    "moving-guides",  # guides on hosts that slide, turn and rest
    "ground-pin-in-slot",
    "scotch-yoke",  # a slot in a body that does not turn
    "three-on-one-pin",
    "force-over-angle",
]

PAGE = (Path(__file__).parents[2] / "docs/engines.md").read_text(encoding="utf-8")
SCRIPTS = re.findall(
    r"```text\n(import numpy as np\nimport pinocchio as pin\n.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL
)


def run(linkage, setting=Setting.TUNED, ratio=4, **changes):
    installed("pinocchio")
    engine = PinocchioEngine()
    if setting is Setting.TUNED:
        engine.settings = {
            Prescribed: {setting: dataclasses.replace(engine.settings[Prescribed][setting], ratios=(ratio,))}
        }
    return run_of(engine, linkage, SHORT, setting, **changes)


@pytest.mark.parametrize("name", KINDS)
def test_motion_torque_and_every_joint_force_are_those_of_the_closed_form(name):
    errors = errors_of(run(mechanism(name)), mechanism(name), SHORT)
    assert {key: error for key, error in errors.items() if not error < LIMIT} == {}


def test_every_read_out_belongs_to_its_instant():
    """The error falls with the fourth power of the step; a read-out of another instant would make it the first."""
    linkage = mechanism("fork-takeup")
    coarse, fine = (errors_of(run(linkage, ratio=ratio), linkage, SHORT) for ratio in (2, 4))
    assert {name: coarse[name] / fine[name] for name in coarse} == dict.fromkeys(coarse, pytest.approx(16.0, rel=0.1))


def test_a_joint_force_acts_on_the_body_that_the_scene_names_first():
    linkage = mechanism("rimoldi-164")
    pins = driven(linkage, SHORT).pins
    swapped = tuple(PinJoint(p.name, p.second, p.first, p.second_anchor, p.first_anchor) for p in pins)
    given, other = (run(linkage, pins=each) for each in (pins, swapped))
    for pin in pins:
        assert error_of(other.joint_force[pin.name].values, -given.joint_force[pin.name].values) < 1e-7
    assert error_of(other.torque.values, given.torque.values) < 1e-7


def test_a_newcomers_steps_are_a_hundredth_off():
    linkage = mechanism("juki-mf7923d")
    assert errors_of(run(linkage, Setting.NAIVE), linkage, SHORT)["torque"] > 1e-2


def test_what_is_not_taken_is_refused_in_a_sentence():
    assert "no point spring" in (PinocchioEngine().obstacle(driven(mechanism("spring-and-damper"), SHORT)) or "")


@pytest.mark.parametrize(("script", "shown"), SCRIPTS)
def test_a_script_of_the_documentation_prints_what_stands_below_it(script, shown, capsys):
    installed("pinocchio")
    exec(script, {})
    assert capsys.readouterr().out == shown
