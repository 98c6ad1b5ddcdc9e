"""Positions of the bodies: those of the closed form, over a turn or between the ends of a range."""

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.kinematics.crank_range import crank_range
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.positions import over_reach
from tests.analytic.linkages import from_text
from tests.analytic.textbook import DOUBLE_ROCKER


def test_a_turn_ends_where_it_began():
    mechanism = Mechanism(load("slotted-takeup"))
    found = over_reach(mechanism)
    assert found.closed
    assert found.carriers == {slot.point: mechanism.sweep(found.angle).carrier(slot.point) for slot in
                              mechanism.linkage.slots}  # fmt: skip
    for x, y, angle in found.bodies.values():
        assert (x[0], y[0]) == pytest.approx((x[-1], y[-1]), abs=1e-12)
        turns = (angle[-1] - angle[0]) / (2.0 * np.pi)
        assert turns == pytest.approx(round(turns), abs=1e-12)


def test_a_range_is_passed_from_end_to_end():
    mechanism = from_text(DOUBLE_ROCKER)
    found = over_reach(mechanism)
    assert not found.closed
    assert (found.angle[0], found.angle[-1]) == pytest.approx(crank_range(mechanism).limits)
    crank = found.bodies[mechanism.linkage.crank]
    np.testing.assert_allclose(crank[2], found.angle)
