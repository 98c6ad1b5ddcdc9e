"""Positions of the bodies: over a turn, over a range, over the time of a motion."""

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import over_motion, over_reach
from comparisons.datasheet.curves import Curves
from comparisons.reference.case import Case
from tests.analytic.linkages import FOLDER


def over(mechanism, motion):
    return over_motion(Curves(Case(mechanism, motion)))


def test_a_turn_ends_as_it_began():
    found = over_reach(Mechanism(load("slotted-takeup")))
    assert (found.over, found.closed) == ("phi", True)
    for x, y, turned in found.bodies.values():
        assert np.allclose([x[0], y[0]], [x[-1], y[-1]], atol=1e-12)
        assert np.isclose(np.cos(turned[0] - turned[-1]), 1.0)
        assert np.max(np.abs(np.diff(turned))) < 1.0


def test_less_than_a_turn_is_shown_over_its_time():
    motion = crank_motion("run-up", speed=2.0, ramp_time=1.0, hold_time=0.5)
    found = over(Mechanism(load("juki-mf7923d")), motion)
    assert (found.over, found.closed) == ("time", False)
    assert np.allclose(found.bodies["crank"][2], motion.angle(found.axis))


def test_the_carrier_of_a_slots_point_is_named():
    linkage = load(str(FOLDER / "ground-pin-in-slot.toml"))
    found = over_reach(Mechanism(linkage))
    for slot in linkage.slots:
        carrier = found.carriers[slot.point]
        assert carrier == "ground" or slot.point in linkage.links[carrier].points
