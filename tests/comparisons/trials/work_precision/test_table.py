"""The order against its definition; choices, places and the saved form of records known by hand."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from analytic.errors import LinkproofError
from comparisons.trials.runs.store import save_study
from comparisons.trials.work_precision.table import (
    KIND,
    WANTED,
    Bench,
    choices,
    has_floor,
    is_falling,
    least,
    load,
    observed_order,
    save,
    still_improves,
    sustained,
    sweeps,
    theil_sen,
)
from tests.made_up import bench_of, points, row, setting_row, sweep_rows

STEPS = [0.1 / 2**k for k in range(12)]

SECOND = sweep_rows([0.1 / 4**k for k in range(8)], setting="second")
FOURTH = sweep_rows([0.1 / 16**k for k in range(6)], setting="fourth", cost=4e-3, runs=2)


def made(order, size, floor, scatter):
    """Errors size·(h/h₀)^order beside a floor, with a relative scatter of each."""
    errors = [size * (step / STEPS[0]) ** order + floor for step in STEPS]
    return [error * (1.0 + scatter[k % len(scatter)]) for k, error in enumerate(errors)]


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
    found = observed_order(STEPS, made(order, size, floor, scatter))
    assert found is not None
    assert found == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("errors", [[1e-3], [1e-3, 2.5e-4], [0.0, 0.0, 0.0], [1.0, 2.0, 4.0, 8.0]])
def test_too_few_points_or_a_rising_error_have_no_order(errors):
    assert observed_order(STEPS[: len(errors)], errors) is None


def test_a_refinement_pays_until_two_in_a_row_bring_nothing():
    assert still_improves([1e-2])
    assert still_improves([1e-2, 1e-3])
    assert still_improves([1e-2, 1e-3, 2e-2])
    assert still_improves([1e-2, 1e-3, 2e-3, 1e-5])
    assert not still_improves([1e-2, 1e-3, 2e-3, 9e-4])
    assert not still_improves([1e-16, 1e-16, 1e-16])


@settings(max_examples=30)
@given(st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=12))
def test_the_slope_is_the_median_of_those_between_all_pairs(values):
    x, y = np.arange(len(values), dtype=float), np.array(values)
    slopes = [(y[b] - y[a]) / (b - a) for a, b in combinations(range(len(y)), 2)]
    assert theil_sen(x, y) == pytest.approx(np.median(slopes))


@given(st.lists(st.floats(1e-12, 1.0), min_size=1, max_size=12), st.floats(1e-12, 1.0))
def test_from_the_place_found_every_step_to_the_smallest_error_holds(errors, wanted):
    place, best = sustained(errors, wanted), errors.index(min(errors))
    if place is None:
        assert min(errors) > wanted
    else:
        assert all(error <= wanted for error in errors[place : best + 1])
        assert place == 0 or errors[place - 1] > wanted


@pytest.mark.parametrize(
    ("errors", "falls"), [([1e-2, 1e-3], True), ([1e-2, 9e-3], False), ([1e-3, 1e-4, 2e-4], False), ([1e-3], False),
                          ([1e-3, 0.0], False)],
)  # fmt: skip
def test_an_error_falls_where_the_finest_step_is_the_best_beyond_scatter(errors, falls):
    assert is_falling(errors) is falls


def test_order_and_least_error_of_every_sweep_are_found():
    completed = bench_of(*SECOND, *FOURTH, setting_row("tuned", 1e-4, 1e-2))
    orders = {record["setting"]: record["orders"].get("Mkr") for record in completed.as_dict["records"]}
    assert orders == {"second": pytest.approx(2.0), "fourth": pytest.approx(4.0), "tuned": None}
    (second, _) = sweeps(completed.table)
    assert (least(second).step, has_floor(second)) == (SECOND[-1].step, False)
    assert second.order.tolist() == [pytest.approx(2.0)] * len(SECOND)


def test_the_cheapest_point_that_holds_an_error_is_chosen():
    for wanted, choice in zip(WANTED, choices(bench_of(*SECOND, *FOURTH).table), strict=True):
        held = [one for one in (*SECOND, *FOURTH) if one.errors[0].error_max <= wanted]
        expected = min(held, key=lambda one: one.total_seconds, default=None)
        assert (choice and choice.key) == (expected and expected.key)


def _document():
    extent = {"budget": 1.0, "repeats": 5, "patience": 0.6}
    told = {"command": "bench", "conditions": "", "environment": {}, "mechanisms": [], "methods": []}
    return {**told, "extent": extent, "quantities": ["Mkr"]}


def test_what_is_saved_is_what_is_loaded(tmp_path):
    records = [row(), setting_row("best", None, None, outcome="crashed", repeats=(), detail="died by signal 6")]
    save(tmp_path, Bench(_document(), points(records)))
    found = load(tmp_path)
    assert found.points == tuple(records)


def test_a_document_of_another_form_is_refused_with_the_place(tmp_path):
    told = {**_document(), "quantities": [{"x": 1}]}
    save_study(tmp_path, KIND, told, (("0", one.data, {}) for one in points([row()])))
    with pytest.raises(LinkproofError, match=r"quantities\.0.*run bench with --out again"):
        load(tmp_path)
