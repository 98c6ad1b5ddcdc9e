"""A sweep goes on while it pays, and says why it stops; one point measured in a real engine."""

import dataclasses
import math
import pickle
import sys
from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.dynamics.reduced import drive_torque
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.runs.run_engine import AdapterError
from comparisons.trials.runs.store import begin
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.work_precision import study as benchmark
from comparisons.trials.work_precision.study import (
    FEWEST,
    OUT_OF_TIME,
    QUICK,
    BenchRequest,
    Extent,
    PointSweep,
    bench,
    blank_run,
    chosen_families,
    measure,
    planned_sweeps,
)
from comparisons.trials.work_precision.table import has_floor, sweeps
from engines.contract import History, Method, Origin, Outcome, Run, Setting, Signal
from engines.registry import engine
from engines.scene import Channel
from tests.comparisons.faults import PATIENCE
from tests.comparisons.scripted import Scripted
from tests.made_up import row

METHOD = Method("plain", "as it comes")
STEPS = tuple(12.0 * 2.0**k for k in range(9))

CASE = Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up-quintic", hold_time=0.0, ramp_time=0.2))
PICKLED = pickle.dumps(CASE)
EXACT, NONE = Method("exact", ""), Method("no such", "")
FOUR = ("Mkr", "Jeq", "phi", "joint_force")


def _sweep(budget=math.inf):
    return PointSweep(0, METHOD, [row(steps_per_turn=n) for n in STEPS], budget)


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
        steps = point.steps_per_turn
        sweep.add(dataclasses.replace(measurement, steps_per_turn=steps, errors=errors))
    return len(results) if sweep.next() is None else None


@pytest.mark.parametrize(
    ("budget", "results", "count", "ended"),
    [
        (math.inf, [_made(10.0**-k) for k in range(9)], 9, "the sweep ends here"),
        (math.inf, [_made(10.0 ** -min(k, 5)) for k in range(9)], 8, "two refinements in a row"),
        (math.inf, [_made(1e-3, also=10.0**-k) for k in range(9)], 9, "the sweep ends here"),
        (0.1, [_made(10.0**-k, seconds=1e-3 * 2**k) for k in range(9)], 7, "would take about 0.13 s, over 0.1 s"),
        (0.1, [_made(10.0**-k, setup=0.2) for k in range(9)], FEWEST, "over 0.1 s"),
        (0.3, [_made(10.0**-k, 0.2 if k == 2 else 1e-3 * 2**k) for k in range(9)], 9, "the sweep ends here"),
        # Failures end it unless a shorter step may cure them.
        (math.inf, [_failed()] * 5, 3, "why"),
        (math.inf, [_failed(), _failed(), *[_made(10.0**-k) for k in range(7)]], 9, "the sweep ends here"),
        (math.inf, [_made(1e-1), _failed()], 2, "why"),
        (math.inf, [_failed("timed-out")], 1, "why"),
    ],
)
def test_a_sweep_takes_six_steps_and_goes_on_while_it_pays(budget, results, count, ended):
    sweep = _sweep(budget)
    assert _run(sweep, results) == count
    assert ended in sweep.ended


def test_a_quick_benchmark_has_the_most_advanced_methods_and_not_the_best_setting():
    names = {"simple": 1, "advanced": 1, "simple x2": 2, "advanced x2": 2}
    methods = [dataclasses.replace(METHOD, name=name, runs=runs) for name, runs in names.items()]
    found = list(planned_sweeps(0, CASE, "direct", methods, BenchRequest((CASE,), ("direct",), extent=QUICK)))
    assert [sweep.points[0].setting for sweep in found] == ["naive", "tuned", "advanced", "advanced x2"]
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
    monkeypatch.setattr(benchmark.time, "perf_counter", lambda: now[0])

    def run():
        made_up.set_callback(lambda: spend(1.0))
        for _ in range(4):
            spend(2.0)
            made_up.step()

    assert benchmark.engine_seconds(adapter, run) == pytest.approx(20.0)
    assert made_up.step is step
    assert benchmark.engine_seconds(SimpleNamespace(), run) is None
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
    assert measurement.setup_seconds >= 0.0


def _measured(monkeypatch, change, names):
    def act(scene, setting):
        run = engine("direct").run(scene, setting)
        return replace(run, history=change(run.history), passes=(3e-3, 1e-3))

    altered = Scripted(act, is_control=True)
    monkeypatch.setattr(benchmark, "engine", lambda name: altered)
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


# A benchmark of an engine whose orders and floors are known finds them, round after round, interrupted or not.


FIRST = Method("first", "first order")
SECOND = Method("second", "second order down to a floor")
FOURTH = Method("fourth", "fourth order until rounding grows", runs=2)
WRONG = Method("wrong", "a read-out that no step mends")
BROKEN = Method("broken", "raises")
METHODS = (FIRST, SECOND, FOURTH, WRONG, BROKEN)
SIZE = 0.2

EXTENT = Extent(tuple(12.0 * 2.0**k for k in range(9)), budget=PATIENCE, repeats=3, patience=PATIENCE)
REQUEST = BenchRequest((CASE,), ("known",), ("Mkr",), extent=EXTENT, pool=LocalPool(0))


