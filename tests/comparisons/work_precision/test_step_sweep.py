"""The order of a sweep whose order is known, whatever surrounds it; fronts and prices against their definitions."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.stats import theilslopes

from comparisons.work_precision.step_sweep import (
    StepSweep,
    observed_order,
    pareto,
    price,
    still_improves,
    sustained,
    theil_sen,
)

STEPS = [0.1 / 2**k for k in range(12)]
POSITIVE = st.sampled_from([1e-6, 1e-3, 0.01, 0.1, 0.5, 1.0, 2.0])


def made(order, size, floor, steps=STEPS, scatter=(0.0,)):
    """Errors size·(h/h₀)^order beside a floor, with a relative scatter of each."""
    errors = [size * (step / steps[0]) ** order + floor for step in steps]
    return StepSweep(steps, [error * (1.0 + scatter[k % len(scatter)]) for k, error in enumerate(errors)])


@given(
    order=st.sampled_from([1, 2, 3, 4, 6]),
    size=st.floats(0.01, 0.25),
    floor=st.floats(1e-14, 1e-4),
    scatter=st.lists(st.floats(-0.08, 0.08), min_size=12, max_size=12),
)
def test_the_order_is_found_above_a_floor_and_through_scatter(order, size, floor, scatter):
    clear = sum(size * (step / STEPS[0]) ** order > 10.0 * floor for step in STEPS)
    assume(clear >= 4)
    found = observed_order(made(order, size, floor, scatter=scatter))
    assert found is not None
    assert found == pytest.approx(order, abs=0.3)


def test_points_that_are_no_solution_do_not_count():
    errors = [2.0, 1.7, 0.9, *(0.1 / 4**k for k in range(6))]
    assert observed_order(StepSweep(STEPS[:9], errors)) == pytest.approx(2.0)


def test_an_outlier_does_not_move_the_slope():
    errors = [0.1 / 4**k for k in range(10)]
    errors[2] *= 8.0
    assert observed_order(StepSweep(STEPS[:10], errors)) == pytest.approx(2.0)


@given(st.lists(st.floats(0.7, 1.4), min_size=4, max_size=10))
def test_a_level_sweep_has_no_order(factors):
    assert observed_order(StepSweep(STEPS[: len(factors)], [1e-6 * factor for factor in factors])) is None


@pytest.mark.parametrize("errors", [[1e-3], [1e-3, 2.5e-4], [0.0, 0.0, 0.0], [1.0, 2.0, 4.0, 8.0]])
def test_too_few_points_or_a_rising_error_have_no_order(errors):
    assert observed_order(StepSweep(STEPS[: len(errors)], errors)) is None


@given(st.lists(st.floats(1e-16, 10.0), min_size=1, max_size=12))
def test_any_errors_give_an_order_above_nought_or_none(errors):
    found = observed_order(StepSweep(STEPS[: len(errors)], errors))
    assert found is None or (math.isfinite(found) and found > 0.0)


def test_a_refinement_pays_until_two_in_a_row_bring_nothing():
    assert still_improves([1e-2])
    assert still_improves([1e-2, 1e-3])
    assert still_improves([1e-2, 1e-3, 2e-3])
    assert still_improves([1e-2, 1e-3, 2e-3, 1e-5])
    assert not still_improves([1e-2, 1e-3, 2e-3, 9e-4])
    assert not still_improves([1e-16, 1e-16, 1e-16])


def test_effort_is_named_and_ranked():
    tight, loose = (StepSweep([1.0], [1.0], effort, "relative tolerance") for effort in (1e-10, 1e-6))
    assert tight.works_harder_than(loose)
    assert not loose.works_harder_than(tight)
    assert tight.effort_words == "relative tolerance 1e-10"
    many, few = (StepSweep([1.0], [1.0], effort, "iterations") for effort in (300.0, 30.0))
    assert many.works_harder_than(few)
    assert many.effort_words == "300 iterations"
    own = StepSweep([1.0], [1.0], None, "iterations", work=50.0)
    assert own.works_harder_than(StepSweep([1.0], [1.0], 30.0, "iterations", work=30.0))
    assert not own.works_harder_than(StepSweep([1.0], [1.0], 30.0, "iterations"))


@given(st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=12))
def test_the_slope_is_scipy_s(values):
    x, y = np.arange(len(values), dtype=float), np.array(values)
    assert theil_sen(x, y) == pytest.approx(theilslopes(y, x)[0])


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
