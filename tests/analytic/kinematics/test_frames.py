"""Vectors of bodies: points and their derivatives, there and back."""

import numpy as np
import pytest

from analytic.kinematics import frames
from analytic.kinematics.dyads import rrp
from tests.analytic.tolerances import FEW_ROUNDINGS

ANGLE = np.linspace(0.3, 5.0, 5)
POSE = (0.2 + 0.1 * ANGLE, -0.4 * np.ones(5), np.cos(ANGLE), np.sin(ANGLE))
RATE = (np.full(5, 0.1), np.zeros(5), np.ones(5))
BEND = (np.full(5, 0.3), np.full(5, -0.2), np.full(5, 0.7))


@pytest.mark.parametrize("local", [(0.0, 0.0), (0.3, 0.0), (0.0, -0.2), (0.3, -0.2)])
def test_a_body_is_found_again_from_any_of_its_points(local):
    place = frames.point(POSE, local)
    assert np.allclose(frames.pose_through(place, POSE[2:], local), POSE, atol=FEW_ROUNDINGS)
    velocity = frames.point_rate(POSE, RATE, local)
    assert np.allclose(frames.rate_through(POSE, velocity, RATE[2], local), RATE, atol=FEW_ROUNDINGS)
    second = frames.point_acceleration(POSE, RATE, BEND, local)
    assert np.allclose(frames.acceleration_through(POSE, second, RATE[2], BEND[2], local), BEND, atol=FEW_ROUNDINGS)


@pytest.mark.parametrize("local", [(0.3, 0.0), (0.3, -0.2)])
def test_a_point_of_a_body_and_the_point_just_there_move_alike(local):
    place = frames.point(POSE, local)
    assert np.allclose(frames.carried_rate(POSE, RATE, place), frames.point_rate(POSE, RATE, local), atol=FEW_ROUNDINGS)
    carried = frames.carried_acceleration(POSE, RATE, BEND, place)
    assert np.allclose(carried, frames.point_acceleration(POSE, RATE, BEND, local), atol=FEW_ROUNDINGS)


def test_what_the_ground_carries_stands_still():
    assert frames.carried_rate((0.0, 0.0, 1.0, 0.0), frames.STILL, (3.0, 4.0)) == (0.0, 0.0)
    assert frames.carried_acceleration((0.0, 0.0, 1.0, 0.0), frames.STILL, frames.STILL, (3.0, 4.0)) == (0.0, 0.0)


def test_products_of_vectors():
    assert frames.dot((1.0, 2.0), (3.0, 4.0)) == 11.0
    assert frames.cross((1.0, 2.0), (3.0, 4.0)) == -2.0
    assert frames.turned((0.0, 0.0, 0.0, 1.0), (0.0, 1.0)) == (-1.0, 0.0)


@pytest.mark.parametrize("zero", range(4))
def test_a_plain_zero_saves_work_but_changes_nothing(zero):
    parts = [ANGLE, ANGLE + 1.0, ANGLE - 2.0, 3.0 * ANGLE]
    plain = [0.0 if k == zero else part for k, part in enumerate(parts)]
    whole = [np.zeros(5) if k == zero else part for k, part in enumerate(parts)]
    for product in (frames.dot, frames.cross, frames.minus):
        assert np.array_equal(product(plain[:2], plain[2:]), product(whole[:2], whole[2:]))
    assert np.array_equal(frames.ahead(plain[:2], 2.0, plain[2:]), frames.ahead(whole[:2], 2.0, whole[2:]))
    if zero < 2:
        for sign in (1, -1):
            short, long = (rrp._beside(part[:2], sign * ANGLE, 0.3) for part in (plain, whole))
            assert np.array_equal(short, long)


@pytest.mark.filterwarnings("ignore:divide by zero")
def test_roots_and_reciprocals_are_defined_everywhere():
    assert frames.root(-1e-9) == 0.0
    assert frames.root(4.0) == 2.0
    assert frames.inverse(0.0) == np.inf