def known_run(_, how, step=1e-3):
    """A run with a known error over the peak.

    By method c h, c h² + a floor, c h⁴ + r/h or a constant, h over the step at 12 a turn; by setting a constant.
    """
    if how is BROKEN:
        raise RuntimeError("matrix is singular")
    h, motion = step * 12.0 * CASE.motion.peak_speed / (2.0 * np.pi), CASE.motion
    error = {
        **{FIRST: SIZE * h, SECOND: SIZE * h**2 + 3e-5, FOURTH: SIZE * h**4 + 1e-8 / h, WRONG: 0.05},
        **{Setting.NAIVE: 0.1, Setting.TUNED: 1e-5, Setting.BEST: 1e-9},
    }[how]
    time = np.arange(0.0, motion.duration, step)
    torque = drive_torque(CASE.mechanism.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time))
    runs = how.runs if isinstance(how, Method) else 4 if how is Setting.BEST else 1
    return Run(
        Outcome.FINISHED,
        history=History(torque=Signal(time, torque + error * np.max(np.abs(torque)))),
        seconds=len(time) * 1e-6,
        setup_seconds=1e-4,
        steps=len(time),
        passes=tuple(step / (1 + number) for number in range(runs)),
        details={"scheme": "known"},
    )


def _installed(monkeypatch):
    """The known engine in the registry's place, and nothing remembered of another."""
    found = Scripted(known_run, name="known", channels=(Channel.TORQUE,), methods=METHODS)
    monkeypatch.setattr(benchmark, "engine", lambda name: found)
    monkeypatch.setattr(benchmark, "_WARM", set())
    return found


@pytest.fixture
def known(monkeypatch):
    return _installed(monkeypatch)


@pytest.fixture(scope="module")
def whole():
    """A whole benchmark, and the engine it was made with."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        engine = _installed(monkeypatch)
        yield bench(REQUEST), engine


@pytest.fixture
def measured(whole):
    return whole[0]


def test_orders_and_floors_of_the_known_engine_are_found(measured):
    found = {sweep.setting.iloc[0]: (sweep.order.iloc[0], has_floor(sweep)) for sweep in sweeps(measured.table)}
    assert found == {
        "first": (pytest.approx(1.0, abs=0.05), False),
        "second": (pytest.approx(2.0, abs=0.1), True),
        "fourth": (pytest.approx(4.0, abs=0.1), True),
        "wrong": (None, True),
    }


def test_a_method_that_raises_costs_its_own_points(measured):
    broken = [one for one in measured.points if one.setting == "broken"]
    assert len(broken) == 3
    assert {(one.outcome, one.errors, one.repeats) for one in broken} == {("adapter-error", (), ())}
    assert (
        "known raised RuntimeError: matrix is singular (tests/comparisons/trials/work_precision/test_"
        in broken[0].detail
    )
    assert broken[0].ended.startswith("adapter-error")


def test_points_of_an_interrupted_benchmark_are_not_measured_again(known, tmp_path):
    def interrupting(label, done, total):
        if done == 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bench(REQUEST, interrupting, begin(tmp_path, "this one", "")[0])
    before = Counter(known.asked)
    found = bench(REQUEST, finished=begin(tmp_path, "this one", "")[0])
    finished = {
        run: count for run, count in (Counter(known.asked) - Counter(known.asked[:1])).items() if run[0] != "broken"
    }
    assert sum(before.values()) >= 20
    assert set(finished.values()) == {EXTENT.repeats}
    known.asked.clear()
    again = bench(REQUEST, finished=begin(tmp_path, "this one", "")[0])
    assert known.asked == []
    assert again.points == found.points


def test_no_run_is_begun_after_the_deadline(known):
    hurried = dataclasses.replace(REQUEST, extent=dataclasses.replace(EXTENT, deadline=0.0))
    found = bench(hurried).points
    assert {(one.outcome, one.detail) for one in found} == {("timed-out", OUT_OF_TIME)}
    assert {one.setting for one in found} >= {"best", "first", "wrong"}
    assert known.asked == []


def test_an_engine_that_is_not_installed_has_a_record_that_says_so(known, monkeypatch):
    monkeypatch.setattr(known, "version", lambda: None)
    found = bench(REQUEST)
    (one,) = found.points
    assert (one.outcome, one.engine_version) == ("unavailable", "")
    assert "is not installed" in one.detail
    assert found.document["methods"] == []


def test_an_engine_that_cannot_say_its_methods_has_its_settings_and_a_point_that_says_why(known, monkeypatch):
    def fail(scene):
        raise TypeError("a slip")

    monkeypatch.setattr(known, "methods", fail)
    found = bench(REQUEST).points
    assert [(one.setting, one.outcome) for one in found[:3]] == [(setting, "finished") for setting in Setting]
    assert {(one.setting, one.outcome) for one in found[3:]} == {("methods", "adapter-error")}
    assert "known raised TypeError: a slip (tests/comparisons/trials/work_precision/test_" in found[3].detail
