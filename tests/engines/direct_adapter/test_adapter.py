"""The second derivation against the closed form and the laws of mechanics, and on scenes that cannot be solved."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from analytic.description.linkage import GROUND
from analytic.dynamics.released import free_motion
from analytic.errors import LinkproofError
from comparisons.motion.case import scene
from engines.contract import Outcome, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import Body, Channel, Free, PinJoint, Prescribed, Scene
from tests.analytic.linkages import (
    FULL_TURN,
    MADE_UP,
    ODD,
    double_rocker_text,
    four_bar,
    from_text,
    mechanism,
    on_trial,
)
from tests.engines.closed_form import EVERYTHING, crank_number, driven, errors_of, history_of, with_body

ENGINE = DirectEngine()

# Errors relative to the peak.
SAME = 1e-12  # two derivations of one linkage
NEAR_TOGGLE = 1e-9  # one linkage is made to magnify the rounding of its own lengths a millionfold
BALANCE = 1e-12  # of the largest force: Newton's and Euler's laws on the bodies of a run
LONG_ANGLE = 1e-9  # rad after ten seconds and 160 turns

BARE = [pytest.param(*each, False, marks=pytest.mark.nightly) for each in FULL_TURN]
LADEN = [pytest.param(name, None, True, marks=pytest.mark.nightly if k % 2 else ())
         for k, name in enumerate((*MADE_UP, *ODD)) if name != "parallelogram"]  # fmt: skip
CATALOGUE = [pytest.param(*each, True, marks=pytest.mark.nightly) for each in FULL_TURN if each[0] not in MADE_UP]


def _refusal(model):
    run = ENGINE.run(model, Setting.TUNED)
    assert run.outcome is Outcome.UNSUPPORTED
    return run.reason


def _motion(regime="run-up-quintic", **changes):
    return crank_motion(regime, **{"ramp_time": 0.15, "hold_time": 0.03, "start_angle": 0.3, **changes})


def _run(linkage, motion):
    model = driven(linkage, motion)
    return model, history_of(ENGINE, model)


def _worst(linkage, motion):
    return max(errors_of(_run(linkage, motion)[1], linkage, motion).values())


@pytest.mark.parametrize(("name", "variant", "is_laden"), [*LADEN, *BARE, *CATALOGUE])
def test_every_linkage_agrees_with_the_closed_form_in_motion_torque_and_joint_forces(name, variant, is_laden):
    assert _worst(on_trial(name, variant, is_laden), _motion()) <= (NEAR_TOGGLE if name == "near-toggle" else SAME)


@pytest.mark.parametrize("changes", [{"clockwise": True, "start_angle": 4.0}, {"speed": 3.0}, {"hold_time": 3.0}])
def test_direction_start_angle_and_many_turns_cost_no_accuracy(changes):
    assert _worst(mechanism("two-crank-takeup"), _motion(**changes)) <= SAME


def _standing(angle):
    """A crank that stands still."""
    return Prescribed(CrankMotion("constant-speed", (Segment(0.0, 0.1, (angle, 0.0)),)))


def _still(name, mass, inertia, position, angle=0.0):
    return Body(name, mass, inertia, position, angle, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0)


# -- a free crank ------------------------------------------------------------------------------------------------------


@pytest.mark.nightly
@pytest.mark.parametrize(("torque", "degrees"), [(0.0, 280.0), (0.025, 269.18)], ids=["free", "driven"])
def test_ten_seconds_of_the_slotted_take_up_are_those_of_the_reference(torque, degrees):
    linkage, start = mechanism("slotted-takeup"), math.radians(degrees)
    truth = free_motion(linkage, torque=torque, start_angle=start, duration=10.0)
    model = scene(linkage, Free(torque, 10.0), {Channel.POSITION}, start_angle=start)
    position = history_of(ENGINE, model).position
    assert np.max(np.abs(position.values[:, crank_number(model), 2] - truth.angle(position.time))) <= LONG_ANGLE


def test_a_released_parallelogram_swings_between_its_change_points():
    """Its coupler does not turn: T = ½ (J₁ + J₃ + m₂ r²) ω² and V = m₂ g r sin φ, the other centres being on pivots."""
    inertia, lift = 0.6e-4 + 0.7e-4 + 0.15 * 0.025**2, 0.15 * 9.81 * 0.025
    model = scene(mechanism("parallelogram"), Free(0.0, 0.15), EVERYTHING, start_angle=1.0, speed=3.0)
    history = history_of(ENGINE, model)
    angle, speed = history.position.values[:, 1, 2], history.velocity.values[:, 1, 2]
    energy = 0.5 * inertia * speed**2 + lift * np.sin(angle)
    assert np.ptp(energy) <= SAME * energy[0]
    assert np.ptp(angle) > 0.1
    assert np.max(np.abs(history.position.values[:, 0, 2])) <= SAME


# -- motions and scenes that cannot be solved --------------------------------------------------------------------------


@pytest.mark.parametrize(
    "share", [0.0, -1e-13, *(pytest.param(one, marks=pytest.mark.nightly) for one in (1e-13, -1e-9))]
)
def test_a_change_point_is_not_passed_nor_one_that_is_just_missed(share):
    linkage = from_text(four_bar(0.06, 0.025, 0.06, 0.025 * (1.0 + share), 1.5))
    motion = CrankMotion("constant-speed", (Segment(0.0, 0.1, (1.0, 60.0)),))
    run = ENGINE.run(driven(linkage, motion, frozenset({Channel.POSITION})), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    (angle,) = re.findall(r"crank angle of (.*)°", run.reason)
    assert float(angle) == pytest.approx(180.0, abs=0.1)


def test_a_linkage_that_locks_moves_within_its_stops():
    assert _worst(from_text(double_rocker_text()), CrankMotion("steady", (Segment(0.0, 0.1, (0.9, 3.0)),))) <= SAME


@pytest.mark.nightly
def test_a_released_linkage_diverges_where_it_runs_up_against_a_stop():
    linkage = from_text(double_rocker_text())
    run = ENGINE.run(scene(linkage, Free(0.5, 5.0), EVERYTHING, start_angle=1.0), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "locks" in run.reason


def test_a_start_state_with_an_open_joint_diverges_and_names_it():
    model = driven(mechanism("juki-mf7923d"), _motion())
    bar = next(body for body in model.bodies if body.inertia is None)
    run = ENGINE.run(with_body(model, bar.name, position=(bar.position[0], bar.position[1] + 1e-3)), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "'D'" in run.reason


def _three_cranks():
    """A parallelogram with a third crank that changes nothing."""
    c, s = math.cos(1.0), math.sin(1.0)
    cranks = [_still(f"crank {n}", 1.0, 1.0, (4.0 * n, 0.0), 1.0) for n in range(3)]
    pins = [PinJoint(f"O{n}", f"crank {n}", GROUND, (0.0, 0.0), (4.0 * n, 0.0)) for n in range(3)]
    pins += [PinJoint(f"A{n}", f"crank {n}", "beam", (1.0, 0.0), (4.0 * n - 4.0, 0.0)) for n in range(3)]
    bodies = (*cranks, _still("beam", 1.0, 1.0, (4.0 + c, s)))
    return Scene("crank 0", bodies, tuple(pins), (), (), (0.0, 0.0), _standing(1.0), EVERYTHING)


def test_redundant_joints_free_bodies_and_a_crank_that_cannot_turn_are_refused():
    model = _three_cranks()
    assert "redundant" in _refusal(model)
    assert "more than the crank can move" in _refusal(replace(model, pins=model.pins[:-2]))
    assert "crank 0" in _refusal(with_body(model, "crank 0", inertia=None))


def test_a_dead_point_at_the_start_is_refused():
    in_line = math.atan2(-4.0, 3.0)  # rod and arm, 2 m and 3 m, from the crank pin (0, 1) to the pivot (3, -3)
    bodies = (
        _still("crank", 1.0, 1.0, (0.0, 0.0), math.pi / 2.0),
        _still("rod", 1.0, 1.0, (0.0, 1.0), in_line),
        _still("arm", 1.0, 1.0, (3.0, -3.0), in_line),
    )
    pins = (
        PinJoint("O", "crank", GROUND, (0.0, 0.0), (0.0, 0.0)),
        PinJoint("A", "rod", "crank", (0.0, 0.0), (1.0, 0.0)),
        PinJoint("B", "rod", "arm", (2.0, 0.0), (-3.0, 0.0)),
        PinJoint("C", "arm", GROUND, (0.0, 0.0), (3.0, -3.0)),
    )
    model = Scene("crank", bodies, pins, (), (), (0.0, 0.0), _standing(math.pi / 2.0), EVERYTHING)
    assert "dead point" in _refusal(model)


# -- its one method ----------------------------------------------------------------------------------------------------


def test_every_setting_is_the_method_as_an_exact_solution_has_no_defaults_and_no_floor_below():
    model = driven(mechanism("juki-mf7923d"), _motion())
    (method,) = ENGINE.methods(model)
    torques = [ENGINE.run(model, setting).history.torque for setting in Setting]
    torques.append(ENGINE.run_method(model, method, torques[0].time[1]).history.torque)
    assert all(np.array_equal(torque.values, torques[0].values) for torque in torques)
    for other, step, words in (
        (method, 0.0, "step"),
        (method, math.nan, "step"),
        (replace(method, name="x"), 1.0, "x"),
    ):
        with pytest.raises(LinkproofError, match=words):
            ENGINE.run_method(model, other, step)
