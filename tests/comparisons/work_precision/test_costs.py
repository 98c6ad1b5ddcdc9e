"""Costs: every repeat of every reduction is kept, and survives JSON; a reduction takes out what it says."""

import json
from dataclasses import asdict

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from comparisons.work_precision import costs
from comparisons.work_precision.costs import REDUCTIONS, ROUNDS, measure, most_reducible
from comparisons.work_precision.records import Bench
from engines.contract import Outcome, Run
from engines.mechanics.joints import JointEquations
from engines.scene import Prescribed
from tests.analytic.linkages import mechanism
from tests.counting import calls
from tests.engines.lighter import without_loads

SLOTTED = "slotted-takeup"


def test_every_reduction_is_run_in_turn_there_and_back_records_no_more_than_it_says_and_survives_json(monkeypatch):
    run = calls(monkeypatch, costs, "run_engine")
    measured = measure(load(SLOTTED), ["direct"])
    assert [cost.reduction for cost in measured] == [reduction.name for reduction in REDUCTIONS]
    assert all((cost.outcome, cost.reason) == ("finished", "") and cost.steps for cost in measured)
    assert all(len(cost.seconds) == len(cost.stepping) == ROUNDS for cost in measured)
    assert all(0.0 < inside <= whole for c in measured for inside, whole in zip(c.stepping, c.seconds, strict=True))
    channels, turns = [one.channels for one in REDUCTIONS], [args[1].channels for args in run[1:]]
    assert turns == [*channels, *reversed(channels), *channels]
    document = {"costs": json.loads(json.dumps([asdict(one) for one in measured], allow_nan=False))}
    assert list(Bench(document, ()).costs) == measured


class Refusing:
    """An engine that can do nothing."""

    name = "refusing"
    is_control = False

    def run(self, scene, setting):
        return Run(Outcome.UNSUPPORTED, "it will not")


def test_what_an_engine_cannot_do_is_a_row_with_its_outcome(monkeypatch):
    monkeypatch.setattr(costs, "engine", lambda name: Refusing())
    measured = measure(load(SLOTTED), ["refusing"])
    assert {(cost.outcome, cost.reason, cost.steps) for cost in measured} == {("unsupported", "it will not", 0)}


def test_the_linkage_with_most_to_leave_out_is_chosen_and_a_reduction_of_nothing_left_out():
    bare = without_loads(mechanism("centric-slider-crank").linkage)  # no gravity either
    assert most_reducible([bare, load(SLOTTED), bare]).name == SLOTTED
    assert [part for part in REDUCTIONS if part.of(bare)] == [part for part in REDUCTIONS if not part.without]
    assert all(part.of(load(SLOTTED)) for part in REDUCTIONS)


def test_a_linkage_keeps_all_but_what_is_left_out():
    whole, parts = load(SLOTTED), {part.name: part for part in REDUCTIONS}
    weightless, unloaded = parts["no gravity"].of(whole), parts["no loads"].of(whole)
    assert (weightless.gravity, weightless.dampers) == ((0.0, 0.0), whole.dampers)
    assert (unloaded.gravity, unloaded.dampers) == (whole.gravity, ())
    assert whole.dampers


@pytest.mark.parametrize("name", catalogue())
def test_every_mechanism_of_the_catalogue_can_be_reduced(name):
    for part in REDUCTIONS:
        if rest := part.of(load(name)):
            model = scene(Mechanism(rest), Prescribed(crank_motion(start_angle=0.7)), part.channels)
            equations = JointEquations(model)
            assert equations.rows == equations.size
