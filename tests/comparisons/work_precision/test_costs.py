"""Costs: every repeat of every reduction and query is kept, and survives JSON."""

import dataclasses
import json

import pytest

from analytic.description.loading import load
from comparisons.work_precision import costs
from comparisons.work_precision.costs import interleaved, measure, most_reducible, query_jobs, run_jobs
from comparisons.work_precision.records import Bench, rows
from comparisons.work_precision.reductions import REDUCTIONS, without_loads
from engines.contract import Outcome, Run
from tests.analytic.linkages import mechanism
from tests.counting import calls

SLOTTED = "slotted-takeup"


@pytest.fixture
def clock(monkeypatch):
    """Seconds that pass only when a job says so."""
    now = [0.0]
    monkeypatch.setattr(costs.time, "perf_counter", lambda: now[0])
    return now


def test_jobs_take_turns_there_and_back_and_every_repeat_is_kept(clock):
    order = []

    def job(name, seconds):
        def work():
            clock[0] += seconds
            order.append(name)
            return name

        return work

    repeats = interleaved([job("a", 1.0), job("b", 2.0)], budget=12.0)
    assert "".join(order) == "abbaabba"  # a round takes 3 s; a fifth would not fit
    assert repeats == [[(1.0, "a")] * 4, [(2.0, "b")] * 4]


def test_the_fewest_and_most_rounds_are_made_whatever_they_take(clock):
    def slow():
        clock[0] += 100.0

    assert len(interleaved([slow], budget=1.0)[0]) == costs.FEWEST
    assert len(interleaved([lambda: None], budget=1.0)[0]) == costs.MOST


def test_every_reduction_and_query_is_measured_and_survives_json(monkeypatch):
    evaluations = calls(monkeypatch, costs, "evaluate")
    measured = measure(load(SLOTTED), ["direct"], budget=0.0)
    runs = [cost for cost in measured if cost.solver == "direct"]
    queries = [cost for cost in measured if cost.solver == "numpy"]
    assert [cost.reduction for cost in runs] == [reduction.name for reduction in REDUCTIONS]
    assert all((cost.outcome, cost.reason, cost.angles) == ("finished", "", 0) and cost.steps for cost in runs)
    assert all(len(cost.seconds) == len(cost.stepping) == costs.FEWEST for cost in runs)
    assert all(0.0 < inside <= whole for c in runs for inside, whole in zip(c.stepping, c.seconds, strict=True))
    assert all(len(cost.seconds) == costs.FEWEST and cost.angles == costs.ANGLES for cost in queries)
    assert len(evaluations) == 1 + costs.FEWEST * len(queries)  # one goes before
    document = {"costs": json.loads(json.dumps(rows(measured), allow_nan=False))}
    assert list(Bench(document).costs) == measured


def test_a_scene_records_no_more_than_its_reduction():
    models = {cost.reduction: job.args[1] for cost, job in run_jobs(load(SLOTTED), ["direct"])}
    assert {name: model.channels for name, model in models.items()} == {r.name: r.channels for r in REDUCTIONS}
    assert len(models["slots without mass"].bodies) == len(models["everything"].bodies) - 1


class Refusing:
    """An engine that can do nothing."""

    name = "refusing"
    is_control = False

    def run(self, scene, setting):
        return Run(Outcome.UNSUPPORTED, "it will not")


def test_what_an_engine_cannot_do_is_a_row_with_its_outcome(monkeypatch):
    monkeypatch.setattr(costs, "engine", lambda name: Refusing())
    runs = [cost for cost in measure(load(SLOTTED), ["refusing"], budget=0.0) if cost.solver == "refusing"]
    assert {(cost.outcome, cost.reason, cost.steps) for cost in runs} == {("unsupported", "it will not", 0)}


def test_queries_for_what_the_linkage_has_not_are_left_out():
    linkage = dataclasses.replace(load("juki-mf7923d"), output=None)
    names = [cost.reduction for cost, _ in query_jobs(linkage)]
    assert names == ["everything", "Mkr", "Mkr, no gravity", "Mkr, crank at rest", "Q", "Jeq"]


def test_the_linkage_with_most_to_leave_out_is_chosen():
    bare = without_loads(mechanism("centric-slider-crank").linkage)
    assert most_reducible([bare, load(SLOTTED), bare]).name == SLOTTED
