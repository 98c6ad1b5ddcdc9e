"""Sweeps of steps: order, floor and its cause, front and price, against their definitions."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.stats import theilslopes

from comparisons.work_precision.step_sweep import (
    Cause,
    StepSweep,
    floor,
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


@settings(max_examples=30)
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


@pytest.mark.parametrize("errors", [[1e-3], [1e-3, 2.5e-4], [0.0, 0.0, 0.0], [1.0, 2.0, 4.0, 8.0]])
def test_too_few_points_or_a_rising_error_have_no_order(errors):
    assert observed_order(StepSweep(STEPS[: len(errors)], errors)) is None


def test_a_refinement_pays_until_two_in_a_row_bring_nothing():
    assert still_improves([1e-2])
    assert still_improves([1e-2, 1e-3])
    assert still_improves([1e-2, 1e-3, 2e-2])
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


@settings(max_examples=30)
@given(st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=12))
def test_the_slope_is_scipy_s(values):
    x, y = np.arange(len(values), dtype=float), np.array(values)
    assert theil_sen(x, y) == pytest.approx(theilslopes(y, x)[0])


@settings(max_examples=30)
@given(st.lists(st.tuples(POSITIVE, POSITIVE), min_size=1, max_size=25))
def test_the_front_is_what_no_other_beats(points):
    costs, errors = zip(*points, strict=True)
    beaten = [any(c <= cost and e <= error and (c < cost or e < error) for c, e in points) for cost, error in points]
    assert list(pareto(costs, errors)) == [not one for one in beaten]


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


def sweep_with_floor(size, order, *, level=0.0, growth=0.0, power=1.0, count=12, **effort):
    """Errors size·x^order + level + growth·x^-power over x = h/h₀."""
    scaled = [(step, step / STEPS[0]) for step in STEPS[:count]]
    errors = [size * x**order + level + growth * x**-power for _, x in scaled]
    return StepSweep([step for step, _ in scaled], errors, **effort)


TIGHT = {"effort": 1e-12, "effort_unit": "relative tolerance"}
GROWING = sweep_with_floor(0.1, 2, growth=1e-6, power=2.0, effort=1e-6, effort_unit="relative tolerance")


@pytest.mark.parametrize(
    ("sweep", "others", "cause"),
    [
        (sweep_with_floor(0.0, 2, level=4e-16, count=3), [], Cause.ROUND_OFF),
        (GROWING, [], Cause.ROUNDING),
        (GROWING, [sweep_with_floor(0.1, 2, growth=0.9e-6, power=2.0, **TIGHT)], Cause.ROUNDING),
        (GROWING, [sweep_with_floor(0.1, 2, **TIGHT)], Cause.EFFORT),
        (StepSweep([0.1], [1e-3]), [], Cause.UNSETTLED),
    ],
)
def test_a_floor_has_one_cause(sweep, others, cause):
    assert floor(sweep, others).cause is cause


def test_a_sweep_that_still_falls_says_so():
    found = floor(sweep_with_floor(0.1, 2, count=6))
    assert found.cause is Cause.FALLING
    assert found.error == pytest.approx(0.1 / 4**5)
    assert found.step == STEPS[5]
    assert "reduced the error 4 ×" in found.evidence


@given(power=st.floats(1.0, 3.0), growth=st.floats(1e-11, 1e-9))
def test_an_error_that_grows_again_is_rounding(power, growth):
    found = floor(sweep_with_floor(0.1, 4, growth=growth, power=power))
    assert found.cause is Cause.ROUNDING
    assert "grows as h^-" in found.evidence


@given(level=st.floats(1e-9, 1e-4))
def test_a_level_that_nothing_moves_is_the_read_out_or_the_model(level):
    sweep = sweep_with_floor(0.1, 2, level=level, effort=1e-8, effort_unit="relative tolerance")
    tighter = sweep_with_floor(0.1, 2, level=0.9 * level, effort=1e-12, effort_unit="relative tolerance")
    looser = sweep_with_floor(0.1, 2, level=1.1 * level, effort=1e-6, effort_unit="relative tolerance")
    if not sweep.is_falling:
        found = floor(sweep, [tighter, looser])
        assert found.cause is Cause.MODEL
        assert "at relative tolerance 1e-12 too" in found.evidence


def test_a_level_that_more_effort_lowers_is_the_solver_s():
    loose = sweep_with_floor(0.1, 2, level=1e-5, effort=30.0, effort_unit="iterations")
    tight = sweep_with_floor(0.1, 2, level=1e-6, effort=300.0, effort_unit="iterations")
    found = floor(loose, [tight])
    assert found.cause is Cause.EFFORT
    assert "30 iterations" in found.evidence
    assert "300 iterations" in found.evidence
    hardest = floor(tight, [loose])
    assert hardest.cause is Cause.EFFORT
    assert "more was not tried" in hardest.evidence


def test_a_solver_that_holds_a_falling_error_up_is_named():
    loose = StepSweep(STEPS[:3], [1e-4, 1.5e-5, 9.5e-6], 1e-6, "relative tolerance")
    tight = StepSweep(STEPS[:3], [1e-4, 1e-6, 1e-8], 1e-12, "relative tolerance")
    assert floor(loose, [tight]).cause is Cause.EFFORT
    assert floor(loose).cause is Cause.FALLING


def test_points_that_are_no_solution_do_not_count():
    errors = [2.0, 1.7, 0.9, *(0.1 / 4**k for k in range(6))]
    assert observed_order(StepSweep(STEPS[:9], errors)) == pytest.approx(2.0)
