"""The five dyads by themselves: signs as the articles define them, both modes of each, crossings that are known."""

import pickle

import numpy as np
import pytest

from analytic.kinematics import frames
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.structure import Dyad, Prismatic, Revolute
from tests.analytic.tolerances import EPS

HALF = np.sqrt(0.5)
STILL_AT = {"ground": (0.0, 0.0, 1.0, 0.0)}


def _pin(point, far, near_local, far_local, near="ground"):
    return Revolute(point, near, far, near_local, far_local)


def _rail(near, far, origin=(0.0, 0.0), turn=(1.0, 0.0)):
    return Prismatic(far, near, far, turn, origin, (1.0, 0.0))


def _two_arms(sign):
    return Dyad(
        "RRR",
        "one",
        "two",
        _pin("A", "one", (1.0, 1.0), (0.0, 0.0)),
        _pin("C", "one", (4.0, 0.0), (3.0, 0.0), near="two"),
        _pin("B", "two", (6.0, 1.0), (0.0, 0.0)),
        sign,
    )


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


def test_the_two_modes_meet_in_the_dead_position_and_the_group_knows_it():
    outstretched = {"ground": (0.0, 0.0, 1.0, 0.0), "other": (2.0 * (1.0 - 1e-16), 0.0, 1.0, 0.0)}
    joints = _two_arms(1)
    far = Revolute("B", "other", "two", (6.0, 1.0), (0.0, 0.0))
    solver = DyadSolver(Dyad("RRR", "one", "two", joints.first_joint, joints.inner_joint, far, 1))
    solver.poses(outstretched)
    missing, lengths = solver.missing()
    assert missing >= -EPS * lengths
    assert not solver.moves
    solver = DyadSolver(_two_arms(1))
    solver.poses(STILL_AT)
    assert solver.moves


def test_what_is_missing_is_negative_where_the_links_do_not_meet():
    apart = np.array([0.0, 2.5, 4.0])
    joints = _two_arms(1)
    far = Revolute("B", "other", "two", (6.0, 1.0), (0.0, 0.0))
    solver = DyadSolver(Dyad("RRR", "one", "two", joints.first_joint, joints.inner_joint, far, 1))
    solver.poses({"ground": (0.0, 0.0, 1.0, 0.0), "other": (apart, 0.0 * apart, 1.0, 0.0)})
    assert not np.all(solver.moves)
    assert solver.missing()[0] == pytest.approx(2.0 - apart)


def _hosts(x):
    """The ground, and a body at x that moves along the ground's x axis."""
    return {"ground": (0.0, 0.0, 1.0, 0.0), "cart": (x, 0.0 * x, 1.0, 0.0)}


RATES = {"ground": frames.STILL, "cart": (1.0, 0.0, 0.0)}


def test_prp_finds_the_crossing_of_its_guides_and_follows_it():
    # A vertical guide on the cart and a guide rising by 45° on the ground: the pin climbs as the cart moves.
    x = np.linspace(-2.0, 3.0, 7)
    up = Prismatic("one", "cart", "one", (0.0, 1.0), (0.0, 0.0), (0.0, 1.0))
    rising = Prismatic("two", "ground", "two", (HALF, HALF), (0.0, 1.0), (HALF, HALF))
    pin = Revolute("C", "two", "one", (0.0, 0.0), (0.0, 0.0))
    solver = DyadSolver(Dyad("PRP", "one", "two", up, pin, rising))
    one, two = solver.poses(_hosts(x))
    assert np.allclose(one[:2], [x, x + 1.0], atol=8 * EPS)
    assert np.allclose(two[:2], one[:2], atol=8 * EPS)
    first, _ = solver.rates(RATES)
    assert np.allclose(np.broadcast_arrays(*first[:2]), 1.0, rtol=8 * EPS)


def test_rpp_keeps_its_pin_and_turns_with_its_host():
    # A block pinned to the cart slides up and down in a yoke that slides along the ground: the yoke follows x.
    x = np.linspace(-2.0, 3.0, 7)
    pinned = Revolute("A", "cart", "block", (0.5, 2.0), (0.0, 0.0))
    in_yoke = Prismatic("block", "yoke", "block", (0.0, 1.0), (0.0, 0.0), (0.0, 1.0))
    on_ground = Prismatic("yoke", "ground", "yoke", (1.0, 0.0), (0.0, 0.0), (1.0, 0.0))
    solver = DyadSolver(Dyad("RPP", "block", "yoke", pinned, in_yoke, on_ground))
    block, yoke = solver.poses(_hosts(x))
    assert np.allclose(yoke[0], x + 0.5, atol=8 * EPS)
    assert np.allclose(np.broadcast_arrays(*block[:2]), np.broadcast_arrays(x + 0.5, 2.0), atol=8 * EPS)
    _, rate = solver.rates(RATES)
    assert np.allclose(rate[0], 1.0, rtol=8 * EPS)


@pytest.mark.parametrize("tilt", [0.0, 1e-12])
def test_parallel_guides_are_told_apart_from_crossing_ones(tilt):
    along = Prismatic("one", "cart", "one", (1.0, 0.0), (0.0, 1.0), (1.0, 0.0))
    almost = Prismatic("two", "ground", "two", (1.0, tilt), (0.0, 0.0), (1.0, tilt))
    solver = DyadSolver(Dyad("PRP", "one", "two", along, Revolute("C", "two", "one", (0.0, 0.0), (0.0, 0.0)), almost))
    solver.poses(_hosts(np.zeros(1)))
    assert not np.any(solver.moves)
    assert np.all(solver.missing()[0] < 0.0)


def test_a_solver_travels_to_another_process():
    solver = DyadSolver(_two_arms(1))
    solver.poses(STILL_AT)
    again = pickle.loads(pickle.dumps(solver))
    assert again.own == solver.own
    assert again.formulas is solver.formulas
