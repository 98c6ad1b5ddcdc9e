"""Conditions become scenes; a cell is run by its key in any engine, as JSON and back; a map with its borders."""

import dataclasses
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.description import changes
from analytic.description.loading import catalogue, load
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import reactions
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.trials.runs import environment
from comparisons.trials.runs.run_engine import Failure, Lost
from comparisons.trials.runs.store import temporary_runs
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.stress import campaign
from comparisons.trials.stress import cells as stress
from comparisons.trials.stress.campaign import make_cells
from comparisons.trials.stress.cells import (
    RELEASED,
    Conditions,
    axes,
    case,
    cell_at,
    cells,
    find_cell,
    lost,
    run_cell,
    scene,
)
from comparisons.trials.stress.verdict import Cell, StressVerdict
from engines.contract import Abilities, Method, Outcome, Run
from engines.mechanics.joints import scene_size
from engines.mechanics.start_check import start_misfit
from engines.scene import Channel
from tests.comparisons.true_motions import true_history, with_signal

EVERY = [(axis, row) for axis in axes().values() for row in axis.rows]
STRETCH = 1e4  # times the easy value: beyond it a released motion is only slow to integrate


@pytest.mark.parametrize(
    ("axis", "row"),
    [pytest.param(*one, marks=() if one in EVERY[::7] else pytest.mark.nightly) for one in EVERY],
    ids=lambda one: getattr(one, "name", None) or one.label,
)
def test_every_row_is_a_scene_that_fits_its_joints_at_both_ends_and_at_its_easy_value(axis, row):
    values = axis.chosen_values(row, quick=False)
    if row.motion == RELEASED:
        values = tuple(value for value in values if value <= STRETCH)[:3]
    for value in {values[0], values[-1], axis.good}:
        conditions = axis.conditions(row.label, value)
        given = scene(conditions, case(conditions))
        misfit = start_misfit(given)
        assert (misfit is None) or (conditions.disturbed and value > 1e-7), (value, misfit)
        assert all(body.mass > 0.0 for body in given.bodies)


@pytest.mark.parametrize("axis", axes().values(), ids=lambda axis: axis.name)
def test_an_axis_varies_a_field_over_values_that_hold_its_easy_one(axis):
    assert axis.vary in {field.name for field in fields(Conditions)}
    assert axis.good in axis.values
    assert len(set(axis.values)) == len(axis.values)
    assert set(axis.quick) <= set(axis.values)
    assert axis.settings or axis.methods
    assert sum(row.quick for row in axis.rows) >= 1
    assert len({row.label for row in axis.rows}) == len(axis.rows)
    assert all("/" not in row.label for row in axis.rows)  # it separates the words of a cell's name
    for row in axis.rows:
        assert getattr(axis.conditions(row.label, 0.125), axis.vary) == 0.125


JUKI = Conditions("juki-mf7923d")
POWERS = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)
LOADED = ["tests/linkages/spring-and-damper.toml", "tests/linkages/force-over-angle.toml", *catalogue()]


@settings(max_examples=10)
@given(name=st.sampled_from(LOADED), length=POWERS, mass=POWERS, time=POWERS)
def test_the_closed_form_does_not_notice_units(name, length, mass, time):
    """Torque has the unit m l² t⁻², joint forces m l t⁻²; in these all is the same to rounding."""
    plain, scaled = Mechanism(load(name)), Mechanism(changes.scaled(load(name), length=length, mass=mass, time=time))
    angle = np.linspace(0.3, 9.0, 25)
    speed, acceleration = 70.0, 900.0
    found, there = plain.sweep(angle), scaled.sweep(angle)
    torque = reduced.drive_torque(found, speed, acceleration)
    moved = reduced.drive_torque(there, speed / time, acceleration / time**2) * time**2 / (mass * length**2)
    assert np.max(np.abs(torque - moved)) < 1e-10 * np.max(np.abs(torque))
    forces = reactions(found, speed, acceleration).forces
    others = reactions(there, speed / time, acceleration / time**2).forces
    peak = max(np.max(np.abs(force)) for force in forces.values())
    for joint, force in forces.items():
        assert np.max(np.abs(force - others[joint] * time**2 / (mass * length))) < 1e-10 * peak


@pytest.mark.parametrize("what", ["position", "velocity"])
@pytest.mark.parametrize("size", [1e-9, 1e-3])
def test_a_disturbed_start_is_off_by_so_much_and_no_more(what, size):
    conditions = replace(JUKI, motion="constant-speed", disturbed=what, disturbance=size)
    true = case(conditions)
    given, fits = scene(conditions, true), true.scene(frozenset(Channel))
    scale = scene_size(fits) * (conditions.rate if what == "velocity" else 1.0)
    for body, other in zip(given.bodies, fits.bodies, strict=True):
        off = np.hypot(*(np.array(getattr(body, what)) - getattr(other, what)))
        assert off == pytest.approx(size * scale, rel=1e-6)
    assert (start_misfit(given) is None) is (size < 1e-6)


