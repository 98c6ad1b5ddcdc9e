"""MuJoCo against the closed form: every joint and load, a released crank, and what is not the motion."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.judging.quantities import chosen_quantities
from comparisons.reference.case import Truth, own_case
from comparisons.reference.start_state import scene
from engines.contract import Origin, Outcome, Setting
from engines.mujoco_adapter import EXPERT, MujocoEngine
from engines.scene import Channel, PinJoint, Prescribed, SliderJoint
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import error_of, errors_of, run_of

pytest.importorskip("mujoco")

ENGINE = MujocoEngine()
STEPPED = 1e-6  # of the peak: what RK4 leaves in runs as short and as sharp as these
KINDS = [
    "rimoldi-164",  # pins, and a guide on the ground
    "slotted-takeup",  # a mass on a pin in a slot that turns, and a damper on the crank
    "carried-slider",  # a body that slides and turns with its host
    "moving-guides",  # guides on hosts that slide, turn and rest
    "ground-pin-in-slot",
    "slot-without-mass",
    "three-on-one-pin",
    "force-over-angle",
    "spring-and-damper",
]


def _run(linkage, motion, setting=Setting.TUNED, **changes):
    return run_of(ENGINE, linkage, motion, setting, **changes)


@pytest.mark.parametrize("name", KINDS)
def test_motion_torque_and_every_joint_force_are_those_of_the_closed_form(name):
    linkage, motion = mechanism(name), crank_motion("run-up", ramp_time=0.06, hold_time=0.02, start_angle=0.3)
    history = _run(linkage, motion)
    truth, errors = Truth(linkage, motion, history.torque.time), errors_of(history, linkage, motion)
    crank = list(linkage.linkage.links).index(linkage.linkage.crank)
    errors["angle of the crank"] = error_of(history.position.values[:, crank, 2], motion.angle(truth.time))
    errors["acceleration of the crank"] = error_of(history.acceleration.values[:, crank, 2], truth.acceleration)
    assert errors == {key: pytest.approx(0.0, abs=STEPPED) for key in errors}
    assert {signal.origin for signal in (history.torque, *history.joint_force.values())} == {Origin.READ}


@pytest.mark.parametrize("name", ["carried-slider", "moving-guides", "ground-pin-in-slot"])
def test_a_crank_that_turns_at_the_start_moves_every_link_as_the_scene_says(name):
    given = scene(mechanism(name), Prescribed(crank_motion("constant-speed", ramp_time=0.001)), frozenset(Channel))
    velocity = ENGINE.run(given, Setting.TUNED).history.velocity.values[0]
    wanted = np.array([(*body.velocity, body.angular_velocity) for body in given.bodies])
    np.testing.assert_allclose(velocity, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())


def test_a_joint_force_acts_on_the_body_that_the_scene_names_first():
    linkage, motion = mechanism("rimoldi-164"), crank_motion("constant-speed", ramp_time=0.02, hold_time=0.0)
    pins = scene(linkage, Prescribed(motion), frozenset(Channel)).pins
    swapped = tuple(PinJoint(p.name, p.second, p.first, p.second_anchor, p.first_anchor) for p in pins)
    as_given, other = _run(linkage, motion), _run(linkage, motion, pins=swapped)
    for pin in pins:
        values = as_given.joint_force[pin.name].values
        np.testing.assert_allclose(
            other.joint_force[pin.name].values, -values, rtol=0, atol=1e-6 * np.abs(values).max()
        )
    np.testing.assert_allclose(other.torque.values, as_given.torque.values, rtol=0, atol=1e-6)


@pytest.mark.parametrize(("regime", "duration"), [("free", 10.0), ("driven", 2.0)])
def test_a_released_crank_keeps_its_phase(regime, duration):
    linkage = mechanism("slotted-takeup")
    released = next(r for r in linkage.linkage.regimes if r.name == regime)
    case = own_case(linkage, dataclasses.replace(released, duration=duration))
    run = ENGINE.run(case.scene(frozenset({Channel.POSITION})), Setting.TUNED)
    crank = list(linkage.linkage.links).index(linkage.linkage.crank)
    (phi,) = (quantity for quantity in chosen_quantities(case, ()) if quantity.name == "phi")
    position = run.history.position
    assert np.abs(position.values[:, crank, 2] - phi.reference(case, position.time)).max() < 1e-6


def test_forces_are_read_at_the_state_and_not_a_step_away_from_it():
    """The error falls with the fourth power of the step; forces of another instant would make it the first."""
    linkage, motion = mechanism("fork-takeup"), crank_motion("constant-speed", ramp_time=0.06, hold_time=0.0)
    given = scene(linkage, Prescribed(motion), frozenset(Channel))
    errors = []
    for ratio in (1, 2):
        engine = MujocoEngine()
        recipe = dataclasses.replace(EXPERT, steps_per_turn=100, ratios=(ratio,))
        engine.settings = {Prescribed: {Setting.TUNED: recipe}}
        run = engine.run(given, Setting.TUNED)
        truth = Truth(linkage, motion, run.history.torque.time)
        errors.append(error_of(run.history.torque.values, truth.torque))
    assert 12.0 < errors[0] / errors[1] < 20.0


def test_mujocos_own_stiffness_gives_way_by_more_than_a_tenth():
    linkage, motion = mechanism("juki-mf7923d"), crank_motion("run-up-quintic", ramp_time=0.12, hold_time=0.03)
    history = _run(linkage, motion, Setting.NAIVE)
    assert error_of(history.torque.values, Truth(linkage, motion, history.torque.time).torque) > 0.1


def test_a_linkage_that_breaks_is_diverged_and_mujoco_leaves_no_file(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    given = scene(mechanism("juki-mf7923d"), Prescribed(crank_motion("constant-speed")), frozenset(Channel))
    methods = {method.name: method for method in ENGINE.methods(given)}
    run = ENGINE.run_method(given, methods["Euler"], 0.1)
    assert run.outcome is Outcome.DIVERGED
    assert "unstable" in run.reason
    assert (list(tmp_path.iterdir()), *capfd.readouterr()) == ([], "", "")


def test_a_slider_that_closes_a_loop_of_sliders_is_unsupported():
    given = scene(mechanism("juki-mf7923d"), Prescribed(crank_motion()), frozenset(Channel))
    bar = next(body for body in given.bodies if body.name == given.sliders[0].body)
    again = dataclasses.replace(given.sliders[0], name="second guide", anchor=(0.0, 0.0), through=bar.position)
    assert isinstance(again, SliderJoint)
    run = ENGINE.run(dataclasses.replace(given, sliders=(*given.sliders, again)), Setting.TUNED)
    assert (run.outcome, "second guide" in run.reason) == (Outcome.UNSUPPORTED, True)
