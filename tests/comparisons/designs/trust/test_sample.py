"""Designs of a sample: within the ranges, in the assembly modes of the file, each a file of its own, and repeatable."""

import math

import numpy as np
import pytest

from analytic.description.changes import numbers, without
from analytic.description.loading import load, parse
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import parameter
from comparisons.designs.trust.sample import hypercube, rows, sample
from comparisons.reference.case import Case
from reports.command_line.motion_choice import MotionChoice, motions
from tests.analytic.linkages import FOLDER

RIMOLDI = load("rimoldi-164")
TURN = motions(MotionChoice())
WIDE = np.array([[150.0, 200.0], [-60.0, -20.0]])  # three quarters of these designs do not assemble
SHORT_RANGE = np.array([[23.0, 27.0]])


def drawn(seed=0, wanted=8, ends=WIDE, linkage=RIMOLDI, names=("rod.B.x", "rocker.C.x")):
    found = [parameter(linkage, name) for name in names]
    return sample(linkage, found, hypercube(ends, seed), wanted, TURN)


def test_a_hypercube_has_a_design_in_each_interval_of_every_range():
    values = hypercube(WIDE, 3)(20)
    for column, (low, high) in zip(values.T, WIDE, strict=True):
        assert sorted(np.floor((column - low) / (high - low) * 20).astype(int)) == list(range(20))
    assert np.array_equal(values, hypercube(WIDE, 3)(20))
    assert not np.array_equal(values, hypercube(WIDE, 4)(20))


def test_rows_of_a_table_are_drawn_once_each():
    table = np.arange(10.0).reshape(5, 2)
    draw = rows(5, table.__getitem__, 1)
    assert sorted(np.concatenate([draw(2), draw(9)])[:, 0]) == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert len(draw(1)) == 0


def test_designs_are_files_in_the_assembly_modes_of_the_original():
    found = drawn()
    assert [one.number for one in found.designs] == list(range(9))
    assert found.designs[0].linkage is RIMOLDI
    assert found.in_vain > 0
    signs = [dyad.sign for dyad in Mechanism(RIMOLDI).structure.dyads]
    for one in found.designs[1:]:
        linkage = one.linkage
        assert (linkage.name, linkage.variant) == (f"rimoldi-164-d{one.number:03d}", f"design {one.number}")
        own = parse(linkage.text, "any", "any.toml")
        assert numbers(own)["rod.B.x"] == pytest.approx(one.values[0] * 1e-3, rel=1e-15)
        assert numbers(own)["rocker.C.x"] == pytest.approx(one.values[1] * 1e-3, rel=1e-15)
        assert [dyad.sign for dyad in Mechanism(own).structure.dyads] == signs
        Case(Mechanism(linkage), TURN[0]).check_motion()
    assert found.designs[4].values == drawn().designs[4].values
    assert found.designs[4].values != drawn(seed=1).designs[4].values


def test_the_transmission_angle_is_that_of_a_four_bar():
    """Its ends are where crank and frame lie in one line: the law of cosines."""
    found = drawn(linkage=load(str(FOLDER / "double-crank.toml")), names=("coupler.B.x",), ends=SHORT_RANGE, wanted=3)
    for one in found.designs:
        coupler, follower, crank, frame = one.values[0], 28.0, 30.0, math.hypot(10.0, 3.0)
        ends = [(coupler**2 + follower**2 - d**2) / (2 * coupler * follower) for d in (crank - frame, crank + frame)]
        angles = [math.degrees(math.acos(end)) for end in ends]
        assert one.transmission == pytest.approx(min(min(angle, 180.0 - angle) for angle in angles), abs=2e-3)


def test_gravity_that_was_left_out_stays_out():
    found = drawn(wanted=1, linkage=without(RIMOLDI, "gravity"))
    assert found.designs[1].linkage.gravity == (0.0, 0.0)


def test_designs_that_cannot_move_are_told():
    with pytest.raises(LinkproofError, match=r"expected designs of 'rimoldi-164' .* got none among 40 drawn"):
        drawn(ends=np.array([[300.0, 310.0], [-30.0, -20.0]]), wanted=2)
    with pytest.raises(LinkproofError, match="--designs: expected 1 design or more, got 0"):
        drawn(wanted=0)
