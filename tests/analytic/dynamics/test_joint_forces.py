"""Joint forces: statics known by hand, Newton and Euler on every link, the drive's torque, a second derivation."""

import dataclasses

import numpy as np
import pytest

from analytic.description.law import Law
from analytic.description.linkage import PointForce, Spring
from analytic.dynamics import joint_forces, reduced
from analytic.errors import AssemblyError
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import ON_TRIAL, angles, driven, from_text, laden, mechanism, on_trial, text_of
from tests.analytic.tolerances import FEW_ROUNDINGS

# Of the largest joint force, times the linkage's extent for moments: the second derivation is held to this.
BALANCED = 1e-12
SPEED, ACCELERATION = -41.0, 310.0  # rad/s and rad/s², clockwise and slowing down
ABOUT = (0.03, -0.02)  # m, of a moment
# Every made-up linkage under load, and bare the one near toggle; the others bare nightly.
TRIALS = [
    case
    if case[0][1] is None and (case[1] or case[0][0] == "near-toggle")
    else pytest.param(case, marks=pytest.mark.nightly)
    for case in ON_TRIAL
]
CLASS_III = "ternary-on-rods"
TRIALS.append(((CLASS_III, None), True))


@pytest.fixture(params=TRIALS, ids=lambda case: f"{case[0][0]}-{case[0][1]}-{'laden' if case[1] else 'bare'}")
def sample(request):
    (name, variant), is_laden = request.param
    return Mechanism(laden(driven(name).linkage)) if name == CLASS_III else on_trial(name, variant, is_laden)


def _forces(*given):
    return joint_forces.reactions(*given).forces


def _peak(reactions):
    return max(float(np.abs(force).max()) for force in reactions.forces.values())


# Statics by hand.


def _without_weight(name, *, forces=(), torques=(), springs=()):
    loads = {"forces": forces, "torques": torques, "springs": springs, "dampers": ()}
    return Mechanism(dataclasses.replace(mechanism(name).linkage, gravity=(0.0, 0.0), **loads))


def _law(*values):
    return Law(np.array(values, dtype=float))


def test_slider_crank_carries_a_piston_force_along_its_rod():
    # Rod at angle β to the line, sin β = (r/l) sin φ: rod force F/cos β, wall force F tan β, and a drive
    # that holds back F r sin(φ+β)/cos β while the force pushes the piston in.
    force, crank, rod = 120.0, 0.05, 0.2
    pressed = _without_weight("centric-slider-crank", forces=(PointForce("D", "piston", _law(-force, 0.0)),))
    angle = angles(50)
    beta = np.arcsin(crank / rod * np.sin(angle))
    result = joint_forces.reactions(pressed.sweep(angle), 0.0, 0.0)
    thrust = force * np.stack([np.ones(50), -np.tan(beta)])  # of the rod on the piston
    close = {"rtol": 0.0, "atol": FEW_ROUNDINGS * force}
    assert np.allclose(result.forces["D"], -thrust, **close)  # on the rod: the piston is the hub
    assert np.allclose(result.forces["A"], thrust, **close)  # on the rod: the crank is the hub
    assert np.allclose(result.forces["piston on ground"], [np.zeros(50), -thrust[1]], **close)
    assert np.allclose(result.forces["O"], thrust, **close)
    assert np.allclose(result.torque, -force * crank * np.sin(angle + beta) / np.cos(beta), **close)


def test_spring_whose_ends_meet_pulls_nothing():
    spring = Spring(("D", "D"), ("rod", "piston"), stiffness=500.0, length=0.0, damping=2.0)
    sweep = _without_weight("centric-slider-crank", springs=(spring,)).sweep(angles(20))
    result = joint_forces.reactions(sweep, SPEED, ACCELERATION)
    plain = joint_forces.reactions(_without_weight("centric-slider-crank").sweep(angles(20)), SPEED, ACCELERATION)
    for joint, force in plain.forces.items():
        assert np.allclose(result.forces[joint], force, rtol=0.0, atol=FEW_ROUNDINGS * _peak(plain))


# Every kind of dyad, joint and load.


