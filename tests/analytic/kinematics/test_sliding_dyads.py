"""RPP and PRP by themselves, on guides whose crossing is known."""

import numpy as np
import pytest

from analytic.kinematics import frames
from analytic.kinematics.dyad_solvers import group
from analytic.kinematics.structure import Dyad, Prismatic, Revolute
from tests.analytic.tolerances import EPS

HALF = np.sqrt(0.5)


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
    solver = group(Dyad("PRP", "one", "two", up, pin, rising))
    one, two = solver.poses(_hosts(x))
    assert np.allclose(one[:2], [x, x + 1.0], atol=8 * EPS)
    assert np.allclose(two[:2], one[:2], atol=8 * EPS)
    first, _ = solver.rates(_hosts(x), RATES)
    assert np.allclose(np.broadcast_arrays(*first[:2]), 1.0, rtol=8 * EPS)


def test_rpp_keeps_its_pin_and_turns_with_its_host():
    # A block pinned to the cart slides up and down in a yoke that slides along the ground: the yoke follows x.
    x = np.linspace(-2.0, 3.0, 7)
    pinned = Revolute("A", "cart", "block", (0.5, 2.0), (0.0, 0.0))
    in_yoke = Prismatic("block", "yoke", "block", (0.0, 1.0), (0.0, 0.0), (0.0, 1.0))
    on_ground = Prismatic("yoke", "ground", "yoke", (1.0, 0.0), (0.0, 0.0), (1.0, 0.0))
    solver = group(Dyad("RPP", "block", "yoke", pinned, in_yoke, on_ground))
    block, yoke = solver.poses(_hosts(x))
    assert np.allclose(yoke[0], x + 0.5, atol=8 * EPS)
    assert np.allclose(np.broadcast_arrays(*block[:2]), np.broadcast_arrays(x + 0.5, 2.0), atol=8 * EPS)
    _, rate = solver.rates(_hosts(x), RATES)
    assert np.allclose(rate[0], 1.0, rtol=8 * EPS)


@pytest.mark.parametrize("tilt", [0.0, 1e-12])
def test_parallel_guides_are_told_apart_from_crossing_ones(tilt):
    along = Prismatic("one", "cart", "one", (1.0, 0.0), (0.0, 1.0), (1.0, 0.0))
    almost = Prismatic("two", "ground", "two", (1.0, tilt), (0.0, 0.0), (1.0, tilt))
    solver = group(Dyad("PRP", "one", "two", along, Revolute("C", "two", "one", (0.0, 0.0), (0.0, 0.0)), almost))
    solver.poses(_hosts(np.zeros(1)))
    assert not solver.meets()
    assert np.all(solver.missing()[0] < 0.0)
