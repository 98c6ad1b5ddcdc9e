"""A sweep goes on while it pays, and says why it stops; one point measured in a real engine."""

import dataclasses
import math
import pickle
import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.runs.run_engine import AdapterError
from comparisons.trials.work_precision import measure as point
from comparisons.trials.work_precision.measure import chosen_families, measure
from comparisons.trials.work_precision.study import (
    FEWEST,
    QUICK,
    BenchRequest,
    Point,
    PointSweep,
    blank_run,
    planned_sweeps,
)
from engines.contract import Method, Origin, Setting
from engines.registry import engine
from tests.comparisons.bench_rows import row

METHOD = Method("plain", "as it comes")
STEPS = tuple(12.0 * 2.0**k for k in range(9))

CASE = Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up-quintic", hold_time=0.0, ramp_time=0.2))
PICKLED = pickle.dumps(CASE)
EXACT, NONE = Method("exact", ""), Method("no such", "")
FOUR = ("Mkr", "Jeq", "phi", "joint_force")


def _sweep(budget=math.inf):
    return PointSweep([Point(0, METHOD, row(steps_per_turn=n)) for n in STEPS], budget)


def _made(error, seconds=1e-3, also=None, setup=0.0):
    found = {"Mkr": error} | ({"Jeq": also} if also else {})
    errors = tuple(row().blank._replace(quantity=name, error_max=one) for name, one in found.items())
    return row(seconds=seconds, setup_seconds=setup), errors


def _failed(outcome="diverged"):
    return row(outcome=outcome, detail="why", error_max=None), ()


def _run(sweep, results):
    """Feed results to a sweep until it wants no more; how many it took."""
    for number, (measurement, errors) in enumerate(results):
        point = sweep.next()
        if point is None:
            return number
        steps = point.run.steps_per_turn
        sweep.add(dataclasses.replace(measurement, steps_per_turn=steps, errors=errors))
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


def test_a_quick_benchmark_has_the_most_advanced_methods_and_not_the_best_setting():
    names = {"simple": 1, "advanced": 1, "simple x2": 2, "advanced x2": 2}
    methods = [dataclasses.replace(METHOD, name=name, runs=runs) for name, runs in names.items()]
    found = list(planned_sweeps(0, CASE, "direct", methods, BenchRequest((CASE,), ("direct",), extent=QUICK)))
    assert [sweep.points[0].run.setting for sweep in found] == ["naive", "tuned", "advanced", "advanced x2"]
    assert all(len(sweep.points) > FEWEST for sweep in found[2:])


def test_the_overhead_is_the_time_outside_the_engines_calls_and_in_what_they_call_back(monkeypatch):
    now, called_back = [0.0], []

    def spend(seconds):
        now[0] += seconds

    def step():
        spend(5.0)
        called_back[-1]()

    made_up = SimpleNamespace(step=step, set_callback=called_back.append)
    adapter = SimpleNamespace(engine_calls=("made_up.step",), callback_calls=("made_up.set_callback",))
    monkeypatch.setitem(sys.modules, "made_up", made_up)
    monkeypatch.setattr(point.time, "perf_counter", lambda: now[0])

    def run():
        made_up.set_callback(lambda: spend(1.0))
        for _ in range(4):
            spend(2.0)
            made_up.step()

    assert point.engine_seconds(adapter, run) == pytest.approx(20.0)
    assert made_up.step is step
    assert point.engine_seconds(SimpleNamespace(), run) is None
    assert row(engine_seconds=20.0, seconds=32.0).overhead == pytest.approx(3.0 / 8.0)


def by_name(measurement):
    return {one.quantity: one for one in measurement.errors}


def test_an_exact_method_has_errors_of_round_off_in_every_quantity():
    measurement = measure(PICKLED, EXACT, blank_run(CASE, "direct", EXACT, 24.0), FOUR, with_errors=True)
    assert measurement.outcome == "finished"
    errors = by_name(measurement)
    assert set(errors) == set(FOUR)
    assert all(error.error_rms <= error.error_max < 1e-12 and error.peak > 0.0 for error in errors.values())
    assert errors["Mkr"].unit == "N m"
    assert min(measurement.seconds, measurement.steps) > 0
    assert min(measurement.setup_seconds, measurement.readout_seconds) >= 0.0


class Altered:
    """The control with another history."""

    name, is_control = "altered", True

    def __init__(self, change):
        self.change = change

    def version(self):
        return "1.0"

    def run(self, scene, setting):
        run = engine("direct").run(scene, setting)
        return replace(run, history=self.change(run.history), passes=(3e-3, 1e-3))


def _measured(monkeypatch, change, names):
    monkeypatch.setattr(point, "engine", lambda name: Altered(change))
    return measure(PICKLED, Setting.TUNED, blank_run(CASE, "direct", Setting.TUNED), names, with_errors=True)


def test_the_worst_joint_stands_for_all(monkeypatch):
    def enlarged(history):
        forces = history.joint_force.items()
        grown = {name: replace(one, values=one.values * (1.02 if name == "A" else 1.01)) for name, one in forces}
        return replace(history, joint_force=grown)

    measurement = _measured(monkeypatch, enlarged, FOUR)
    assert by_name(measurement)["joint_force"].error_max == pytest.approx(0.02, rel=1e-9)
    assert [one.name for one in chosen_families(CASE, ("joint_force:A",))["joint_force:A"]] == ["joint_force:A"]


def test_a_missing_signal_costs_its_quantity_alone(monkeypatch):
    def partial(history):
        torque = replace(history.torque, origin=Origin.COMPUTED)
        return replace(history, torque=torque, joint_force={"A": history.joint_force["A"]})

    measurement = _measured(monkeypatch, partial, FOUR)
    assert (measurement.outcome, measurement.runs) == ("finished", 2)
    errors = by_name(measurement)
    assert {name for name, one in errors.items() if one.error_max is not None} == {"Jeq", "phi", "joint_force"}
    assert (errors["Mkr"].outcome, errors["Mkr"].detail) == ("not-provided", "Mkr computed by the adapter")
    assert "joint_force:A" not in errors["joint_force"].detail
    assert errors["joint_force"].detail.endswith("not offered")


def test_an_exception_of_an_engine_is_its_adapters_error():
    with pytest.raises(AdapterError, match="direct raised UnknownNameError"):
        measure(PICKLED, NONE, blank_run(CASE, "direct", NONE, 24.0), ("Mkr",), with_errors=True)
