"""Equilibria against extended precision and energy, and steady rotation against the balance of work."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from analytic.description.law import Law
from analytic.dynamics import reduced
from analytic.dynamics.reduced import equilibria
from analytic.dynamics.released import free_motion, last_turns, steady_state
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from tests.analytic import article_000
from tests.analytic.linkages import DOUBLE_ROCKER, PENDULUM, ROTOR, from_text, mechanism, needs_extended_precision

# rad. A moment of a few roundings over its slope.
ANGLE = 1e-13
# The balance of work over a turn, relative: the speed is settled to 1e-10, its mean is a sum of many samples.
WORK = 1e-8
# rad. Steps to either side of an equilibrium: for a slope, for a look at the energy, for a release.
TINY, SMALL, NEAR = 1e-6, 1e-4, 1e-3
# Relative, of moments that cancel.
CANCELLED = 1e-12
# Of a motion only looked at.
GLANCE = 1e-9
# Degrees; the specification prints 268.77.
PRINTED = 0.005


@needs_extended_precision
def test_slotted_takeup_rests_near_the_published_angle():
    result = equilibria(mechanism("slotted-takeup"))
    assert [place.stable for place in result] == [False, True]
    assert math.degrees(result[1].angle) == pytest.approx(268.77, abs=PRINTED)
    for place in result:
        angle = article_000.Long(place.angle)
        force = article_000.acceleration(angle, article_000.Long(0), 0, 0)
        slope = (article_000.acceleration(angle + TINY, article_000.Long(0), 0, 0) - force) / TINY
        assert abs(force / slope) < ANGLE


@pytest.mark.parametrize("torque", [0.0, 0.005])
@pytest.mark.parametrize("name", ["slotted-takeup", "spring-and-damper"])
def test_equilibria_are_the_extremes_of_energy_which_take_turns(name, torque):
    sample = mechanism(name)
    places = equilibria(sample, torque)
    assert len(places) % 2 == 0
    assert all(one.stable != two.stable for one, two in itertools.pairwise(places))
    for place in places:
        around = sample.sweep(place.angle + SMALL * np.arange(-1.0, 2.0))
        energy = reduced.potential_energy(around) - torque * around.angle
        assert (min(energy[0], energy[2]) > energy[1]) == place.stable
        assert (max(energy[0], energy[2]) < energy[1]) != place.stable


def test_a_torque_over_the_angle_moves_the_equilibrium():
    sample = from_text(PENDULUM)  # moment 9.81·cos φ N m clockwise
    law = Law(np.array([[4.905], [4.905], [4.905]]), np.array([0.0, 2.0, 4.0]))
    for torque in (4.905, law):
        turned = [place.angle for place in equilibria(sample, torque)]
        assert turned == pytest.approx([math.pi / 3.0, 5.0 * math.pi / 3.0], abs=ANGLE)


def test_no_equilibrium_where_nothing_holds_the_crank():
    assert equilibria(mechanism("slotted-takeup"), 1.0) == ()
    assert equilibria(from_text(ROTOR)) == ()
    weightless = dataclasses.replace(mechanism("two-crank-takeup").linkage, gravity=(0.0, 0.0))
    assert equilibria(Mechanism(weightless)) == ()


def test_a_crank_that_only_swings_is_looked_at_where_it_can_stand():
    sample = from_text(DOUBLE_ROCKER)
    result = equilibria(sample)
    assert any(place.stable for place in result)
    for place in result:
        moments = reduced.generalised_force(sample.sweep(place.angle + np.array([-NEAR, 0.0, NEAR])))
        assert abs(moments[1]) < CANCELLED * np.max(np.abs(moments))
        assert (moments[0] > 0.0 > moments[2]) == place.stable


@pytest.mark.nightly
def test_the_steady_state_is_where_the_motion_ends_up():
    sample = mechanism("slotted-takeup")
    steady = steady_state(sample, 0.025)
    assert steady.mean_speed == pytest.approx(125.0, rel=0.005)  # the specification's M1/b to half a per cent
    assert steady.smallest < steady.mean_speed < 0.025 / sample.linkage.dampers[0].coefficient  # the mean over φ
    back = steady_state(sample, -0.025)
    assert back.smallest < back.mean_speed < back.largest < 0.0
    long = free_motion(sample, torque=0.025, start_speed=124.9, duration=32.0, tolerance=GLANCE)
    ended = last_turns(long, 3)
    assert dataclasses.astuple(ended) == pytest.approx(dataclasses.astuple(steady), rel=WORK)
    time = np.linspace(32.0 - 2.0 * math.pi / steady.mean_speed, 32.0, 5761)
    work = np.trapezoid(long.speed(time) ** 2, time) / (2.0 * math.pi)  # the mean over φ, since dφ = ω dt
    assert work == pytest.approx(0.025 / sample.linkage.dampers[0].coefficient, rel=WORK)
    turns = last_turns(free_motion(sample, torque=0.025, start_angle=1.0, start_speed=120.0, duration=1.0), 5)
    assert 120.0 < turns.mean_speed < steady.mean_speed


def test_a_rotor_turns_evenly():
    result = steady_state(from_text(ROTOR), 0.3)
    assert result.mean_speed == pytest.approx(6.0, rel=WORK)
    assert result.largest - result.smallest < WORK


def test_what_has_no_steady_rotation_says_why():
    sample = mechanism("slotted-takeup")
    for torque in (0.0005, -1e-9):
        with pytest.raises(LinkproofError, match="stalls under a mean torque of"):
            steady_state(sample, torque)
    with pytest.raises(LinkproofError, match="expected a damper and a torque"):
        steady_state(sample, 0.0)
    with pytest.raises(LinkproofError, match="expected a damper and a torque"):
        steady_state(mechanism("juki-mf7923d"), 1.0)
    with pytest.raises(LinkproofError, match="at least 3 whole turns"):
        last_turns(free_motion(sample, start_angle=4.8, duration=1.0), 3)
