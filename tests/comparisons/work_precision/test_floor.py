"""The cause of a floor, on sweeps made to have that cause and no other."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from comparisons.work_precision.floor import Cause, floor
from comparisons.work_precision.step_sweep import StepSweep

STEPS = [0.1 / 2**k for k in range(12)]


def made(size, order, *, level=0.0, growth=0.0, power=1.0, count=12, **effort):
    """Errors size·x^order + level + growth·x^-power over x = h/h₀."""
    scaled = [(step, step / STEPS[0]) for step in STEPS[:count]]
    errors = [size * x**order + level + growth * x**-power for _, x in scaled]
    return StepSweep([step for step, _ in scaled], errors, **effort)


def test_a_sweep_that_still_falls_says_so():
    found = floor(made(0.1, 2, count=6))
    assert found.cause is Cause.FALLING
    assert found.error == pytest.approx(0.1 / 4**5)
    assert found.step == STEPS[5]
    assert "reduced the error 4 ×" in found.evidence


def test_double_precision_is_no_fault_of_the_method():
    assert floor(made(0.0, 2, level=4e-16, count=3)).cause is Cause.ROUND_OFF


@given(power=st.floats(1.0, 3.0), growth=st.floats(1e-11, 1e-9))
def test_an_error_that_grows_again_is_rounding(power, growth):
    found = floor(made(0.1, 4, growth=growth, power=power))
    assert found.cause is Cause.ROUNDING
    assert "grows as h^-" in found.evidence


@given(level=st.floats(1e-9, 1e-4))
def test_a_level_that_nothing_moves_is_the_read_out_or_the_model(level):
    sweep = made(0.1, 2, level=level, effort=1e-8, effort_unit="relative tolerance")
    tighter = made(0.1, 2, level=0.9 * level, effort=1e-12, effort_unit="relative tolerance")
    looser = made(0.1, 2, level=1.1 * level, effort=1e-6, effort_unit="relative tolerance")
    if not sweep.is_falling:
        found = floor(sweep, [tighter, looser])
        assert found.cause is Cause.MODEL
        assert "at relative tolerance 1e-12 too" in found.evidence


def test_a_level_that_more_effort_lowers_is_the_solver_s():
    loose = made(0.1, 2, level=1e-5, effort=30.0, effort_unit="iterations")
    tight = made(0.1, 2, level=1e-6, effort=300.0, effort_unit="iterations")
    found = floor(loose, [tight])
    assert found.cause is Cause.EFFORT
    assert "30 iterations" in found.evidence
    assert "300 iterations" in found.evidence
    hardest = floor(tight, [loose])
    assert hardest.cause is Cause.EFFORT
    assert "more was not tried" in hardest.evidence


def test_growth_that_more_effort_removes_is_the_solver_s_too():
    loose = made(0.1, 2, growth=1e-6, power=2.0, effort=1e-6, effort_unit="relative tolerance")
    tight = made(0.1, 2, effort=1e-12, effort_unit="relative tolerance")
    assert floor(loose, [tight]).cause is Cause.EFFORT


def test_growth_that_more_effort_leaves_is_rounding():
    loose = made(0.1, 2, growth=1e-8, power=2.0, effort=1e-6, effort_unit="relative tolerance")
    tight = made(0.1, 2, growth=0.9e-8, power=2.0, effort=1e-12, effort_unit="relative tolerance")
    assert floor(loose, [tight]).cause is Cause.ROUNDING


def test_a_solver_that_holds_a_falling_error_up_is_named():
    loose = StepSweep(STEPS[:3], [1e-4, 1.5e-5, 9.5e-6], 1e-6, "relative tolerance")
    tight = StepSweep(STEPS[:3], [1e-4, 1e-6, 1e-8], 1e-12, "relative tolerance")
    assert floor(loose, [tight]).cause is Cause.EFFORT
    assert floor(loose).cause is Cause.FALLING


def test_one_point_tells_nothing():
    found = floor(StepSweep([0.1], [1e-3]))
    assert found.cause is Cause.UNSETTLED


@given(st.lists(st.floats(1e-16, 10.0), min_size=1, max_size=12))
def test_any_errors_have_a_floor_with_evidence(errors):
    found = floor(StepSweep(STEPS[: len(errors)], errors))
    assert found.error == min(errors)
    assert found.evidence
