"""A cell by its key, run in any engine, as JSON and back; a map of cells, its journal and its borders."""

import contextlib
import dataclasses
import json

import pytest

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.runs import environment
from comparisons.runs.files import RECORDS
from comparisons.runs.run_engine import AdapterError, Failure, Lost
from comparisons.runs.study import Journal
from comparisons.runs.workers import LocalPool
from comparisons.stress import campaign
from comparisons.stress import cells as stress
from comparisons.stress.campaign import StressRequest, make_cells
from comparisons.stress.cells import axes, case, find_cell, lost, run_cell, usages
from comparisons.stress.verdict import Cell, CellResult, StressVerdict
from engines.contract import Abilities, Method, Outcome, Run
from tests.comparisons.true_motions import true_history, with_signal


class Perfect:
    """An engine that reads the truth off the closed form, and remembers what it was asked."""

    name = "perfect"
    abilities = Abilities({}, frozenset(), frozenset(), frozenset())
    is_control = False
    work_unit = "thoughts"

    def __init__(self):
        self.asked = []

    def version(self):
        return "1"

    def methods(self, scene):
        return (Method("defaults", "as it comes"), Method("centred", "careful", effort=7.0, effort_unit="iterations"))

    def run(self, scene, setting):
        self.asked.append(("run", setting))
        return self._answer(scene)

    def run_method(self, scene, method, step):
        self.asked.append(("method", method.name, method.effort, step))
        return self._answer(scene)

    def _answer(self, scene):
        return Run(Outcome.FINISHED, history=self.history(scene), seconds=0.25, steps=12, solver_work=3)

    def history(self, scene):
        one = case(axes()["mass"].conditions("four-bar, coupler", 1.0))
        linkage = one.mechanism.linkage
        heavy = {body.name: body for body in scene.bodies}
        links = {
            n: dataclasses.replace(k, mass=heavy[n].mass, inertia=heavy[n].inertia) for n, k in linkage.links.items()
        }
        true = type(one.mechanism)(dataclasses.replace(linkage, links=links))
        return true_history(one, 601, mechanism=true)


class Liar(Perfect):
    """The same, but for velocities, beyond a mass that is too much for it; it never says so."""

    def history(self, scene):
        told = super().history(scene)
        if max(body.mass for body in scene.bodies) > 500.0 * 0.03:
            told = with_signal(told, "velocity", lambda values, _: 0.9 * values)
        return told


@pytest.fixture
def with_engine(monkeypatch):
    def install(one):
        for module in (stress, campaign):
            if hasattr(module, "engine"):
                monkeypatch.setattr(module, "engine", lambda name: one)
        monkeypatch.setattr(environment, "adapters", lambda names: [one for _ in names])
        return one

    return install


COUPLER = Cell("mass", "four-bar, coupler", 100.0, "perfect", "tuned")


@pytest.mark.parametrize(
    ("key", "error", "words"),
    [
        ("mass/four-bar, coupler/100", LinkproofError, "AXIS/ROW/VALUE/ENGINE/USAGE"),
        ("mas/four-bar, coupler/100/perfect/tuned", UnknownNameError, "unknown axis 'mas'"),
        ("mass/four-bar, rod/100/perfect/tuned", UnknownNameError, "row of axis 'mass'"),
        ("mass/four-bar, coupler/100/perfect/tune", UnknownNameError, "usage of 'perfect'"),
        ("mass/four-bar, coupler/heavy/perfect/tuned", LinkproofError, "expected a number"),
    ],
)
def test_a_cell_that_does_not_exist_is_refused(with_engine, key, error, words):
    with_engine(Perfect())
    with pytest.raises(error, match=words):
        find_cell(key)


def test_the_truth_is_within_limit_at_any_mass(with_engine):
    engine = with_engine(Perfect())
    found = run_cell(COUPLER)
    assert found.verdict is StressVerdict.WITHIN
    assert (found.seconds, found.steps, found.solver_work) == (0.25, 12, 3)
    assert found.differing == {"linkage": found.mechanism, "link": "coupler", "mass_factor": 100.0}
    assert engine.asked == [("run", "tuned")]


def test_a_method_is_run_at_its_step_with_its_effort(with_engine):
    engine = with_engine(Perfect())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stress, "judged", lambda blank, *_: blank)
        with contextlib.suppress(AdapterError):  # it has no motion for this linkage
            run_cell(Cell("speed", "1000 rpm", 120.0, "perfect", "defaults"))
        with contextlib.suppress(AdapterError):
            run_cell(Cell("iterations", "100 steps per turn", 30.0, "perfect", "centred"))
    assert engine.asked[0] == ("method", "defaults", None, pytest.approx(0.06 / 120.0))
    assert engine.asked[1] == ("method", "centred", 30.0, pytest.approx(0.06 / 100.0))


