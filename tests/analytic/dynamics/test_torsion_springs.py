"""A torsion spring between two bodies: by its energy, its angles by the law of cosines, and by the control's bodies."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.dynamics.reduced import potential_energy
from analytic.signals import evaluate
from comparisons.motion.case import Case
from engines.contract import Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import Channel
from tests.analytic.linkages import four_bar, from_text

GROUND, CRANK, COUPLER, ROCKER = LENGTHS = 0.06, 0.02, 0.06, 0.045  # m
STIFFNESS, FREE = 0.8, 0.3  # N m/rad, rad
STEP = 1e-4  # rad, of the differences


def sprung(stiffness, *between):
    table = f"[[torsion_springs]]\nbetween = {list(between)}\nstiffness = {stiffness}\nangle = {FREE}\n"
    return from_text(four_bar(*LENGTHS, 1.0) + table.replace("'", '"'))


def angles(phi):
    """Angles of the bodies of the four-bar, rad, by the law of cosines."""
    gap = np.hypot(GROUND - CRANK * np.cos(phi), CRANK * np.sin(phi))
    inward = np.arctan2(CRANK * np.sin(phi), GROUND - CRANK * np.cos(phi))
    near = np.arccos((gap**2 + COUPLER**2 - ROCKER**2) / (2 * gap * COUPLER))
    far = np.arccos((gap**2 + ROCKER**2 - COUPLER**2) / (2 * gap * ROCKER))
    return {"ground": 0.0 * phi, "coupler": near - inward, "rocker": math.pi - inward - far}


def energy(phi, first, second):
    turned = angles(phi)[first] - angles(phi)[second] - FREE
    return 0.5 * STIFFNESS * turned**2


@pytest.mark.parametrize("between", [("rocker", "ground"), ("ground", "coupler"), ("coupler", "rocker")])
def test_its_torque_is_the_slope_of_its_energy(between):
    phi = np.linspace(0.1, 6.2, 25)
    bare, with_spring = sprung(0.0, *between), sprung(STIFFNESS, *between)
    stored = potential_energy(with_spring.sweep(phi)) - potential_energy(bare.sweep(phi))
    assert stored == pytest.approx(energy(phi, *between), rel=1e-12)
    near, far = (
        (energy(phi + step, *between) - energy(phi - step, *between)) / (2.0 * step) for step in (STEP, 2.0 * STEP)
    )
    torques = [evaluate(each, phi, ["Mkr"], speed=20.0)["Mkr"] for each in (with_spring, bare)]
    assert torques[0] - torques[1] == pytest.approx((4.0 * near - far) / 3.0, abs=1e-10)


def test_the_control_agrees():
    motion = crank_motion("run-up-quintic", speed=20.0, ramp_time=0.3, hold_time=0.3)
    case = Case(sprung(STIFFNESS, "coupler", "rocker"), motion)
    model = case.scene([Channel.TORQUE, Channel.JOINT_FORCE])
    history = DirectEngine().run(model, Setting.TUNED).history
    truth = case.at(history.torque.time)
    assert history.torque.values == pytest.approx(truth.torque, rel=1e-11, abs=1e-11 * np.max(np.abs(truth.torque)))
    for name, force in history.joint_force.items():
        expected = np.stack(truth.joint_forces[name], axis=-1)
        assert force.values == pytest.approx(expected, rel=1e-11, abs=1e-11 * np.max(np.abs(expected)))
