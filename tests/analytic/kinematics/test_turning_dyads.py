"""RRR, RRP and RPR by themselves: signs as the articles define them, and both modes of each."""

import numpy as np
import pytest

from analytic.kinematics import frames
from analytic.kinematics.dyad_solvers import group
from analytic.kinematics.structure import Dyad, Prismatic, Revolute
from tests.analytic.tolerances import EPS

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
    one, two = group(_two_arms(sign)).poses(STILL_AT)
    pin = frames.point(one, (3.0, 0.0))  # the 3-4-5 triangle
    assert pin == pytest.approx((1.0 + 1.8, 1.0 + sign * 2.4), rel=4 * EPS)
    assert frames.point(two, (4.0, 0.0)) == pytest.approx(pin, rel=4 * EPS)


@pytest.mark.parametrize("sign", [1, -1])
def test_rrp_has_its_arm_along_the_guide_for_plus(sign):
    joints = _pin("A", "arm", (0.0, 3.0), (0.0, 0.0)), _pin("C", "arm", (0.0, 0.0), (5.0, 0.0), near="slider")
    solver = group(Dyad("RRP", "arm", "slider", *joints, _rail("ground", "slider"), sign))
    _, slider = solver.poses(STILL_AT)
    assert slider[:2] == pytest.approx((sign * 4.0, 0.0), abs=8 * EPS)


@pytest.mark.parametrize("sign", [1, -1])
def test_rpr_has_its_pin_ahead_on_the_line_for_plus(sign):
    joints = _pin("A", "slider", (0.0, 5.0), (0.0, 0.0)), _rail("rocker", "slider", origin=(0.0, 3.0))
    solver = group(Dyad("RPR", "slider", "rocker", *joints, _pin("B", "rocker", (0.0, 0.0), (0.0, 0.0)), sign))
    slider, rocker = solver.poses(STILL_AT)
    assert frames.point(rocker, (sign * 4.0, 3.0)) == pytest.approx((0.0, 5.0), abs=8 * EPS)
    assert slider[2:] == pytest.approx(rocker[2:], rel=4 * EPS)


def test_the_two_modes_meet_in_the_dead_position_and_the_group_knows_it():
    outstretched = {"ground": (0.0, 0.0, 1.0, 0.0), "other": (2.0 * (1.0 - 1e-16), 0.0, 1.0, 0.0)}
    joints = _two_arms(1)
    far = Revolute("B", "other", "two", (6.0, 1.0), (0.0, 0.0))
    solver = group(Dyad("RRR", "one", "two", joints.first_joint, joints.inner_joint, far, 1))
    solver.poses(outstretched)
    assert solver.meets()
    assert solver.dead()
    solver = group(_two_arms(1))
    solver.poses(STILL_AT)
    assert not solver.dead()


def test_what_is_missing_is_negative_where_the_links_do_not_meet():
    apart = np.array([0.0, 2.5, 4.0])
    joints = _two_arms(1)
    far = Revolute("B", "other", "two", (6.0, 1.0), (0.0, 0.0))
    solver = group(Dyad("RRR", "one", "two", joints.first_joint, joints.inner_joint, far, 1))
    solver.poses({"ground": (0.0, 0.0, 1.0, 0.0), "other": (apart, 0.0 * apart, 1.0, 0.0)})
    assert not solver.meets()
    assert solver.missing()[0] == pytest.approx(2.0 - apart)
