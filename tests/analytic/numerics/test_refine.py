"""Refined peaks of many curves against brute force, a formula, and curves that jump or end on their peak."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from analytic.numerics.refine import highest

GRID = np.linspace(0.0, 2.0 * np.pi, 721)
PLACE = 1e-6  # rad: of a smooth top the value is known to rounding, its place to the root of it


def _found(*curves, grid=GRID):
    def every(places):
        return np.stack([np.broadcast_to(curve(places), places.shape) for curve in curves])

    return highest(every, grid, every(grid))


def test_peaks_of_sines_between_the_samples_and_at_the_ends_are_exact():
    values, places = _found(
        lambda x: np.sin(x - 0.1234567),
        lambda x: -np.abs(np.sin(0.5 * x - 1.0)),
        np.square,
        lambda x: -x,
        np.zeros_like,
    )
    assert values == pytest.approx([1.0, 0.0, 4.0 * math.pi**2, 0.0, 0.0], abs=2e-7)
    assert values[0] == pytest.approx(1.0, abs=1e-14)
    assert places[:4] == pytest.approx([math.pi / 2 + 0.1234567, 2.0, 2.0 * math.pi, 0.0], abs=PLACE)


@settings(max_examples=30)
@given(st.lists(st.floats(-1.0, 1.0), min_size=12, max_size=12))
@example([0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, -0.265625, -0.453125, 0.0, 0.4375])  # a top just behind the start
def test_of_a_sum_of_harmonics_nothing_is_higher(coefficients):
    """Brute force with twenty thousand places finds no higher value, and one as high within its own step."""

    def curve(x):
        orders = np.arange(1, 7)[:, None]
        a, b = np.array(coefficients[:6])[:, None], np.array(coefficients[6:])[:, None]
        return np.sum(a * np.cos(orders * x) + b * np.sin(orders * x), axis=0)

    (value,), (place,) = _found(curve)
    dense = curve(np.linspace(0.0, 2.0 * np.pi, 20_001))
    assert value >= np.max(dense) - 1e-12
    assert value <= np.max(dense) + 36 * (math.pi / 20_000) ** 2 * 12
    assert curve(np.array([place]))[0] == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize("side", [0, 1])
def test_of_a_jump_the_higher_side_is_taken_and_nothing_across_it(side):
    jump = 1.0
    grid = np.unique(np.append(GRID, [np.nextafter(jump, 0.0), jump]))

    def curve(x):
        return np.where((x >= jump) == bool(side), 2.0 + 0.1 * (x - jump) * (1 - 2 * side), 0.0)

    (value,), (place,) = _found(curve, grid=grid)
    assert value == pytest.approx(2.0, abs=1e-15)
    assert place == (jump if side else np.nextafter(jump, 0.0))


def test_of_equal_tops_the_first_is_taken_whatever_their_rounding():
    ripple = 1e-15 * np.random.default_rng(3).standard_normal(len(GRID))
    _, places = _found(lambda x: np.abs(np.cos(x)), lambda x: np.cos(4 * x - 1.0) + 0.0 * x)
    assert places == pytest.approx([0.0, 0.25], abs=PLACE)
    _, (place,) = highest(lambda x: np.ones((1, len(x))), GRID, 1.0 + ripple[None])
    assert place < GRID[2]


def test_of_many_tops_one_that_the_samples_show_as_the_lowest_is_found_if_it_is_the_highest():
    """Five broad tops on samples, and a sharp one between two samples that is a little higher."""
    sharp = GRID[300] + 0.3 * (GRID[1] - GRID[0])
    tops = [(GRID[place], 1.0) for place in (50, 120, 190, 420, 600)]
    (value,), (place,) = _found(
        lambda x: np.maximum(1.001 - 200.0 * np.abs(x - sharp), np.max([h - (x - c) ** 2 for c, h in tops], axis=0))
    )
    assert (value, place) == (pytest.approx(1.001, rel=1e-6), pytest.approx(sharp, abs=PLACE))
