"""The joints' equations of an observed motion: groups and assembly modes, corrections, relaxation."""

import dataclasses
from functools import cache

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from analytic.description.loading import load
from analytic.dynamics.joint_forces import reactions
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.invariants.corrections import (
    LEVELS,
    AssurGroups,
    Corrected,
    speed_errors,
    undissipated_error,
)
from comparisons.trials.judging.limits import limit
from comparisons.trials.observed_motion import ObservedMotion
from engines.contract import Signal
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import pose_of, with_ground
from engines.scene import PinJoint
from tests.comparisons.true_motions import EVERYTHING, true_history


def jacobian(groups, position):
    equations = groups.equations
    return equations.jacobian(equations.arms(pose_of(with_ground(position) / equations.metres)))


NAMES = ["juki-mf7923d", "tests/linkages/moving-guides.toml"]


@cache
def truth(name):
    case = Case(Mechanism(load(name)), crank_motion("run-up-quintic", start_angle=0.4))
    return case, true_history(case, 101)


def groups_of(scene):
    return AssurGroups(JointEquations(scene))


def test_a_ring_of_thirty_bodies_is_one_group():
    """Every other one is pinned to the ground, so that no fewer of them are placed: 2³⁰ subsets are none."""
    scene = truth(NAMES[0])[0].scene(EVERYTHING)
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    names = [f"b{number}" for number in range(30)]
    ring = [
        PinJoint(f"{a}{b}", a, b, (0.0, 0.0), (1.0, 0.0)) for a, b in zip(names, names[1:] + names[:1], strict=True)
    ]
    feet = [PinJoint(f"{name} foot", name, GROUND, (0.0, 1.0), (float(n), 0.0)) for n, name in enumerate(names[::2])]
    pivot = [pin for pin in scene.pins if {pin.first, pin.second} == {GROUND, scene.crank}]
    bodies = (crank, *(dataclasses.replace(crank, name=name) for name in names))
    large = dataclasses.replace(scene, bodies=bodies, pins=(*pivot, *ring, *feet), sliders=(), slots=())
    assert groups_of(large).members == [tuple(names)]


def off(name, level, size, seed=3):
    """A true history with one level off by random errors of a size, and the errors."""
    case, history = truth(name)
    signal = getattr(history, LEVELS[level].value)
    groups = groups_of(case.scene(EVERYTHING))
    equations = groups.equations
    scale = np.max(np.abs(signal.values)) if level else 1.0
    error = size * scale * np.random.default_rng(seed).normal(size=signal.values.shape)
    error *= (equations.column[:-1] != equations.size) * equations.metres
    changed = dataclasses.replace(history, **{LEVELS[level].value: Signal(signal.time, signal.values + error)})
    return Corrected(ObservedMotion(case.scene(EVERYTHING), changed), groups, signal.time), error


@pytest.mark.parametrize(("name", "level"), [(NAMES[0], 0), (NAMES[0], 1), (NAMES[1], 2)])
def test_a_correction_is_the_error_turned_round(name, level):
    instants, error = off(name, level, 1e-7)
    error = error / instants.equations.metres
    assert np.max(np.abs(instants.correction(level)[:, :-1] + error)) < 1e-5 * np.max(np.abs(error))


@pytest.mark.parametrize("name", NAMES)
def test_a_velocity_that_fits_a_wrong_position_lacks_what_the_right_one_asks_for(name):
    instants, _ = off(name, 0, 1e-4)
    case, history = truth(name)
    equations = instants.equations
    matrix = equations.jacobian(equations.arms(pose_of(instants.corrected(0))))
    speed = case.motion.speed(instants.time)[:, None] * equations.crank_unit(len(matrix))
    right = equations.spread(np.linalg.solve(matrix, speed[..., None])[..., 0])
    true = with_ground(history.velocity.values) / equations.metres * (equations.column != equations.size)
    assert np.max(np.abs(true - right)) < 1e-5 * np.max(np.abs(true))
    corrected = instants.corrected(1) * (equations.column != equations.size)
    assert np.max(np.abs(corrected - true)) < 1e-5 * np.max(np.abs(true))


@pytest.mark.parametrize("name", NAMES)
def test_reactions_are_the_closed_forms(name):
    case, history = truth(name)
    scene = case.scene(EVERYTHING)
    instants = Corrected(ObservedMotion(scene, history), groups_of(scene), history.position.time)
    time = history.position.time
    forces = reactions(case.sweep(time), case.motion.speed(time), case.motion.acceleration(time)).forces
    peak = max(np.max(np.abs(force)) for force in forces.values())
    for number, joint in enumerate([*scene.pins, *scene.guided]):
        assert np.max(np.abs(instants.forces[:, number] - forces[joint.name].T)) < 1e-12 * peak
    torque = history.torque.values
    assert np.max(np.abs(instants.torque - torque)) < 1e-12 * np.max(np.abs(torque))


@pytest.mark.parametrize("rate", [0.0, 0.3, 1e6])
def test_an_energy_error_decays_at_its_rate(rate):
    """A steady source s against a decay r makes s/r (1 − e^{−rt}): known at every sample, however coarse."""
    time = np.linspace(0.0, 2.0, 41)
    left = undissipated_error(3.0 * time, np.full(41, rate), time)
    exact = 3.0 * time if rate == 0.0 else 3.0 / rate * -np.expm1(-rate * time)
    np.testing.assert_allclose(left, exact, rtol=1e-10)


@pytest.mark.parametrize("rate", [0.0, 30.0, 1e9])
@pytest.mark.parametrize("excess", [0.0, 0.1])
def test_a_speed_is_compared_with_its_acceleration_however_stiff(rate, excess):
    """ω' = g − r ω from rest, over within 1/r. A wrong speed obeys that equation too, but is not what it leads to."""
    time = np.linspace(0.0, 1.0, 201)
    speed = 2.0 * time if rate == 0.0 else 2.0 / rate * -np.expm1(-rate * time)
    claimed = speed * (1.0 + excess * np.exp(-time / 0.3))
    found = speed_errors(time, claimed, 2.0 - rate * claimed, np.full(201, rate), 0.0)
    peak = np.max(speed)
    if excess:
        assert np.max(found) > 5.0 * limit("closure", "tuned", "own").value * peak
    else:
        assert np.max(found) < 1e-6 * peak
