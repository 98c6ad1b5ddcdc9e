"""Simbody against the closed form: every joint and load, a free crank, and what it cannot hold."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.judging.quantities import chosen_quantities
from comparisons.reference.case import Truth, own_case
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.scene import Channel, Free, PinJoint, Prescribed, SlotJoint
from engines.simbody_adapter import SimbodyEngine
from tests.analytic.linkages import from_text, mechanism
from tests.engines.closed_form import error_of, errors_of, run_of

pytest.importorskip("opensim")

ENGINE = SimbodyEngine()
PROJECTED = 1e-9  # of the peak: what a tolerance of 1e-12 leaves near a toggle, a thousandth of it elsewhere
# Its second loop is closed between bodies that the crank carries: there Simbody tells forces in the axes of the crank.
ON_THE_CRANK = """
title = "dyad between the crank and the coupler"
source = "made up for this test"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [1.5, -9.81]
ground = { O1 = [0, 0], O2 = [90, 10] }
[links.crank]
points = { O1 = [0, 0], A = [25, 0], K = [10, 18] }
mass = 0.3
centre = [8, 4]
inertia = 5e-5
[links.coupler]
points = { A = [0, 0], B = [80, 0], L = [30, 25] }
mass = 0.2
centre = [35, 8]
inertia = 2e-4
[links.rocker]
points = { O2 = [0, 0], B = [60, 0] }
mass = 0.15
centre = [20, -5]
inertia = 9e-5
[links.left]
points = { K = [0, 0], M = [45, 0] }
mass = 0.05
centre = [20, 3]
inertia = 1e-5
[links.right]
points = { L = [0, 0], M = [40, 0] }
mass = 0.04
centre = [15, -2]
inertia = 8e-6
[sketch]
angle = 20
points = { B = [85, 70], M = [25, 60] }
"""
MADE_UP = {"dyad on the crank": ON_THE_CRANK}
KINDS = [
    "rimoldi-164",  # pins, and a guide on the ground
    "slotted-takeup",  # a mass on a pin in a slot that turns, and a damper on the crank
    "carried-slider",  # a body that slides and turns with its host
    "moving-guides",  # guides on hosts that slide, turn and rest
    "ground-pin-in-slot",
    "three-on-one-pin",
    "near-toggle",  # steps of this length must be divided
    "force-over-angle",
    "spring-and-damper",
    *MADE_UP,
]


def _linkage(name):
    return from_text(MADE_UP[name]) if name in MADE_UP else mechanism(name)


def _run(linkage, motion, setting=Setting.TUNED, **changes):
    return run_of(ENGINE, linkage, motion, setting, **changes)


@pytest.mark.parametrize("name", KINDS)
def test_motion_torque_and_every_joint_force_are_those_of_the_closed_form(name):
    linkage, motion = _linkage(name), crank_motion("run-up", ramp_time=0.12, hold_time=0.03, start_angle=0.3)
    history = _run(linkage, motion)
    errors = errors_of(history, linkage, motion)
    assert errors == {key: pytest.approx(0.0, abs=PROJECTED) for key in errors}


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
def test_a_crank_of_any_speed_is_held_to_the_closed_form(setting):
    linkage = mechanism("rimoldi-164")
    motion = crank_motion("run-up-quintic", speed=1e5, ramp_time=6e-4, hold_time=1e-4)
    history = _run(linkage, motion, setting)
    assert error_of(history.torque.values, Truth(linkage, motion, history.torque.time).torque) < 1e-8


def test_a_crank_that_cannot_go_on_is_diverged_with_the_reason_of_the_engine():
    blocked = from_text(ON_THE_CRANK.replace("B = [80, 0]", "B = [45, 0]").replace("B = [85, 70]", "B = [60, 45]"))
    motion = crank_motion("constant-speed", speed=5.0, ramp_time=0.5, hold_time=0.0, start_angle=0.3)
    given = scene(blocked, Prescribed(motion), frozenset(Channel))
    run = ENGINE.run(given, Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "Unable to advance time" in run.reason


def test_a_joint_force_acts_on_the_body_that_the_scene_names_first():
    linkage, motion = mechanism("rimoldi-164"), crank_motion("constant-speed", ramp_time=0.02, hold_time=0.0)
    pins = scene(linkage, Prescribed(motion), frozenset(Channel)).pins
    swapped = tuple(PinJoint(p.name, p.second, p.first, p.second_anchor, p.first_anchor) for p in pins)
    as_given, other = _run(linkage, motion), _run(linkage, motion, pins=swapped)
    for pin in pins:
        np.testing.assert_allclose(
            other.joint_force[pin.name].values, -as_given.joint_force[pin.name].values, rtol=1e-6, atol=1e-9
        )
    np.testing.assert_allclose(other.torque.values, as_given.torque.values, rtol=1e-6, atol=1e-9)


def test_a_flywheel_without_mass_is_refused_since_opensim_would_drop_its_inertia():
    linkage, motion = mechanism("juki-mf7923d"), crank_motion("constant-speed", ramp_time=0.02, hold_time=0.0)
    given = scene(linkage, Prescribed(motion), frozenset(Channel))
    bodies = tuple(dataclasses.replace(body, mass=0.0) if body.name == given.crank else body for body in given.bodies)
    run = ENGINE.run(dataclasses.replace(given, bodies=bodies), Setting.TUNED)
    assert run.outcome is Outcome.UNSUPPORTED
    assert run.reason == "it takes no inertia of a body without mass, as 'crank' has"


def test_a_mass_on_a_pin_may_carry_another_body():
    linkage, motion = mechanism("slotted-takeup"), crank_motion("constant-speed", ramp_time=0.06, hold_time=0.0)
    given = scene(linkage, Prescribed(motion), frozenset(Channel))
    (on_pin,) = (pin for pin in given.pins if "slot_slider" in (pin.first, pin.second))
    coupler = next(body for body in given.bodies if body.name == "coupler")
    anchor = on_pin.second_anchor if on_pin.second == "coupler" else on_pin.first_anchor
    # A wheel on the same pin, balanced and at rest: the mass on the pin carries it, and it moves as the pin does.
    cosine, sine = np.cos(coupler.angle), np.sin(coupler.angle)
    place = tuple(coupler.position + np.array([[cosine, -sine], [sine, cosine]]) @ anchor)
    slider = next(body for body in given.bodies if body.name == "slot_slider")
    assert place == pytest.approx(slider.position, abs=1e-12)
    wheel = dataclasses.replace(slider, name="wheel", mass=0.01, inertia=1e-6, angle=0.2)
    joint = PinJoint("wheel", "wheel", "slot_slider", (0.0, 0.0), (0.0, 0.0))
    history = _run(linkage, motion, bodies=(*given.bodies, wheel), pins=(*given.pins, joint))
    names = [*(body.name for body in given.bodies), "wheel"]
    at = {name: history.position.values[:, names.index(name)] for name in ("wheel", "slot_slider")}
    np.testing.assert_allclose(at["wheel"][:, :2], at["slot_slider"][:, :2], atol=1e-12)
    np.testing.assert_allclose(at["wheel"][:, 2], 0.2, atol=1e-6)  # nothing turns it
    np.testing.assert_allclose(at["slot_slider"][:, 2], slider.angle, atol=1e-12)
    acceleration = history.acceleration.values[:, names.index("wheel"), :2]
    weight = acceleration - given.gravity
    np.testing.assert_allclose(history.joint_force["wheel"].values, 0.01 * weight, atol=1e-8 * np.abs(weight).max())


@pytest.mark.parametrize(("regime", "duration"), [("free", 10.0), ("driven", 2.0)])
def test_a_released_crank_keeps_its_phase(regime, duration):
    linkage = mechanism("slotted-takeup")
    released = next(r for r in linkage.linkage.regimes if r.name == regime)
    case = own_case(linkage, dataclasses.replace(released, duration=duration))
    run = ENGINE.run(case.scene(frozenset({Channel.POSITION})), Setting.TUNED)
    phi = next(quantity for quantity in chosen_quantities(case, ()) if quantity.name == "phi")
    crank = [body.name for body in case.scene(frozenset()).bodies].index("crank")
    position = run.history.position
    np.testing.assert_allclose(position.values[:, crank, 2], phi.reference(case, position.time), rtol=0, atol=1e-6)


def _varying(given):
    return dataclasses.replace(given, drive=Free(0.1, 1.0))


def _on_slots_alone(given):
    pins = tuple(pin for pin in given.pins if "rod" not in (pin.first, pin.second))
    held = SlotJoint("held", "rod", (0.0, 0.0), "crank", (0.0, 0.0), (1.0, 0.0))
    return dataclasses.replace(given, pins=pins, slots=(held,))


def _loop_of_sliders(given):
    again = dataclasses.replace(given.sliders[0], name="again")
    return dataclasses.replace(given, sliders=(*given.sliders, again))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_varying, "changes with its angle"),
        (_on_slots_alone, "only slots hold 'rod'"),
        (_loop_of_sliders, "no constraint for 'again'"),
    ],
)
def test_what_simbody_cannot_hold_is_unsupported_in_one_sentence(change, words, monkeypatch):
    monkeypatch.setattr("engines.stepping.stepped_engine.data_obstacle", lambda scene, massless: None)
    given = scene(mechanism("force-over-angle"), Prescribed(crank_motion()), frozenset(Channel))
    run = ENGINE.run(change(given), Setting.TUNED)
    assert run.outcome is Outcome.UNSUPPORTED
    assert words in run.reason


def test_opensim_neither_prints_nor_leaves_a_file(tmp_path):
    script = (
        "from tests.engines.test_simbody_adapter import ENGINE, Channel, Prescribed, Setting\n"
        "from tests.engines.test_simbody_adapter import crank_motion, mechanism, scene\n"
        "given = scene(mechanism('fork-takeup'), Prescribed(crank_motion(ramp_time=0.02)), frozenset(Channel))\n"
        "print(ENGINE.run(given, Setting.NAIVE).outcome)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr, list(tmp_path.iterdir())) == ("finished\n", "", [])
