"""Signs of the five dyads as the articles define them, dead positions, and parallel guides."""

import pickle

import numpy as np
import pytest

from analytic.kinematics import frames
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.structure import Dyad, Prismatic, Revolute
from tests.analytic.tolerances import EPS

STILL = (0.0, 0.0, 1.0, 0.0)
STILL_AT = {"ground": STILL}


def _pin(point, far, near_local, far_local, near="ground"):
    return Revolute(point, near, far, near_local, far_local)


def _rail(near, far, origin=(0.0, 0.0), turn=(1.0, 0.0)):
    return Prismatic(far, near, far, turn, origin, (1.0, 0.0))


def _two_arms(sign, far="ground"):
    joints = _pin("A", "one", (1.0, 1.0), (0.0, 0.0)), _pin("C", "one", (4.0, 0.0), (3.0, 0.0), near="two")
    return Dyad("RRR", "one", "two", *joints, _pin("B", "two", (6.0, 1.0), (0.0, 0.0), near=far), sign)


@pytest.mark.parametrize("sign", [1, -1])
def test_rrr_has_its_inner_pin_left_of_the_line_ab_for_plus(sign):
    one, two = DyadSolver(_two_arms(sign)).poses(STILL_AT)
    pin = frames.point(one, (3.0, 0.0))  # the 3-4-5 triangle
    assert pin == pytest.approx((1.0 + 1.8, 1.0 + sign * 2.4), rel=4 * EPS)
    assert frames.point(two, (4.0, 0.0)) == pytest.approx(pin, rel=4 * EPS)


@pytest.mark.parametrize("sign", [1, -1])
def test_rrp_has_its_arm_along_the_guide_for_plus(sign):
    joints = _pin("A", "arm", (0.0, 3.0), (0.0, 0.0)), _pin("C", "arm", (0.0, 0.0), (5.0, 0.0), near="slider")
    solver = DyadSolver(Dyad("RRP", "arm", "slider", *joints, _rail("ground", "slider"), sign))
    _, slider = solver.poses(STILL_AT)
    assert slider[:2] == pytest.approx((sign * 4.0, 0.0), abs=8 * EPS)


@pytest.mark.parametrize("sign", [1, -1])
def test_rpr_has_its_pin_ahead_on_the_line_for_plus(sign):
    joints = _pin("A", "slider", (0.0, 5.0), (0.0, 0.0)), _rail("rocker", "slider", origin=(0.0, 3.0))
    solver = DyadSolver(Dyad("RPR", "slider", "rocker", *joints, _pin("B", "rocker", (0.0, 0.0), (0.0, 0.0)), sign))
    slider, rocker = solver.poses(STILL_AT)
    assert frames.point(rocker, (sign * 4.0, 3.0)) == pytest.approx((0.0, 5.0), abs=8 * EPS)
    assert slider[2:] == pytest.approx(rocker[2:], rel=4 * EPS)


def test_a_dead_position_and_links_that_do_not_meet():
    solver = DyadSolver(_two_arms(1, "other"))
    solver.poses({"ground": STILL, "other": (2.0 * (1.0 - 1e-16), 0.0, 1.0, 0.0)})  # outstretched
    missing, lengths = solver.missing()
    assert missing >= -EPS * lengths
    assert not solver.moves
    apart = np.array([0.0, 2.5, 4.0])
    solver = DyadSolver(_two_arms(1, "other"))
    solver.poses({"ground": STILL, "other": (apart, 0.0 * apart, 1.0, 0.0)})
    assert solver.moves.tolist() == [True, False, False]
    assert solver.missing()[0] == pytest.approx(2.0 - apart)


@pytest.mark.parametrize("tilt", [0.0, 1e-12])
def test_parallel_guides_are_distinguished_from_crossing_ones(tilt):
    along = Prismatic("one", "cart", "one", (1.0, 0.0), (0.0, 1.0), (1.0, 0.0))
    almost = Prismatic("two", "ground", "two", (1.0, tilt), (0.0, 0.0), (1.0, tilt))
    solver = DyadSolver(Dyad("PRP", "one", "two", along, _pin("C", "one", (0.0, 0.0), (0.0, 0.0), near="two"), almost))
    solver.poses({"ground": STILL, "cart": (np.zeros(1), np.zeros(1), 1.0, 0.0)})
    assert not np.any(solver.moves)
    assert np.all(solver.missing()[0] < 0.0)


def test_a_solver_can_be_pickled():
    solver = DyadSolver(_two_arms(1))
    poses = solver.poses(STILL_AT)
    assert pickle.loads(pickle.dumps(solver)).poses(STILL_AT) == poses
