"""The reference: computed once a clock, as far as a quantity needs it; the farthest point."""

import math
import pickle

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion, swing
from analytic.description.loading import load
from analytic.dynamics import joint_forces, reduced
from analytic.kinematics.dead_centres import top_dead_centre, top_of_turn
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import MOST_CLOCKS, Case, zero_of_output
from comparisons.datasheet.building import usual_case
from tests.analytic.linkages import from_text, mechanism
from tests.analytic.swinging import double_rocker

SIX_BAR, SPRUNG = "rimoldi-164", "spring-and-damper"
MOTION = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02)
TIMES = np.linspace(0.0, MOTION.duration, 50)


def test_the_truth_on_a_clock_is_the_closed_form():
    sample = mechanism(SPRUNG)
    at = Case(sample, MOTION).at(TIMES)
    sweep, speed, acceleration = sample.sweep(MOTION.angle(TIMES)), MOTION.speed(TIMES), MOTION.acceleration(TIMES)
    assert np.array_equal(at.inertia, reduced.reduced_inertia(sweep))
    assert np.array_equal(at.torque, reduced.drive_torque(sweep, speed, acceleration))
    forces = joint_forces.reactions(sweep, speed, acceleration).forces
    assert all(np.array_equal(at.joint_forces[name], force) for name, force in forces.items())


def test_a_case_keeps_the_truth_of_its_latest_clocks_alone_and_travels_without_it():
    case = Case(mechanism(SIX_BAR), MOTION, conditions="as tested")
    kept = [case.at(TIMES + shift) for shift in 1e-3 * np.arange(MOST_CLOCKS + 2)]
    assert case.at(kept[-1].time) is kept[-1]
    assert case.at(kept[-MOST_CLOCKS].time) is kept[-MOST_CLOCKS]
    assert len(case._seen) == MOST_CLOCKS
    assert case.at(kept[0].time) is not kept[0]
    there = pickle.loads(pickle.dumps(case))
    assert there._seen == {}
    assert (there.conditions, there.joint_names()) == (case.conditions, case.joint_names())
    assert np.array_equal(there.at(TIMES).inertia, case.at(TIMES).inertia)


CROSSED = """
title = "a pin in the slot of the crank and on a guide of the ground"
units = {{ length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }}
crank = "crank"
output = {{ point = "D", along = [{0}, {1}] }}
[ground]
O = [0, 0]
[links.crank]
points = {{ O = [0, 0], A = [50, 0] }}
[links.block]
slides = {{ point = "D", on = "crank", through = [0, {offset}], along = [1, 0] }}
[links.slide]
slides = {{ point = "D", through = [0, 100], along = [{cosine}, {sine}] }}
[sketch]
angle = 89
points = {{ D = [0, 100] }}
"""


def test_a_crank_that_turns_fully_counts_from_its_top_dead_centre_whatever_it_does():
    mechanism = Mechanism(load("juki-mf7923d"))
    motion = swing("cycloidal", math.radians(100.0), math.radians(140.0), speed=1.0)
    assert zero_of_output(mechanism, motion) == top_dead_centre(mechanism).coordinate


def test_a_crank_that_cannot_counts_from_the_farthest_point_of_the_motion():
    """At the crank angle where crank and coupler are in line the coupler's end is farthest from the crank's pivot."""
    mechanism = Mechanism(double_rocker(along=(-1.0, 0.0)))
    assert top_of_turn(mechanism) is None
    motion = swing("cycloidal", math.radians(-10.0), math.radians(65.0), time=0.3)
    dense = [
        max(mechanism.sweep(motion.angle([0.3 * (k + shift) / 5000 for k in range(5000)])).output())
        for shift in (0.0, 0.5)
    ]
    assert zero_of_output(mechanism, motion) == pytest.approx(max(dense), rel=1e-6)
    assert zero_of_output(mechanism, motion) >= max(dense)
    short = swing("cycloidal", math.radians(50.0), math.radians(65.0), time=0.3)
    ends = mechanism.sweep([math.radians(50.0), math.radians(65.0)]).output()
    assert zero_of_output(mechanism, short) == pytest.approx(max(ends), rel=1e-15)


@pytest.mark.parametrize(("along", "offset"), [((1, 0), 0), ((0.6, 0.8), -30)])
def test_parallel_guides_between_two_steps_leave_no_full_turn(along, offset):
    """From (0, h) the slot crosses a guide at β after (offset - h cos φ) / sin(β - φ), without a bound at β."""
    tilt = 0.2
    text = CROSSED.format(*along, offset=offset, cosine=math.cos(tilt), sine=math.sin(tilt))
    mechanism = from_text(text)
    case = usual_case(mechanism)
    assert top_of_turn(mechanism) is None
    low, high = case.reach
    assert tilt < low < high < tilt + math.pi
    phi = np.linspace(low, high, 20_001)
    way = (1e-3 * offset - 0.1 * np.cos(phi)) / np.sin(tilt - phi)
    place = along[0] * way * math.cos(tilt) + along[1] * (0.1 + way * math.sin(tilt))
    assert zero_of_output(mechanism, case.motion) == pytest.approx(np.max(place), rel=1e-6)
    assert zero_of_output(mechanism, case.motion) >= np.max(place) * (1.0 - 1e-12)
