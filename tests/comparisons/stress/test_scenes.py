"""Conditions become scenes: what they change, they change, and units change nothing but the numbers."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.description import changes
from analytic.description.loading import catalogue, load
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import joint_forces
from analytic.errors import DescriptionError
from analytic.kinematics.mechanism import Mechanism
from comparisons.stress.scenes import LINKAGES, Conditions, case, linkage, motion, reversal, scene
from engines.mechanics.joints import scene_size
from engines.mechanics.start_check import start_misfit
from engines.scene import Channel, Free

JUKI = Conditions("juki-mf7923d")
POWERS = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)
LOADED = ["tests/linkages/spring-and-damper.toml", "tests/linkages/force-over-angle.toml", *catalogue()]


@given(name=st.sampled_from(LOADED), length=POWERS, mass=POWERS, time=POWERS)
def test_the_closed_form_does_not_notice_units(name, length, mass, time):
    """Torque has the unit m l² t⁻², joint forces m l t⁻²; in these all is the same to rounding."""
    plain, scaled = Mechanism(load(name)), Mechanism(changes.scaled(load(name), length=length, mass=mass, time=time))
    angle = np.linspace(0.3, 9.0, 25)
    speed, acceleration = 70.0, 900.0
    found, there = plain.sweep(angle), scaled.sweep(angle)
    torque = reduced.drive_torque(found, speed, acceleration)
    moved = reduced.drive_torque(there, speed / time, acceleration / time**2) * time**2 / (mass * length**2)
    assert np.max(np.abs(torque - moved)) < 1e-10 * np.max(np.abs(torque))
    forces = joint_forces(found, speed, acceleration)
    others = joint_forces(there, speed / time, acceleration / time**2)
    peak = max(np.max(np.abs(force)) for force in forces.values())
    for joint, force in forces.items():
        assert np.max(np.abs(force - others[joint] * time**2 / (mass * length))) < 1e-10 * peak


def test_one_link_gets_heavier_and_no_other():
    plain, heavy = linkage(JUKI), linkage(dataclasses.replace(JUKI, link="coupler", mass_factor=1e3))
    assert heavy.links["coupler"].mass == pytest.approx(1e3 * plain.links["coupler"].mass)
    assert heavy.links["coupler"].inertia == pytest.approx(1e3 * plain.links["coupler"].inertia)
    assert heavy.links["coupler"].centre == plain.links["coupler"].centre
    assert {name for name in plain.links if heavy.links[name] != plain.links[name]} == {"coupler"}


def test_a_point_goes_where_it_is_put():
    on_link = Conditions("slider-crank", link="rod", point="D", at=(0.05, 0.0), slope=(0.05, 0.0), excess=1e-3)
    assert linkage(on_link).links["rod"].points["D"] == pytest.approx((0.05005, 0.0))
    on_ground = Conditions("crank-rocker", link="ground", point="O2", at=(0.08, 0.0), slope=(-0.01, 0.0), excess=0.1)
    assert linkage(on_ground).ground["O2"] == pytest.approx((0.079, 0.0))


def test_one_kind_of_load_is_kept():
    plain = load(str(LINKAGES / "sprung-crank-rocker.toml"))
    spring = linkage(Conditions("sprung-crank-rocker", load="springs", load_factor=10.0))
    assert spring.springs[0].stiffness == pytest.approx(10.0 * plain.springs[0].stiffness)
    assert spring.dampers == ()
    damper = linkage(Conditions("sprung-crank-rocker", load="dampers", load_factor=10.0))
    assert damper.springs == ()
    assert damper.dampers[0].coefficient == pytest.approx(10.0 * plain.dampers[0].coefficient)
    assert linkage(Conditions("slotted-takeup", damper_factor=0.0)).dampers == ()


@pytest.mark.parametrize(("hold", "change"), [(0.03, 0.06), (0.01, 1e-3)])
def test_a_reversal_turns_round_and_back_without_a_jump(hold, change):
    one = reversal(100.0, 0.4, hold, change)
    time = np.linspace(0.0, one.duration, 20001)
    speed = one.speed(time)
    assert one.duration == pytest.approx(3.0 * hold + 2.0 * change)
    assert one.jumps == ()
    assert one.peak_speed == pytest.approx(100.0)
    assert np.max(np.abs(speed)) <= 100.0 * (1.0 + 1e-12)
    assert one.speed(np.array([0.0, 1.5 * hold + change, one.duration])) == pytest.approx([100.0, -100.0, 100.0])
    step = time[1]
    np.testing.assert_allclose(
        np.gradient(one.angle(time), step)[1:-1], speed[1:-1], atol=100.0 * (step / change) ** 2 * 9
    )
    back = np.diff(one.angle(time))
    assert np.sum(np.abs(np.diff(np.sign(back[np.abs(back) > 1e-9])))) == 4  # two changes of sense


def test_motions_take_the_turns_they_are_given():
    held = motion(dataclasses.replace(JUKI, motion="constant-speed", turns=7.0))
    assert float(held.angle(held.duration) - held.angle(0.0)) == pytest.approx(14.0 * np.pi)
    ramped = motion(dataclasses.replace(JUKI, ramp_turns=3.0, hold_turns=2.0))
    assert float(ramped.angle(ramped.duration) - ramped.angle(0.0)) == pytest.approx(10.0 * np.pi)
    slow = motion(dataclasses.replace(JUKI, scaled="time", scale=50.0))
    assert slow.duration == pytest.approx(50.0 * motion(JUKI).duration)
    assert dataclasses.replace(JUKI, steps_per_turn=120.0).step == pytest.approx(0.06 / 120.0)


@pytest.mark.parametrize("what", ["position", "velocity"])
@pytest.mark.parametrize("size", [1e-9, 1e-3])
def test_a_disturbed_start_is_off_by_so_much_and_no_more(what, size):
    conditions = dataclasses.replace(JUKI, motion="constant-speed", disturbed=what, disturbance=size)
    true = case(conditions)
    given, fits = scene(conditions, true), true.scene(frozenset(Channel))
    scale = scene_size(fits) * (conditions.rate if what == "velocity" else 1.0)
    for body, other in zip(given.bodies, fits.bodies, strict=True):
        off = np.hypot(*(np.array(getattr(body, what)) - getattr(other, what)))
        assert off == pytest.approx(size * scale, rel=1e-6)
    assert (start_misfit(given) is None) is (size < 1e-6)


def test_a_released_crank_is_let_go_as_told():
    spinning = Conditions("juki-mf7923d", motion="released", turns=3.0, start_angle=30.0)
    one = case(spinning)
    assert isinstance(one.drive, Free)
    assert one.motion.start == pytest.approx((np.pi / 6.0, spinning.rate))
    assert one.motion.duration == pytest.approx(0.18)
    resting = case(dataclasses.replace(spinning, spinning=False, torque=0.1))
    assert resting.motion.start[1] == 0.0
    assert resting.drive.torque == 0.1


def test_what_is_told_is_what_differs_from_a_plain_run_up():
    told = dataclasses.replace(JUKI, link="coupler", mass_factor=10.0, at=(1.0, 2.0)).differing
    assert told == {"linkage": "juki-mf7923d", "link": "coupler", "mass_factor": 10.0, "at": [1.0, 2.0]}
    assert Conditions(**{k: tuple(v) if isinstance(v, list) else v for k, v in told.items()}).mass_factor == 10.0


def test_an_unknown_linkage_is_refused():
    with pytest.raises(DescriptionError, match="does not exist"):
        linkage(Conditions("no-such-linkage"))
