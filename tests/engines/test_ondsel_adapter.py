"""Ondsel against the closed form: every joint, the slots that it gets wrong by itself, and what it cannot hold."""

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.ondsel_adapter import OndselEngine
from engines.scene import Channel, Free, PinJoint, Prescribed
from tests.analytic.linkages import from_text, mechanism
from tests.engines.closed_form import error_of, errors_of, run_of

pytest.importorskip("pyondsel")

ENGINE = OndselEngine()
ROUNDING = 1e-11  # of the peak: what a solution at every instant leaves
KINDS = [
    "rimoldi-164",  # pins, and a guide on the ground
    "slotted-takeup",  # a slot that turns, and a damper on the crank
    "carried-slider",  # a body that slides and turns with its host
    "moving-guides",  # guides on hosts that slide, turn and rest
    "ground-pin-in-slot",
    "slot-without-mass",
    "three-on-one-pin",
]
# The crank is a bar with a slot through its pivot; the slot pushes a block along y = 0.1 m.
PUSHED_BLOCK = """
title = "block pushed by a slotted bar"
source = "made up for this test"
units = { length = "m", mass = "kg", inertia = "kg*m^2", angle = "rad" }
crank = "bar"
ground = { O = [0, 0] }
slots = [{ point = "P", on = "bar", through = [0, 0], along = [1, 0] }]
[links.bar]
points = { O = [0, 0], E = [0.3, 0] }
mass = 1.0
centre = [0.1, 0]
inertia = 1e-3
[links.block]
slides = { point = "P", through = [0, 0.1], along = [1, 0] }
mass = 0.5
[sketch]
angle = 1.0
"""


def _run(linkage, motion, setting=Setting.TUNED, **changes):
    return run_of(ENGINE, linkage, motion, setting, **changes)


@pytest.mark.parametrize("name", KINDS)
def test_motion_torque_and_every_joint_force_are_those_of_the_closed_form(name):
    linkage, motion = mechanism(name), crank_motion("run-up", ramp_time=0.12, hold_time=0.03, start_angle=0.3)
    history = _run(linkage, motion)
    errors = errors_of(history, linkage, motion)
    assert errors == {key: pytest.approx(0.0, abs=ROUNDING) for key in errors}
    crank = list(linkage.linkage.links).index(linkage.linkage.crank)
    np.testing.assert_allclose(
        history.position.values[:, crank, 2], motion.angle(history.torque.time), rtol=0, atol=1e-12
    )


def test_a_joint_force_acts_on_the_body_that_the_scene_names_first():
    linkage, motion = mechanism("juki-mf7923d"), crank_motion("constant-speed", ramp_time=0.02, hold_time=0.0)
    pins = scene(linkage, Prescribed(motion), frozenset(Channel)).pins
    swapped = tuple(PinJoint(p.name, p.second, p.first, p.second_anchor, p.first_anchor) for p in pins)
    as_given, other = _run(linkage, motion), _run(linkage, motion, pins=swapped)
    for pin in pins:
        np.testing.assert_allclose(
            other.joint_force[pin.name].values, -as_given.joint_force[pin.name].values, rtol=1e-9
        )
    np.testing.assert_allclose(other.torque.values, as_given.torque.values, rtol=1e-9)


def test_every_solution_has_a_folder_of_its_own_for_files_of_fixed_names(monkeypatch):
    from engines import ondsel_loop  # noqa: PLC0415 - it imports pyondsel

    before, seen = os.environ.get("TMPDIR"), []
    solve = ondsel_loop.solve_asmt

    def solved(*args, **options):
        seen.append(os.environ["TMPDIR"])
        assert Path(seen[-1]).is_dir()
        return solve(*args, **options)

    monkeypatch.setattr(ondsel_loop, "solve_asmt", solved)
    _run(mechanism("juki-mf7923d"), crank_motion("run-up", ramp_time=0.02, hold_time=0.01))
    assert len(set(seen)) == len(seen) > 1
    assert os.environ.get("TMPDIR") == before
    assert not any(map(os.path.exists, seen))


def test_the_accelerations_of_a_slot_that_turns_are_wrong_by_a_known_formula_and_right_in_tuned():
    height, speed = 0.1, 5.0
    linkage = from_text(PUSHED_BLOCK)
    motion = crank_motion("constant-speed", speed=speed, ramp_time=0.3, hold_time=0.0, start_angle=0.6)
    shown = {setting: _run(linkage, motion, setting).acceleration for setting in (Setting.NAIVE, Setting.TUNED)}
    angle = motion.angle(shown[Setting.NAIVE].time)
    sine, cosine = np.sin(angle), np.cos(angle)
    true = 2.0 * height * speed**2 * cosine / sine**3  # of x = height / tan(angle)
    # The pin is height / sine along the slot; an error across the slot moves the block 1 / sine times as far.
    slip = 0.5 * sine * (sine - cosine) * speed**2 * (height / sine) / sine
    block = list(linkage.linkage.links).index("block")
    assert error_of(shown[Setting.TUNED].values[:, block, 0], true) < ROUNDING
    assert error_of(shown[Setting.NAIVE].values[:, block, 0] - true, slip) < 1e-9
    assert np.abs(slip).max() > 0.05 * np.abs(true).max()


@pytest.mark.parametrize(
    ("name", "drive", "words"),
    [
        ("juki-mf7923d", Free(0.1, 1.0), "free drive"),
        ("force-over-angle", None, "applied force"),
        ("spring-and-damper", None, "point spring"),
    ],
)
def test_what_ondsel_cannot_hold_is_unsupported_in_one_sentence(name, drive, words):
    given = scene(mechanism(name), drive or Prescribed(crank_motion()), frozenset(Channel))
    run = ENGINE.run(given, Setting.TUNED)
    assert run.outcome is Outcome.UNSUPPORTED
    assert words in run.reason


def test_a_damper_elsewhere_than_on_the_crank_is_unsupported():
    given = scene(mechanism("slotted-takeup"), Prescribed(crank_motion()), frozenset(Channel))
    damper = dataclasses.replace(given.dampers[0], first="coupler")
    run = ENGINE.run(dataclasses.replace(given, dampers=(damper,)), Setting.TUNED)
    assert (run.outcome, "between the crank" in run.reason) == (Outcome.UNSUPPORTED, True)


def test_a_crank_that_cannot_go_on_is_diverged_and_not_a_shorter_motion():
    blocked = from_text(PUSHED_BLOCK.replace("through = [0, 0], along = [1, 0]", "through = [0, 0.2], along = [1, 0]"))
    motion = crank_motion("constant-speed", speed=5.0, ramp_time=0.5, hold_time=0.0, start_angle=1.0)
    run = ENGINE.run(scene(blocked, Prescribed(motion), frozenset(Channel)), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "frames" in run.reason
