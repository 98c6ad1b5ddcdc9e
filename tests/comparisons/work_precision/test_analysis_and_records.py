"""Choices, fronts, places and the saved form of records whose answers follow by hand."""

import re

import pytest

from analytic.errors import LinkproofError
from comparisons.runs.study import save_study
from comparisons.work_precision.analysis import (
    WANTED,
    choices,
    compare_settings,
    judged,
    method_sweeps,
    on_front,
    places,
    split_by_runs,
)
from comparisons.work_precision.records import KIND, Bench, load, save, split_by_quantity
from tests.comparisons.bench_rows import points, row, setting_row, sweep_rows
from tests.reports.made_up_bench import document, made_up_bench

SECOND = sweep_rows([0.1 / 4**k for k in range(8)], setting="second")
FOURTH = sweep_rows([0.1 / 16**k for k in range(6)], setting="fourth", cost=4e-3, runs=2)


def test_order_and_least_error_of_every_sweep_are_found_and_written_into_its_points():
    found = {one.first.setting: one for one in method_sweeps([*SECOND, *FOURTH])}
    assert found["second"].order == pytest.approx(2.0)
    assert found["fourth"].order == pytest.approx(4.0)
    assert (found["second"].least, found["second"].has_floor) == (SECOND[-1], False)
    completed = judged(points([*SECOND, setting_row("tuned", 1e-4, 1e-2)]))
    orders = {(one.setting, one.orders.get("Mkr")) for one in completed}
    assert orders == {("second", found["second"].order), ("tuned", None)}


def test_the_cheapest_point_that_holds_an_error_is_chosen():
    for wanted, choice in zip(WANTED, choices([*SECOND, *FOURTH]), strict=True):
        held = [one for one in (*SECOND, *FOURTH) if one.error_max <= wanted]
        expected = min(held, key=lambda one: one.total_seconds, default=None)
        assert choice.record == expected
    assert choice.closest == FOURTH[-1]
    assert len(choices(SECOND)) == len(WANTED)


def test_what_builds_for_long_and_steps_fast_is_not_cheap():
    slow, built = (setting_row(name, 1e-4, 0.0, **spent) for name, spent in (
        ("tuned", {"seconds": 0.3, "setup_seconds": 0.1}), ("best", {"seconds": 0.04, "setup_seconds": 0.65})
    ))  # fmt: skip
    assert choices([slow, built], [1e-3])[0].record == slow
    assert on_front([slow, built]) == [slow]


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
    single, several = split_by_runs([*SECOND, *FOURTH])
    assert (single, several) == (SECOND, FOURTH)
    told = judged(points([*SECOND, *FOURTH]))
    assert all(one.fronts == ("Mkr",) for one in told)
    assert len(on_front([*SECOND, *FOURTH])) < len(told)


def test_a_setting_is_compared_with_the_price_of_its_error():
    # Both methods reach it exactly at a measured point: the second order at 64 times its first cost, the fourth at 8.
    tuned, best = (setting_row(name, 0.1 / 16**3, 0.128) for name in ("tuned", "best"))
    found, other = compare_settings([*SECOND, *FOURTH, tuned, best])
    assert found.rival_seconds == pytest.approx(64 * 1e-3)  # a single run is not held against several extrapolated
    assert found.ratio == pytest.approx(2.0)
    assert other.rival_seconds == pytest.approx(8 * 4e-3)
    assert other.rival.setting == "fourth"
    (beyond,) = compare_settings([*SECOND, setting_row("best", 1e-12, 1.0)])
    assert (beyond.ratio, beyond.rival) == (None, None)


def test_a_place_is_judged_by_the_torque_where_it_has_one():
    def foremost(*quantities):
        rows = [row(quantity=name) for name in quantities]
        return places(Bench(document(("m",), ("alpha",)), points(rows)))[0].foremost

    assert foremost("Jeq", "phi", "Mkr") == "Mkr"
    assert foremost("Jeq", "phi") == "phi"
    assert foremost("Jeq", "S") == "Jeq"


def test_the_control_is_last_and_no_part_of_the_front_over_all_engines():
    (place, *_) = places(made_up_bench(control="alpha"))
    assert [facts.engine for facts in place.engines("Mkr")] == ["beta", "alpha"]
    assert {record.engine for record in place.rankable_records("Mkr")} == {"beta"}


def _document():
    noise = {"work": "w", "samples": [1e-3, 1.2e-3]}
    extent = {"budget": 1.0, "repeats": 5, "patience": 0.6}
    told = {"command": "bench", "conditions": "", "environment": {}, "first_use": [], "mechanisms": [], "methods": []}
    own = {
        "noise": noise,
        "extent": extent,
        "quantities": ["Mkr"],
    }
    return {**told, **own}


def test_what_is_saved_is_what_is_loaded(tmp_path):
    records = [row(), setting_row("best", None, None, outcome="crashed", repeats=(), detail="died by signal 6")]
    save(tmp_path, Bench(_document(), points(records)))
    found = load(tmp_path)
    assert found.records == tuple(records)
    assert found.noise.samples == (1e-3, 1.2e-3)


@pytest.mark.parametrize(
    ("place", "words"),
    [
        (("records", 0, "errors", 0, "error_max"), "0.error_max"),
        (("noise", "samples", 0), "noise.samples.0"),
    ],
)
def test_a_document_of_another_form_is_refused_with_the_place(tmp_path, place, words):
    told = {**_document(), "records": [point.data for point in points([row()])]}
    part = told
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = {"x": 1}
    save_study(tmp_path, KIND, told, (("0", one, {}) for one in told.pop("records")))
    with pytest.raises(LinkproofError, match=rf"{re.escape(words)}.*run bench with --out again"):
        load(tmp_path)


def test_an_unfinished_point_stands_in_every_requested_quantity():
    failed, finished = points([row(error_max=None, outcome="diverged")]), points([row()])
    assert [(one.quantity, one.finished) for one in split_by_quantity(failed, ("Jeq", "phi"))] == [
        ("Jeq", False),
        ("phi", False),
    ]
    assert [one.quantity for one in split_by_quantity(finished, ("Jeq", "phi"))] == ["Mkr"]


def test_a_lucky_coarse_step_is_not_chosen():
    lucky = sweep_rows([1e-9, 1e-2, 1e-3, 1e-4, 1e-10], cost=1e-3)
    assert choices(lucky, [1e-8])[0].record == lucky[-1]