def damped(factor, turns=0.5):
    return Conditions(
        "sprung-crank-rocker", motion="released", start_angle=60.0, spinning=False, turns=turns, torque=0.2,
        load="dampers", load_factor=factor,
    )  # fmt: skip


def test_a_crank_that_is_held_back_for_ever_is_refused_in_a_sentence():
    assert case(damped(1.0)).motion.duration == pytest.approx(0.03)
    with pytest.raises(LinkproofError, match=r"time constant Jeq/b or less, got \de\+\d+; damp less"):
        case(damped(1e8))


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


COUPLER = cell_at(axes()["mass"], "four-bar, coupler", 100.0, "perfect", "tuned")


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


@pytest.mark.parametrize("engine", [Perfect(), Liar()])
def test_the_store_holds_all_of_a_cell(with_engine, engine):
    with_engine(engine)
    found, runs = run_cell(dataclasses.replace(COUPLER, value=1e4)), temporary_runs()
    runs.add(found.key, *found.written())
    assert Cell.from_row(*runs.read(found.key)) == found
    assert found.data["command"] == "linkproof stress 'mass/four-bar, coupler/10000/perfect/tuned'"
    for failure in Failure:
        found = lost(Lost(failure, "as tested"), COUPLER).data
        assert found["verdict"] == failure.value


# -- maps --------------------------------------------------------------------------------------------------------------


def stress_test(quick=False, **changes):
    axis = dataclasses.replace(axes()["mass"], rows=(axes()["mass"].row("four-bar, coupler"),))
    chosen = cells((axis,), ("perfect",), ("tuned",), quick=quick)
    return campaign.stress(chosen, quick=quick, pool=LocalPool(0), **changes)


def test_a_wrong_motion_is_caught_in_every_cell_and_its_border_is_bisected(with_engine):
    with_engine(Liar())
    heard = []
    found = stress_test(announce=lambda *words: heard.append(words))
    verdicts = {one.value: one.verdict for one in found.cells}
    assert {value: verdicts[value] for value in axes()["mass"].values} == {
        value: StressVerdict.CAUGHT if value > 500.0 else StressVerdict.WITHIN for value in axes()["mass"].values
    }
    (border,) = found.borders
    assert border.inside.value <= 500.0 < border.outside.value <= 1.1 * border.inside.value
    assert found.of(StressVerdict.MISSED) == ()
    told = found.as_dict
    assert told["summary"]["perfect"]["caught"] == sum(one.verdict is StressVerdict.CAUGHT for one in found.cells)
    assert told["borders"][0]["inside_command"].startswith("linkproof stress 'mass/four-bar, coupler/")
    assert heard[-1][1] == heard[-1][2] == len(found.cells)


def test_what_was_finished_before_an_interruption_is_not_run_again(with_engine):
    def interrupt(_, done, known):
        if done == 2:
            raise KeyboardInterrupt

    first, finished = with_engine(Perfect()), temporary_runs()
    with pytest.raises(KeyboardInterrupt):
        stress_test(quick=True, announce=interrupt, finished=finished)
    second = with_engine(Perfect())
    found = stress_test(quick=True, finished=finished)
    assert (len(first.asked), len(second.asked)) == (2, 1)
    assert {one.value for one in found.cells} == {*axes()["mass"].quick}


def test_an_engine_that_raises_costs_its_own_cell(with_engine):
    class Faulty(Perfect):
        def run(self, scene, setting):
            if max(body.mass for body in scene.bodies) > 15.0:
                raise RuntimeError("singular")
            return super().run(scene, setting)

    with_engine(Faulty())
    found = {one.value: one for one in stress_test(quick=True).cells}
    assert found[1.0].verdict is StressVerdict.WITHIN
    assert found[1e4].verdict is StressVerdict.ADAPTER_ERROR
    assert "RuntimeError: singular (tests/comparisons/trials/stress/test_cells.py, line " in found[1e4].reason


def test_a_fault_of_the_suites_own_is_not_blamed_on_the_engine(with_engine, monkeypatch):
    with_engine(Perfect())

    def failing(*_):
        raise TypeError("a slip in the judge")

    monkeypatch.setattr(stress, "judged", failing)
    verdicts = {(one.verdict, one.reason) for one in stress_test(quick=True).cells}
    ((verdict, reason),) = verdicts
    assert verdict is StressVerdict.SUITE_ERROR
    assert reason.startswith("this is a fault of linkproof: TypeError: a slip in the judge (comparisons/")
    assert "a slip in the judge" in reason


def test_where_the_closed_form_has_no_motion_no_engine_is_tried(with_engine, monkeypatch):
    engine = with_engine(Perfect())

    def nowhere(_):
        raise LinkproofError("it stands in a dead position")

    monkeypatch.setattr(stress, "case", nowhere)
    found = run_cell(COUPLER)
    assert (found.verdict, engine.asked) == (StressVerdict.UNSUPPORTED, [])
    assert found.reason == "the closed form has no motion to hold an engine to: it stands in a dead position"


def test_a_cell_can_be_made_alone_in_a_process_of_its_own():
    (found,) = make_cells([find_cell("units/length/1000/direct/tuned")])
    assert found.verdict is StressVerdict.WITHIN
