"""The invariants hold in a true motion and catch a wrong one without any closed form."""

import dataclasses

import numpy as np
import pytest

from analytic.loading import load
from analytic.mechanism import Mechanism
from analytic.regimes import crank_motion
from comparisons import invariants
from comparisons.motion import ObservedMotion
from engines.contract import Signal
from tests.comparisons.perfect_engine import perfect_motion


@pytest.fixture(scope="module", params=["juki-mf7923d", "rimoldi-164"])
def mechanism(request):
    return Mechanism(load(request.param))


@pytest.fixture(scope="module")
def motion(mechanism):
    return perfect_motion(mechanism, crank_motion("run-up-quintic"), 2801)


def test_joints_are_closed(motion):
    assert invariants.joint_gaps(motion).values.max() < 1e-15


def test_a_body_out_of_place_opens_a_joint(motion):
    position = motion.history.position
    moved = position.values.copy()
    moved[1000, 1, 0] += 1e-6
    wrong = ObservedMotion(motion.scene, dataclasses.replace(motion.history, position=Signal(position.time, moved)))
    gaps = invariants.joint_gaps(wrong).values
    assert gaps[1000] == pytest.approx(1e-6, rel=0.5)
    assert gaps[999] < 1e-15


def test_energy_is_balanced(motion):
    peak = motion.kinetic_energy().values.max()
    assert np.abs(invariants.energy_balance(motion).values).max() < 1e-6 * peak


def test_both_routes_to_the_torque_agree(motion):
    by_power = invariants.power_torque(motion, 5.0)
    torque = motion.history.torque
    true = np.interp(by_power.time, torque.time, torque.values)
    assert np.abs(by_power.values - true).max() < 1e-10 * np.abs(torque.values).max()


@pytest.mark.parametrize("scale", [1.01, -1.0])
def test_a_wrong_torque_is_caught_by_both(motion, scale):
    torque = motion.history.torque
    wrong = ObservedMotion(
        motion.scene, dataclasses.replace(motion.history, torque=Signal(torque.time, scale * torque.values))
    )
    assert np.abs(invariants.energy_balance(wrong).values).max() > 1e-3 * motion.kinetic_energy().values.max()
    by_power = invariants.power_torque(wrong, 5.0)
    claimed = np.interp(by_power.time, torque.time, scale * torque.values)
    assert np.abs(by_power.values - claimed).max() > 5e-3 * np.abs(torque.values).max()


def test_energy_is_balanced_across_acceleration_jumps(mechanism):
    motion = perfect_motion(mechanism, crank_motion("run-up"), 2801)
    peak = motion.kinetic_energy().values.max()
    assert np.abs(invariants.energy_balance(motion).values).max() < 1e-6 * peak


def test_an_integral_crosses_a_jump_without_losing_its_order():
    time = np.linspace(0.0, 2.0, 201)
    values = np.where(time < 1.0, np.cos(time), 5.0 + time)
    exact = np.where(time < 1.0, np.sin(time), np.sin(1.0) + 5.0 * (time - 1.0) + (time**2 - 1.0) / 2.0)
    found = invariants.integral(Signal(time, values), (0.0, 1.0))
    np.testing.assert_allclose(found, exact, atol=1e-8)
