"""Drake against the closed form: torque, every joint's force and motion, its order, and what it does not take."""

import dataclasses
import sys

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.motion.case import Truth, scene
from engines.contract import Origin, Outcome, Setting
from engines.drake_adapter import DrakeEngine
from engines.scene import Channel, PinJoint, Prescribed
from engines.stepping.stepped_engine import plain
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import error_of, installed, run_of

ENGINE = DrakeEngine()
SHORT = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.01, start_angle=0.3)
STEPPED = 5e-4  # of the peak: rounding in slots at 6000 steps a turn; the rest is below 1e-4
KINDS = [
    "rimoldi-164",  # pins, and a guide on the ground
    "slotted-takeup",  # a mass on a pin in a slot that turns, and a damper on the crank
    "ground-pin-in-slot",
    "three-on-one-pin",
]


@pytest.fixture
def drake():
    installed("drake")


def errors_of(history, linkage, motion):
    """Of torque, every joint's force, and every body's place, velocity and acceleration."""
    truth, errors = Truth(linkage, motion, history.torque.time), {}
    errors["torque"] = error_of(history.torque.values, truth.torque)
    for joint, signal in history.joint_force.items():
        errors[joint] = error_of(signal.values, truth.joint_forces[joint].T)
    whole = Truth(linkage, motion, history.position.time)
    for number, body in enumerate(linkage.linkage.links):
        place, rate = (np.stack(np.broadcast_arrays(*whole.sweep.centre(body, order)), axis=-1) for order in (0, 1))
        errors[f"place of {body}"] = error_of(history.position.values[:, number, :2], place)
        velocity = rate * whole.speed[:, None]
        errors[f"velocity of {body}"] = error_of(history.velocity.values[:, number, :2], velocity)
    assert set(history.joint_force) == set(truth.joint_forces)
    return errors


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.usefixtures("drake")
def test_motion_torque_and_every_joint_force_are_those_of_the_closed_form(name):
    linkage = mechanism(name)
    history = run_of(ENGINE, linkage, SHORT, Setting.TUNED)
    errors = errors_of(history, linkage, SHORT)
    assert errors == {key: pytest.approx(0.0, abs=STEPPED) for key in errors}
    assert {signal.origin for signal in (history.torque, *history.joint_force.values())} == {Origin.READ}


@pytest.mark.usefixtures("drake")
def test_every_read_out_belongs_to_its_instant():
    """The error falls with the square of the step; torque, forces or speeds of half a step away would make it half."""
    linkage = mechanism("fork-takeup")
    given = scene(linkage, Prescribed(SHORT), frozenset(Channel))
    errors = []
    for ratio in (4, 8):
        engine = DrakeEngine()
        recipe = dataclasses.replace(ENGINE.settings[Prescribed][Setting.TUNED], ratios=(ratio,))
        engine.settings = {Prescribed: {Setting.TUNED: recipe}}
        errors.append(errors_of(engine.run(given, Setting.TUNED).history, linkage, SHORT))
    crank = linkage.linkage.crank  # turns as it is to, whatever the step
    names = [name for name in errors[0] if crank not in name]
    assert {name: errors[0][name] / errors[1][name] for name in names} == {
        name: pytest.approx(4.0, rel=0.2) for name in names
    }


@pytest.mark.usefixtures("drake")
def test_a_joint_force_acts_on_the_body_that_the_scene_names_first():
    linkage, motion = mechanism("rimoldi-164"), crank_motion("constant-speed", ramp_time=0.02, hold_time=0.0)
    pins = scene(linkage, Prescribed(motion), frozenset(Channel)).pins
    swapped = tuple(PinJoint(p.name, p.second, p.first, p.second_anchor, p.first_anchor) for p in pins)
    as_given, other = (run_of(ENGINE, linkage, motion, Setting.TUNED, pins=each) for each in (pins, swapped))
    for pin in pins:
        values = as_given.joint_force[pin.name].values
        off = np.abs(other.joint_force[pin.name].values + values).max()
        assert off < 1e-5 * np.abs(values).max()


@pytest.mark.usefixtures("drake")
def test_ports_as_shipped_and_a_drive_a_step_late_are_a_tenth_off():
    linkage = mechanism("juki-mf7923d")
    history = run_of(ENGINE, linkage, SHORT, Setting.NAIVE)
    assert error_of(history.torque.values, Truth(linkage, SHORT, history.torque.time).torque) > 0.1


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("carried-slider", "no slider or turn damper but on the ground"),
        ("moving-guides", "no slider or turn damper but on the ground"),
        ("spring-and-damper", "no point spring"),
        ("force-over-angle", "no applied torque"),
    ],
)
def test_what_drake_does_not_take_is_refused_in_a_sentence(name, words):
    given = scene(mechanism(name), Prescribed(SHORT), frozenset(Channel))
    assert words in (ENGINE.obstacle(given) or "")


def test_a_scene_is_described_in_plain_data_without_drake():
    given = scene(mechanism("slotted-takeup"), Prescribed(SHORT), frozenset(Channel))
    model = plain(ENGINE.model(given, ENGINE.settings[Prescribed][Setting.TUNED]))
    assert [name for name, *_ in model["joints"]] == [*(pin.name for pin in given.pins), given.slots[0].name]
    assert model["dampers"] == [("crank", "ground", 0.0002)]


def test_an_absent_drake_is_unavailable(monkeypatch):
    monkeypatch.setitem(sys.modules, "pydrake", None)
    run = ENGINE.run(scene(mechanism("juki-mf7923d"), Prescribed(SHORT), frozenset(Channel)), Setting.TUNED)
    assert run.outcome is Outcome.UNAVAILABLE
    assert "[drake]'" in run.reason
