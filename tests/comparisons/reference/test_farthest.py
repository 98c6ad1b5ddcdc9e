"""Where S counts from: the top dead centre of a full turn, or the farthest point that a swing reaches."""

import math

import pytest

from analytic.description.crank_motion import swing
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from analytic.turn.farthest import top_of_turn
from analytic.turn.unit_functions import top_dead_centre
from comparisons.reference.farthest import farthest
from tests.analytic.swinging import double_rocker


def test_a_crank_that_turns_fully_counts_from_its_top_dead_centre_whatever_it_does():
    mechanism = Mechanism(load("juki-mf7923d"))
    motion = swing("cycloidal", math.radians(100.0), math.radians(140.0), speed=1.0)
    assert farthest(mechanism, motion) == top_dead_centre(mechanism).coordinate


def test_a_crank_that_cannot_counts_from_the_farthest_point_of_the_motion():
    """At the crank angle where crank and coupler are in line the coupler's end is farthest from the crank's pivot."""
    mechanism = Mechanism(double_rocker(along=(-1.0, 0.0)))
    assert top_of_turn(mechanism) is None
    motion = swing("cycloidal", math.radians(-10.0), math.radians(65.0), time=0.3)
    dense = [
        max(mechanism.sweep(motion.angle([0.3 * (k + shift) / 5000 for k in range(5000)])).output())
        for shift in (0.0, 0.5)
    ]
    assert farthest(mechanism, motion) == pytest.approx(max(dense), rel=1e-6)
    assert farthest(mechanism, motion) >= max(dense)
    short = swing("cycloidal", math.radians(50.0), math.radians(65.0), time=0.3)
    ends = mechanism.sweep([math.radians(50.0), math.radians(65.0)]).output()
    assert farthest(mechanism, short) == pytest.approx(max(ends), rel=1e-15)
