"""The axes' conditions become scenes and motions."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.description import changes
from analytic.description.loading import catalogue, load
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import reactions
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.stress.cells import (
    RELEASED,
    Conditions,
    axes,
    case,
    chosen_axes,
    linkage,
    motion,
    reversal,
    scene,
)
from engines.mechanics.joints import scene_size
from engines.mechanics.start_check import start_misfit
from engines.scene import Channel

EVERY = [(axis, row) for axis in axes().values() for row in axis.rows]
STRETCH = 1e4  # times the easy value: beyond it a released motion is only slow to integrate


@pytest.mark.parametrize(
    ("axis", "row"),
    [pytest.param(*one, marks=() if one in EVERY[::7] else pytest.mark.nightly) for one in EVERY],
    ids=lambda one: getattr(one, "name", None) or one.label,
)
def test_every_row_is_a_scene_that_fits_its_joints_at_both_ends_and_at_its_easy_value(axis, row):
    values = axis.chosen_values(row, quick=False)
    if row.conditions.motion == RELEASED:
        values = tuple(value for value in values if value <= STRETCH)[:3]
    for value in {values[0], values[-1], axis.good}:
        conditions = axis.conditions(row.label, value)
        given = scene(conditions, case(conditions))
        misfit = start_misfit(given)
        assert (misfit is None) or (conditions.disturbed and value > 1e-7), (value, misfit)
        assert all(body.mass > 0.0 for body in given.bodies)


@pytest.mark.parametrize("axis", axes().values(), ids=lambda axis: axis.name)
def test_an_axis_varies_a_field_over_values_that_hold_its_easy_one(axis):
    assert axis.vary in {field.name for field in fields(Conditions)}
    assert axis.good in axis.values
    assert len(set(axis.values)) == len(axis.values)
    assert set(axis.quick) <= set(axis.values)
    assert axis.settings or axis.methods
    assert sum(row.quick for row in axis.rows) >= 1
    assert len({row.label for row in axis.rows}) == len(axis.rows)
    assert all("/" not in row.label for row in axis.rows)  # it separates the words of a cell's name
    for row in axis.rows:
        assert getattr(axis.conditions(row.label, 0.125), axis.vary) == 0.125


def test_axes_are_chosen_by_name_in_the_tables_order():
    names = list(axes())
    assert [axis.name for axis in chosen_axes(())] == names
    assert [axis.name for axis in chosen_axes(reversed(names[:3]))] == names[:3]
    with pytest.raises(UnknownNameError, match=r"unknown axis 'mas'.*mass"):
        chosen_axes(["mas"])
    with pytest.raises(UnknownNameError, match="row of axis 'mass'"):
        axes()["mass"].row("four-bar")


JUKI = Conditions("juki-mf7923d")
POWERS = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)
LOADED = ["tests/linkages/spring-and-damper.toml", "tests/linkages/force-over-angle.toml", *catalogue()]


@settings(max_examples=10)
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
    forces = reactions(found, speed, acceleration).forces
    others = reactions(there, speed / time, acceleration / time**2).forces
    peak = max(np.max(np.abs(force)) for force in forces.values())
    for joint, force in forces.items():
        assert np.max(np.abs(force - others[joint] * time**2 / (mass * length))) < 1e-10 * peak


def test_one_link_gets_heavier_and_no_other():
    plain, heavy = linkage(JUKI), linkage(replace(JUKI, link="coupler", mass_factor=1e3))
    assert heavy.links["coupler"].mass == pytest.approx(1e3 * plain.links["coupler"].mass)
    assert heavy.links["coupler"].inertia == pytest.approx(1e3 * plain.links["coupler"].inertia)
    assert heavy.links["coupler"].centre == plain.links["coupler"].centre
    assert {name for name in plain.links if heavy.links[name] != plain.links[name]} == {"coupler"}


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
    held = motion(replace(JUKI, motion="constant-speed", turns=7.0))
    assert float(held.angle(held.duration) - held.angle(0.0)) == pytest.approx(14.0 * np.pi)
    ramped = motion(replace(JUKI, ramp_turns=3.0, hold_turns=2.0))
    assert float(ramped.angle(ramped.duration) - ramped.angle(0.0)) == pytest.approx(10.0 * np.pi)
    slow = motion(replace(JUKI, scaled="time", scale=50.0))
    assert slow.duration == pytest.approx(50.0 * motion(JUKI).duration)
    assert replace(JUKI, steps_per_turn=120.0).step == pytest.approx(0.06 / 120.0)


@pytest.mark.parametrize("what", ["position", "velocity"])
@pytest.mark.parametrize("size", [1e-9, 1e-3])
def test_a_disturbed_start_is_off_by_so_much_and_no_more(what, size):
    conditions = replace(JUKI, motion="constant-speed", disturbed=what, disturbance=size)
    true = case(conditions)
    given, fits = scene(conditions, true), true.scene(frozenset(Channel))
    scale = scene_size(fits) * (conditions.rate if what == "velocity" else 1.0)
    for body, other in zip(given.bodies, fits.bodies, strict=True):
        off = np.hypot(*(np.array(getattr(body, what)) - getattr(other, what)))
        assert off == pytest.approx(size * scale, rel=1e-6)
    assert (start_misfit(given) is None) is (size < 1e-6)


def test_only_conditions_that_differ_from_a_plain_run_up_are_saved():
    told = replace(JUKI, link="coupler", mass_factor=10.0, at=(1.0, 2.0)).differing
    assert told == {"linkage": "juki-mf7923d", "link": "coupler", "mass_factor": 10.0, "at": [1.0, 2.0]}
    assert Conditions(**{k: tuple(v) if isinstance(v, list) else v for k, v in told.items()}).mass_factor == 10.0


def damped(factor, turns=0.5):
    return Conditions(
        "sprung-crank-rocker", motion="released", start_angle=60.0, spinning=False, turns=turns, torque=0.2,
        load="dampers", load_factor=factor,
    )  # fmt: skip


def test_a_crank_that_is_held_back_for_ever_is_refused_in_a_sentence():
    assert case(damped(1.0)).motion.duration == pytest.approx(0.03)
    with pytest.raises(LinkproofError, match=r"time constant Jeq/b or less, got \de\+\d+; damp less"):
        case(damped(1e8))
