"""Fronts and prices against their definitions, by brute force."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from comparisons.work_precision.front import pareto, price, sustained

POSITIVE = st.sampled_from([1e-6, 1e-3, 0.01, 0.1, 0.5, 1.0, 2.0])


@given(st.lists(st.tuples(POSITIVE, POSITIVE), min_size=1, max_size=25))
def test_the_front_is_what_no_other_beats(points):
    costs, errors = zip(*points, strict=True)
    beaten = [any(c <= cost and e <= error and (c < cost or e < error) for c, e in points) for cost, error in points]
    assert list(pareto(costs, errors)) == [not one for one in beaten]


def test_a_lucky_coarse_step_is_not_relied_on():
    errors = [1e-4, 3e-2, 1e-2, 1e-3, 1e-5, 4e-5]
    assert sustained(errors, 1e-3) == 3
    assert sustained(errors, 5e-2) == 0
    assert sustained(errors, 1e-6) is None


@given(st.lists(st.floats(1e-12, 1.0), min_size=1, max_size=12), st.floats(1e-12, 1.0))
def test_from_the_place_found_every_step_to_the_smallest_error_holds(errors, wanted):
    place, best = sustained(errors, wanted), errors.index(min(errors))
    if place is None:
        assert min(errors) > wanted
    else:
        assert all(error <= wanted for error in errors[place : best + 1])
        assert place == 0 or errors[place - 1] > wanted


@given(st.floats(1.0, 6.0), st.floats(1e-6, 0.05))
def test_a_price_on_a_straight_line_is_exact(order, wanted):
    costs = [2.0**k for k in range(24)]
    errors = [0.1 * cost**-order for cost in costs]
    expected = (0.1 / wanted) ** (1.0 / order)
    assert price(costs, errors, wanted) == pytest.approx(expected)


def test_a_price_beyond_the_sweep_is_none_and_before_it_the_first():
    assert price([1.0, 2.0], [1e-2, 1e-3], 1e-4) is None
    assert price([1.0, 2.0], [1e-2, 1e-3], 0.5) == 1.0
    assert price([1.0, 2.0], [1e-2, 0.0], 1e-4) == 2.0
