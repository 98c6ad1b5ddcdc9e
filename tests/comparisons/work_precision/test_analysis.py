"""Choices, fronts and standings of records whose answers can be worked out by hand."""

import pytest

from comparisons.work_precision.analysis import (
    WANTED,
    apart,
    by_engine,
    choices,
    compare_settings,
    judged,
    method_sweeps,
    on_front,
)
from comparisons.work_precision.floor import Cause
from tests.comparisons.bench_rows import points, row, setting_row, sweep_rows

SECOND = sweep_rows([0.1 / 4**k for k in range(8)], setting="second")
FOURTH = sweep_rows([0.1 / 16**k for k in range(6)], setting="fourth", cost=4e-3, runs=2)


def test_order_and_floor_of_every_sweep_are_found_and_written_into_its_points():
    found = {one.first.setting: one for one in method_sweeps([*SECOND, *FOURTH])}
    assert found["second"].order == pytest.approx(2.0)
    assert found["fourth"].order == pytest.approx(4.0)
    assert found["second"].floor.cause is Cause.FALLING
    completed = judged(points([*SECOND, setting_row("tuned", 1e-4, 1e-2)]))
    orders = {(one.setting, one.orders.get("Mkr")) for one in completed}
    assert orders == {("second", found["second"].order), ("tuned", None)}


def test_efforts_of_one_method_explain_each_other_and_only_each_other():
    loose = sweep_rows([1e-2, 1e-4, 1e-4, 1e-4], effort=10.0, effort_unit="iterations", quantity="Jeq")
    tight = sweep_rows([1e-2, 1e-4, 1e-6, 1e-8], effort=300.0, effort_unit="iterations", quantity="Jeq")
    other = sweep_rows([1e-2, 1e-4, 1e-4, 1e-4], effort=10.0, effort_unit="iterations", setting="other", quantity="Jeq")
    found = {(one.first.setting, one.first.effort): one.floor.cause for one in method_sweeps([*loose, *tight, *other])}
    assert found["plain", 10.0] is Cause.EFFORT
    assert found["other", 10.0] is Cause.MODEL


def test_the_cheapest_point_that_holds_an_error_is_chosen():
    for wanted, choice in zip(WANTED, choices([*SECOND, *FOURTH]), strict=True):
        held = [one for one in (*SECOND, *FOURTH) if one.error_max <= wanted]
        expected = min(held, key=lambda one: one.total_seconds, default=None)
        assert choice.record == expected
    assert len(choices(SECOND)) == len(WANTED)


def test_what_builds_for_long_and_steps_fast_is_not_cheap():
    slow, built = (setting_row(name, 1e-4, 0.0, **spent) for name, spent in (
        ("tuned", {"seconds": 0.3, "setup_seconds": 0.1}), ("best", {"seconds": 0.04, "setup_seconds": 0.65})
    ))  # fmt: skip
    assert choices([slow, built], [1e-3])[0].record == slow
    assert on_front([slow, built]) == [slow]


def test_an_error_nobody_reaches_names_the_closest():
    last = choices(SECOND)[-1]
    assert last.record is None
    assert last.closest == SECOND[-1]
    assert choices([row(outcome="diverged", error_max=None, seconds=0.0, repeats=())]) == ()


def test_a_lucky_coarse_step_is_not_chosen():
    lucky = sweep_rows([1e-9, 1e-2, 1e-3, 1e-4, 1e-10], cost=1e-3)
    assert choices(lucky, [1e-8])[0].record == lucky[-1]


def test_a_setting_may_be_the_one_to_choose():
    tuned = setting_row("tuned", 1e-6, 2e-3)
    assert choices([*SECOND, tuned], [1e-5])[0].record == tuned


def test_the_front_leaves_nothing_better_out():
    records = [*SECOND, *FOURTH, setting_row("tuned", 1e-6, 2e-3)]
    front = on_front(records)
    assert front == sorted(front, key=lambda one: one.total_seconds)
    for one in records:
        cheaper = [other for other in records if other != one and other.total_seconds <= one.total_seconds]
        beaten = any(other.error_max <= one.error_max for other in cheaper)
        assert (one in front) is not beaten
    assert {one.fronts for one in judged(points(records)) if one.setting == "tuned"} == {("Mkr",)}


def test_single_runs_and_extrapolated_ones_have_fronts_of_their_own():
    single, several = apart([*SECOND, *FOURTH])
    assert (single, several) == (SECOND, FOURTH)
    told = judged(points([*SECOND, *FOURTH]))
    assert all(one.fronts == ("Mkr",) for one in told)
    assert len(on_front([*SECOND, *FOURTH])) < len(told)


def test_a_setting_is_held_against_the_price_of_its_own_error():
    # Both methods reach it exactly at a measured point: the second order at 64 times its first cost, the fourth at 8.
    tuned, best = (setting_row(name, 0.1 / 16**3, 0.128) for name in ("tuned", "best"))
    found, other = compare_settings([*SECOND, *FOURTH, tuned, best])
    assert found.rival_seconds == pytest.approx(64 * 1e-3)  # a single run is not held against several extrapolated
    assert found.ratio == pytest.approx(2.0)
    assert other.rival_seconds == pytest.approx(8 * 4e-3)
    assert other.rival.setting == "fourth"
    (beyond,) = compare_settings([*SECOND, setting_row("best", 1e-12, 1.0)])
    assert (beyond.ratio, beyond.rival) == (None, None)


def test_engines_quantities_and_places_are_kept_apart():
    records = [row(), row(engine="beta"), row(quantity="Jeq"), row(regime="run-up"), row()]
    assert [len(group) for group in by_engine(records).values()] == [2, 1, 1, 1]


def test_sweeps_are_methods_that_finished_coarse_to_fine():
    sweep = sweep_rows([1e-1, 1e-2, 1e-3])
    failed = row(outcome="diverged", error_max=None, seconds=0.0, repeats=(), step=1e-9)
    (found,) = method_sweeps([sweep[2], setting_row("best", 1e-9, 1.0), sweep[0], failed, sweep[1]])
    assert found.numbers.errors == (1e-1, 1e-2, 1e-3)
    assert list(found.numbers.steps) == sorted(found.numbers.steps, reverse=True)
    assert found.numbers.work == pytest.approx(3.0)
