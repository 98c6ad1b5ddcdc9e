"""A benchmark of an engine whose orders and floors are known finds them, round after round, interrupted or not."""

import dataclasses
from collections import Counter

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.dynamics.reduced import drive_torque
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.runs.run_engine import Failure, Lost
from comparisons.trials.runs.store import begin
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.work_precision import measure
from comparisons.trials.work_precision import study as benchmark
from comparisons.trials.work_precision.fronts import has_floor, sweeps
from comparisons.trials.work_precision.study import OUT_OF_TIME, BenchRequest, Extent, bench
from comparisons.trials.work_precision.table import SETTING
from engines.contract import Abilities, History, Method, Outcome, ReadOut, Run, Setting, Signal
from engines.scene import Channel
from tests.comparisons.faults import PATIENCE

FIRST = Method("first", "first order")
SECOND = Method("second", "second order down to a floor")
FOURTH = Method("fourth", "fourth order until rounding grows", runs=2)
WRONG = Method("wrong", "a read-out that no step mends")
BROKEN = Method("broken", "raises")
METHODS = (FIRST, SECOND, FOURTH, WRONG, BROKEN)
SIZE = 0.2

CASE = Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up-quintic", ramp_time=0.15, hold_time=0.0))
EXTENT = Extent(tuple(12.0 * 2.0**k for k in range(9)), budget=PATIENCE, repeats=3, patience=PATIENCE)
REQUEST = BenchRequest((CASE,), ("known",), ("Mkr",), extent=EXTENT, pool=LocalPool(0))


class KnownEngine:
    """Errors over the peak: c h, c h² + a floor, c h⁴ + r/h, a constant; h over the step at 12 a turn."""

    name = "known"
    work_unit = "iterations"
    is_control = False
    abilities = Abilities({Channel.TORQUE: ReadOut("the truth")}, frozenset(), frozenset(), frozenset())

    def __init__(self, mechanism, motion):
        self.mechanism, self.motion = mechanism, motion
        self.runs = []

    def version(self):
        return "1.0"

    def methods(self, scene):
        return METHODS

    def run(self, scene, setting):
        self.runs.append(setting)
        error = {Setting.NAIVE: 0.1, Setting.TUNED: 1e-5, Setting.BEST: 1e-9}[setting]
        return self._finished(1e-3, error, {"scheme": "known"}, 4 if setting is Setting.BEST else 1)

    def run_method(self, scene, method, step):
        self.runs.append((method.name, step))
        if method.name == "broken":
            raise RuntimeError("matrix is singular")
        return self._finished(step, self.error(method, step), {"step": step}, method.runs)

    def error(self, method, step):
        """The error a method has at a step, over the peak."""
        h = step * 12.0 * self.motion.peak_speed / (2.0 * np.pi)
        return {
            "first": SIZE * h,
            "second": SIZE * h**2 + 3e-5,
            "fourth": SIZE * h**4 + 1e-8 / h,
            "wrong": 0.05,
        }[method.name]

    def _finished(self, step, error, details, runs):
        time = np.arange(0.0, self.motion.duration, step)
        speed, acceleration = self.motion.speed(time), self.motion.acceleration(time)
        torque = drive_torque(self.mechanism.sweep(self.motion.angle(time)), speed, acceleration)
        values = torque + error * np.max(np.abs(torque))
        steps = len(time)
        passes = tuple(step / (1 + number) for number in range(runs))
        return Run(Outcome.FINISHED, "", History(torque=Signal(time, values)), steps * 1e-6, 1e-4, steps, steps * 5,
                   passes, details)  # fmt: skip


def _installed(monkeypatch):
    """The known engine in the registry's place, and nothing remembered of another."""
    found = KnownEngine(CASE.mechanism, CASE.motion)
    for module in (benchmark, measure):
        monkeypatch.setattr(module, "engine", lambda name: found)
    monkeypatch.setattr(benchmark, "engine_names", lambda: ("known",))
    monkeypatch.setattr(measure, "_WARM", set())
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
        "known raised RuntimeError: matrix is singular (tests/comparisons/trials/work_precision/test_study.py"
        in broken[0].detail
    )
    assert broken[0].ended.startswith("adapter-error")


def test_a_process_that_dies_costs_its_own_point(known, monkeypatch):
    run = LocalPool.run

    def dying(pool, function, jobs, *args, **words):
        for number, job in enumerate(jobs):
            dies = job[1] is Setting.BEST
            died = Lost(Failure.CRASHED, "died by signal 6 (SIGABRT)")
            yield number, died if dies else next(run(pool, function, [job], *args, **words))[1]

    monkeypatch.setattr(LocalPool, "run", dying)
    found = {one.setting: one for one in bench(REQUEST).points if one.kind == SETTING}
    assert (found["best"].outcome, found["best"].detail) == ("crashed", "died by signal 6 (SIGABRT)")
    assert found["tuned"].outcome == "finished"


def test_points_of_an_interrupted_benchmark_are_not_measured_again(known, tmp_path):
    def interrupting(label, done, total):
        if done == 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bench(REQUEST, interrupting, begin(tmp_path, "this one", "")[0])
    before = Counter(known.runs)
    found = bench(REQUEST, finished=begin(tmp_path, "this one", "")[0])
    finished = {
        run: count for run, count in (Counter(known.runs) - Counter(known.runs[:1])).items() if run[0] != "broken"
    }
    assert sum(before.values()) >= 20
    assert set(finished.values()) == {EXTENT.repeats}
    known.runs.clear()
    again = bench(REQUEST, finished=begin(tmp_path, "this one", "")[0])
    assert known.runs == []
    assert again.points == found.points


def test_no_run_is_begun_after_the_deadline(known):
    hurried = dataclasses.replace(REQUEST, extent=dataclasses.replace(EXTENT, deadline=0.0))
    found = bench(hurried).points
    assert {(one.outcome, one.detail) for one in found} == {("timed-out", OUT_OF_TIME)}
    assert {one.setting for one in found} >= {"best", "first", "wrong"}
    assert known.runs == []


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
    assert "known raised TypeError: a slip (tests/comparisons/trials/work_precision/test_study.py" in found[3].detail
