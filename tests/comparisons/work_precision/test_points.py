"""A sweep goes on while it pays, and says why it stops."""

import dataclasses
import math

import pytest

from comparisons.judging.records import QuantityRecord
from comparisons.work_precision.measure import FEWEST, FULL, QUICK, Point, PointSweep, planned_sweeps
from engines.contract import Method, Setting
from tests.comparisons.bench_rows import row

METHOD = Method("plain", "as it comes")
STEPS = tuple(12.0 * 2.0**k for k in range(9))


def _sweep(budget=math.inf):
    return PointSweep([Point(0, "alpha", method=METHOD, steps_per_turn=n) for n in STEPS], budget)


def _made(error, seconds=1e-3, also=None, setup=0.0):
    found = {"Mkr": error} | ({"Jeq": also} if also else {})
    errors = tuple(QuantityRecord(name, error_max=one) for name, one in found.items())
    return dataclasses.replace(row(seconds=seconds, setup_seconds=setup), errors=errors)


def _failed(outcome="diverged"):
    return row(outcome=outcome, detail="why", error_max=None)


def _run(sweep, results):
    """Feed results to a sweep until it wants no more; how many it took."""
    for number, measurement in enumerate(results):
        if sweep.next() is None:
            return number
        sweep.add(measurement)
    return len(results) if sweep.next() is None else None


@pytest.mark.parametrize(
    ("budget", "results", "count", "ended"),
    [
        (math.inf, [_made(10.0**-k) for k in range(9)], 9, "the sweep ends here"),
        (math.inf, [_made(10.0 ** -min(k, 5)) for k in range(9)], 8, "two refinements in a row"),
        (math.inf, [_made(1e-3, also=10.0**-k) for k in range(9)], 9, "the sweep ends here"),
        (
            0.1,
            [_made(10.0**-k, seconds=1e-3 * 2**k) for k in range(9)],
            7,
            "would take about 0.13 s, over 0.1 s",
        ),
        (0.1, [_made(10.0**-k, setup=0.2) for k in range(9)], FEWEST, "over 0.1 s"),
        (0.3, [_made(10.0**-k, 0.2 if k == 2 else 1e-3 * 2**k) for k in range(9)], 9, "the sweep ends here"),
    ],
    ids=[
        "last-step",
        "no-gain",
        "other-gains",
        "dear",
        "set-up",
        "one-slow",
    ],
)
def test_a_sweep_takes_six_steps_and_goes_on_while_it_pays(budget, results, count, ended):
    sweep = _sweep(budget)
    assert _run(sweep, results) == count
    assert ended in sweep.ended


@pytest.mark.parametrize(
    ("results", "count"),
    [
        ([_failed()] * 5, 3),
        ([_failed(), _failed(), *[_made(10.0**-k) for k in range(7)]], 9),
        ([_made(1e-1), _failed()], 2),
        ([_failed("timed-out")], 1),
    ],
)
def test_failures_end_a_sweep_unless_a_shorter_step_may_cure_them(results, count):
    sweep = _sweep()
    assert _run(sweep, results) == count
    if count < len(STEPS):
        assert sweep.ended.endswith("why")


def test_settings_and_methods_are_swept():
    found = planned_sweeps(0, "alpha", [METHOD], tuple(Setting), FULL)
    assert [sweep.points[0].setting for sweep in found[:3]] == list(Setting)
    assert [[point.steps_per_turn for point in sweep.points] for sweep in found[3:]] == [list(FULL.steps_per_turn)]


def test_a_quick_benchmark_has_the_most_advanced_methods_and_not_the_best_setting():
    names = {"simple": 1, "advanced": 1, "simple x2": 2, "advanced x2": 2}
    methods = [dataclasses.replace(METHOD, name=name, runs=runs) for name, runs in names.items()]
    found = planned_sweeps(0, "alpha", methods, tuple(Setting), QUICK)
    measured = [sweep.points[0].setting or sweep.points[0].method.name for sweep in found]
    assert measured == ["naive", "tuned", "advanced", "advanced x2"]
    assert all(len(sweep.points) > FEWEST for sweep in found[2:])