@pytest.mark.parametrize("engine", [Perfect(), Liar()])
def test_json_holds_all_of_a_cell(with_engine, engine):
    with_engine(engine)
    found = run_cell(dataclasses.replace(COUPLER, value=1e4))
    told = json.loads(json.dumps(found.data, allow_nan=False))
    assert CellResult.from_row(told) == found
    assert told["command"] == "linkproof stress 'mass/four-bar, coupler/10000/perfect/tuned'"
    for failure in Failure:
        found = lost(Lost(failure, "as tested"), COUPLER).data
        assert found["verdict"] == failure.value


# -- maps --------------------------------------------------------------------------------------------------------------


def request(**changes):
    axis = dataclasses.replace(axes()["mass"], rows=(axes()["mass"].row("four-bar, coupler"),))
    return StressRequest((axis,), ("perfect",), ("tuned",), pool=LocalPool(0), **changes)


def test_a_wrong_motion_is_caught_in_every_cell_and_its_border_is_bisected(with_engine):
    with_engine(Liar())
    heard = []
    found = campaign.stress(request(), lambda *words: heard.append(words))
    verdicts = {one.cell.value: one.verdict for one in found.cells}
    assert {value: verdicts[value] for value in axes()["mass"].values} == {
        value: StressVerdict.CAUGHT if value > 500.0 else StressVerdict.WITHIN for value in axes()["mass"].values
    }
    (border,) = found.borders
    assert border.inside <= 500.0 < border.outside
    assert border.ratio <= 1.1
    assert found.of(StressVerdict.MISSED) == ()
    told = found.document
    assert told["summary"]["perfect"]["caught"] == sum(one.verdict is StressVerdict.CAUGHT for one in found.cells)
    assert told["borders"][0]["inside_command"].startswith("linkproof stress 'mass/four-bar, coupler/")
    assert heard[-1][1] == heard[-1][2] == len(found.cells)


def test_cells_in_the_journal_are_not_run_again(with_engine, tmp_path):
    engine = with_engine(Liar())
    journal = Journal(tmp_path, "as asked")
    first = campaign.stress(request(), journal=journal)
    calls = len(engine.asked)
    again = campaign.stress(request(), journal=journal)
    assert len(engine.asked) == calls
    assert (again.cells, again.borders) == (first.cells, first.borders)
    path = journal.place / RECORDS
    path.write_text("".join(line for line in path.read_text().splitlines(keepends=True) if "/100/" not in line))
    campaign.stress(request(), journal=Journal(tmp_path, "as asked"))
    assert len(engine.asked) == calls + 1


def test_an_engine_that_raises_costs_its_own_cell(with_engine):
    class Faulty(Perfect):
        def run(self, scene, setting):
            if max(body.mass for body in scene.bodies) > 15.0:
                raise RuntimeError("singular")
            return super().run(scene, setting)

    with_engine(Faulty())
    found = {one.cell.value: one for one in campaign.stress(request(quick=True)).cells}
    assert found[1.0].verdict is StressVerdict.WITHIN
    assert found[1e4].verdict is StressVerdict.ADAPTER_ERROR
    assert "RuntimeError: singular (tests/comparisons/stress/test_cells.py, line " in found[1e4].reason


def test_a_fault_of_the_suites_own_is_not_blamed_on_the_engine(with_engine, monkeypatch):
    with_engine(Perfect())

    def failing(*_):
        raise TypeError("a slip in the judge")

    monkeypatch.setattr(stress, "judged", failing)
    verdicts = {(one.verdict, one.reason) for one in campaign.stress(request(quick=True)).cells}
    ((verdict, reason),) = verdicts
    assert verdict is StressVerdict.SUITE_ERROR
    assert reason.startswith("this is a fault of linkproof: TypeError: a slip in the judge (comparisons/")
    assert "a slip in the judge" in reason


def test_where_the_closed_form_has_no_motion_no_engine_is_tried(with_engine, monkeypatch):
    engine = with_engine(Perfect())

    def nowhere(_):
        raise LinkproofError("it stands in a dead position")

    monkeypatch.setattr(stress, "_case", nowhere)
    found = run_cell(COUPLER)
    assert (found.verdict, engine.asked) == (StressVerdict.UNSUPPORTED, [])
    assert found.reason == "the closed form has no motion to hold an engine to: it stands in a dead position"


def test_a_cell_can_be_made_alone_in_a_process_of_its_own():
    (found,) = make_cells([Cell("units", "length", 1e3, "direct", "tuned")])
    assert found.verdict is StressVerdict.WITHIN


def test_usages_are_settings_or_the_methods_an_engine_has():
    assert usages(axes()["mass"], Perfect()) == list(axes()["mass"].settings)
    assert usages(axes()["speed"], Perfect()) == ["defaults", "centred"]
    assert usages(axes()["iterations"], Perfect()) == ["centred"]
    assert usages(axes()["tolerance"], Perfect()) == []
