"""What is wrong of a motion is said in words, and nothing is of a right one."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case, own_case
from comparisons.reference.start_state import start_state
from comparisons.stress.truth import WRONG, true_states, wrongs
from engines.contract import Signal
from tests.comparisons.true_motions import EVERYTHING, cut, true_history, with_signal


@cache
def case(name="juki-mf7923d", regime="run-up-quintic"):
    return Case(Mechanism(load(name)), crank_motion(regime))


def found(one, history):
    return wrongs(one, ObservedMotion(one.scene(EVERYTHING), history))


@pytest.mark.parametrize("name", catalogue())
@pytest.mark.parametrize("order", [0, 1])
def test_true_states_are_those_a_scene_would_start_from(name, order):
    one = case(name)
    time = np.linspace(0.0, one.motion.duration, 7)
    states = true_states(one, one.scene(EVERYTHING), time, order)
    for at, t in enumerate(time):
        sweep = one.mechanism.sweep(one.motion.angle(t))
        start = start_state(sweep, float(one.motion.speed(t)), float(one.motion.acceleration(t)))
        for number, state in enumerate(start.values()):
            place = (*state.velocity, state.angular_velocity) if order else (*state.position, state.angle)
            difference = states[at, number] - place
            if not order:
                difference[2] = np.angle(np.exp(1j * difference[2]))
            np.testing.assert_allclose(difference, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", catalogue())
@pytest.mark.parametrize("regime", ["run-up", "run-up-quintic", "constant-speed"])
def test_nothing_is_wrong_of_the_truth(name, regime):
    one = case(name, regime)
    assert found(one, true_history(one, 301)) == []


@pytest.mark.parametrize("share", [0.5, 2.0])
@pytest.mark.parametrize("own", [False, True])
def test_a_joint_force_that_is_off_is_wrong(share, own):
    linkage = load("slotted-takeup")
    one = own_case(Mechanism(linkage), linkage.regimes[0]) if own else case("slotted-takeup")
    history = true_history(one, 3001 if own else 301)
    joint, force = next(iter(history.joint_force.items()))
    values = force.values.copy()
    values[150] += share * WRONG * np.max(np.hypot(*values.T)) * np.array([0.6, 0.8])
    changed = replace(history, joint_force={**history.joint_force, joint: Signal(force.time, values)})
    assert [words.partition(" off by")[0] for words in found(one, changed)] == [f"force in {joint}"] * (share > 1.0)


def test_whole_turns_apart_is_the_same_place():
    one = case()
    two_turns = np.array([0.0, 0.0, 4.0 * np.pi])
    turned = with_signal(true_history(one, 301), "position", lambda values, _: values + two_turns)
    assert found(one, turned) == []


@pytest.mark.parametrize("share", [0.5, 2.0])
@pytest.mark.parametrize(
    ("name", "words"), [("position", "position of needle_bar"), ("velocity", "velocity of needle_bar")]
)
def test_one_body_off_is_named_beyond_the_limit_alone(name, words, share):
    one = case()
    history = true_history(one, 301)
    names = [body.name for body in one.scene(EVERYTHING).bodies]
    size = 0.0416 if name == "position" else 1.0  # the coupler's arm to its farther pin, m

    def change(values, _):
        peak = size if name == "position" else np.max(np.abs(values[:, :, 2])) * 0.0416
        values[150, names.index("needle_bar"), 1] += share * WRONG * peak
        return values

    said = found(one, with_signal(history, name, change))
    assert bool(said) is (share > 1.0)
    assert all(f"{name} of needle_bar" in sentence for sentence in said)


def test_a_torque_off_is_told_with_its_share():
    one = case()
    (said,) = found(one, with_signal(true_history(one, 301), "torque", lambda values, _: 1.2 * values))
    assert said.startswith("torque off by 0.2 of its peak at ")


def test_torque_at_an_acceleration_jump_is_not_judged():
    one = case(regime="run-up")
    history = true_history(one, 701)
    at = int(np.argmin(np.abs(history.torque.time - 0.6)))

    def spike(values, _):
        values[at - 1 : at + 2] *= 10.0
        return values

    assert found(one, with_signal(history, "torque", spike)) == []


def test_what_is_missing_is_wrong_too():
    one = case(regime="constant-speed")
    history = true_history(one, 301)
    assert any("no samples" in words for words in found(one, cut(history, lambda t: np.abs(t - 0.35) > 0.05)))
    assert found(one, cut(history, lambda t: (t > 0.0) & (t < t[-1]))) == []


def test_the_angle_of_a_mass_at_a_pin_means_nothing():
    one = case("slotted-takeup")
    names = [body.name for body in one.scene(EVERYTHING).bodies]
    history = true_history(one, 301)

    def turned(values, _):
        values[:, names.index("slot_slider"), 2] = 17.0
        return values

    assert found(one, with_signal(history, "position", turned)) == []
