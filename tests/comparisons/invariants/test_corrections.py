"""Corrections estimate the error of a state from the state itself, and forces follow from the corrected one."""

import dataclasses
from functools import cache

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.dynamics.joint_forces import joint_forces
from analytic.kinematics.mechanism import Mechanism
from comparisons.invariants import corrections
from comparisons.invariants.assur_groups import AssurGroups
from comparisons.invariants.corrections import LEVELS, Corrected, findings
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from engines.contract import Signal
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import pose_of, with_ground
from tests.comparisons.true_motions import EVERYTHING, true_history

NAMES = ["juki-mf7923d", "rimoldi-164", "slotted-takeup", "tests/linkages/moving-guides.toml"]


@cache
def truth(name):
    case = Case(Mechanism(load(name)), crank_motion("run-up-quintic", start_angle=0.4))
    return case, true_history(case, 101)


def groups_of(scene):
    return AssurGroups(JointEquations(scene))


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


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [0, 1, 2])
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
    forces = joint_forces(case.sweep(time), case.motion.speed(time), case.motion.acceleration(time))
    peak = max(np.max(np.abs(force)) for force in forces.values())
    for number, joint in enumerate([*scene.pins, *scene.guided]):
        assert np.max(np.abs(instants.forces[:, number] - forces[joint.name].T)) < 1e-12 * peak
    torque = history.torque.values
    assert np.max(np.abs(instants.torque - torque)) < 1e-12 * np.max(np.abs(torque))


def test_a_heavy_flywheel_shows_what_its_drive_asks_for_not_how_it_trembles():
    """The torque is that of the prescribed acceleration: an engine's noise in ε, times J, is no torque."""
    case, history = truth("juki-mf7923d")
    instants, _ = off("juki-mf7923d", 2, 1e-3)
    torque = history.torque.values
    assert np.max(np.abs(instants.torque - torque)) < 1e-12 * np.max(np.abs(torque))
    assert case.is_prescribed


def test_blocks_of_a_long_motion_say_the_same_as_the_whole(monkeypatch):
    case, history = truth("rimoldi-164")
    scene = case.scene(EVERYTHING)
    motion, groups = ObservedMotion(scene, history), groups_of(scene)
    whole = findings(motion, groups, history.position.time, 2)
    monkeypatch.setattr(corrections, "BLOCK", 17)
    parts = findings(motion, groups, history.position.time, 2)
    for name in ("determinants", "torque", "forces"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(parts, name))
    for one, other in zip(whole.lacking, parts.lacking, strict=True):
        np.testing.assert_array_equal(one, other)