def test_the_frame_takes_what_acts_from_outside(sample):
    """Newton's and Euler's laws for the whole linkage, whose inner forces cancel."""
    if sample.linkage.name == "laden-press":
        pytest.skip("test_loads holds loads over the travel, in a link's frame and between bodies")
    sweep = sample.sweep(angles(6))
    shaking, expected = joint_forces.shaking(sweep, SPEED, ACCELERATION, ABOUT), np.zeros((3, 6))

    def add(place, force, torque=0.0):
        (x, y), (fx, fy) = (np.subtract(np.broadcast_to(place, (6, 2)).T, np.array(ABOUT)[:, None]), force)
        expected[:] += [fx + 0.0 * x, fy + 0.0 * x, x * fy - y * fx + torque]

    for name, link in sample.linkage.links.items():
        first, second = (np.stack(np.broadcast_arrays(*sweep.centre(name, k), sweep.angle)[:2]) for k in (1, 2))
        turn = [np.broadcast_to(part[2], (6,)) for part in (sweep.rates(name), sweep.accelerations(name))]
        gravity = np.array(sample.linkage.gravity)[:, None]
        weight = link.mass * (gravity - second * SPEED**2 - first * ACCELERATION)
        place = np.stack(np.broadcast_arrays(*sweep.centre(name), sweep.angle)[:2]).T
        add(place, weight, -(link.inertia or 0.0) * (turn[1] * SPEED**2 + turn[0] * ACCELERATION))
    for load in sample.linkage.forces:
        add(np.stack(np.broadcast_arrays(*sweep.point(load.point), sweep.angle)[:2]).T, load.force(sweep.angle))
    for load in sample.linkage.torques:
        expected[2] += load.torque(sweep.angle)[0]
    assert np.all(np.abs(shaking - expected) <= BALANCED * np.max(np.abs(expected), axis=1, keepdims=True) + 1e-13)


def test_drive_torque_is_that_of_virtual_work(sample):
    for speed, acceleration in ((0.0, 0.0), (SPEED, ACCELERATION), (0.0, ACCELERATION)):
        sweep = sample.sweep(angles(200))
        virtual = reduced.drive_torque(sweep, speed, acceleration)
        result = joint_forces.reactions(sweep, speed, acceleration).torque
        assert np.allclose(result, virtual, rtol=0.0, atol=BALANCED * np.abs(virtual).max())


@pytest.mark.parametrize("name", ["boom", "cylinder-in-the-loop", "linear-motor"])
def test_force_of_a_linear_drive_is_that_of_virtual_work(name):
    model = Mechanism(laden(driven(name).linkage))
    low, high = model.crank_range().limits
    sweep = model.sweep(np.linspace(0.9 * low + 0.1 * high, 0.1 * low + 0.9 * high, 9))
    virtual = reduced.drive_torque(sweep, 0.2, 3.0)
    force = joint_forces.reactions(sweep, 0.2, 3.0).torque
    assert np.allclose(force, virtual, rtol=0.0, atol=BALANCED * np.abs(virtual).max())


# Shapes, parts, and positions without values.


def test_dead_position_is_refused():
    toggle = from_text(text_of("double-crank").replace("B = [28, 0]", "B = [15, 0]"))
    limit = toggle.crank_range().high.angle
    with pytest.raises(AssemblyError, match="dead position"):
        _forces(toggle.sweep(np.array([toggle.linkage.sketch_angle, limit])), 5.0, 0.0)


def test_at_a_change_point_joint_forces_have_no_value_and_beside_it_large_ones():
    """They are those of a beam on two supports beside it, whose lever vanishes with the sine of the crank angle."""
    sweep = mechanism("parallelogram").sweep(np.array([0.5, 0.0, np.pi]))
    forces = _forces(sweep, 5.0, 1.0)
    assert all(np.isfinite(force[:, 0]).all() and np.isnan(force[:, 1:]).all() for force in forces.values())
    assert np.all(np.isfinite(reduced.drive_torque(sweep, 5.0, 1.0)))
    near = _forces(mechanism("parallelogram").sweep(np.array([1e-3, 2e-3])), 5.0, 1.0)["B"]
    assert np.hypot(*near[:, 0]) / np.hypot(*near[:, 1]) == pytest.approx(2.0, rel=1e-2)
