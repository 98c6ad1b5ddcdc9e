"""The judge works out once what several quantities need, and what is measured of an economy is all of what was done."""

import dataclasses
import json
import pickle

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.description.linkage import PointForce
from analytic.description.loading import catalogue, load
from analytic.dynamics import joint_forces, reduced
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.turning_dyads import ArmAndSlider, SwingingSlide, TwoTurningArms
from comparisons.judging.deviations import deviation
from comparisons.judging.quantities import chosen_quantities
from comparisons.reference import case as cases
from comparisons.reference.case import KEPT, Case
from comparisons.reference.start_state import scene
from comparisons.work_precision import economy
from comparisons.work_precision.economy import (
    angle_costs,
    conditions,
    fullest,
    interleaved,
    loads,
    measure,
    recorded,
    scenes,
)
from comparisons.work_precision.economy_records import Economy
from comparisons.work_precision.reductions import REDUCTIONS, rest_of, without_loads, without_slot_masses
from engines.contract import History, Run, Setting, Signal
from engines.contract import Outcome as Ended
from engines.direct_adapter.equations import Equations
from engines.scene import Channel, Prescribed
from reports.command_line.requests import Choice, request
from tests.analytic.linkages import EVERY, FULL_TURN, angles, mechanism
from tests.comparisons.perfect_engine import perfect_motion
from tests.counting import calls

SIX_BAR, SLOTTED, SPRUNG = "rimoldi-164", "slotted-takeup", "spring-and-damper"
MOTION = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02)
TIMES = np.linspace(0.0, MOTION.duration, 50)


# -- the judge ---------------------------------------------------------------------------------------------------------


def _solved(monkeypatch):
    kinds = (TwoTurningArms, ArmAndSlider, SwingingSlide)
    return {step: [calls(monkeypatch, kind, step) for kind in kinds] for step in ("poses", "rates", "accelerations")}


def _judged(case, motion, names=()):
    return [deviation(case, quantity, motion) for quantity in chosen_quantities(case, names)]


def test_all_quantities_on_a_clock_share_one_solution_of_the_linkage(monkeypatch):
    """Jeq, which leaves out the samples near standstill, has a clock of its own."""
    sample = mechanism(SIX_BAR)
    motion, case = perfect_motion(sample, MOTION, 101), Case(sample, MOTION)
    _judged(case, motion, ["S"])  # finds the top dead centre, once for the mechanism
    dyads, solved = len(sample.structure.dyads), _solved(monkeypatch)
    others = [quantity.name for quantity in chosen_quantities(case, ()) if quantity.name != "Jeq"]
    assert len(_judged(Case(sample, MOTION), motion, others)) > dyads
    assert {step: sum(map(len, seen)) for step, seen in solved.items()} == dict.fromkeys(solved, dyads)


def test_jeq_alone_is_judged_without_second_derivatives_forces_or_torques(monkeypatch):
    sample = mechanism(SIX_BAR)
    motion, case = perfect_motion(sample, MOTION, 101), Case(sample, MOTION)
    solved, asked = (
        _solved(monkeypatch),
        [
            calls(monkeypatch, joint_forces, "reactions"),
            calls(monkeypatch, reduced, "half_inertia_slope"),
            calls(monkeypatch, reduced, "generalised_force"),
        ],
    )
    (found,) = _judged(case, motion, ["Jeq"])
    assert found.samples > 0
    assert sum(map(len, solved["accelerations"])) == 0
    assert not any(asked)


def test_jeq_alone_asks_an_engine_for_velocities_and_for_no_invariant():
    (jeq,) = chosen_quantities(Case(mechanism(SIX_BAR), MOTION), ["Jeq"])
    assert jeq.channels == {Channel.VELOCITY}
    assert not request(Choice(quantities=("Jeq",))).with_invariants
    assert request(Choice()).with_invariants


def test_the_truth_on_a_clock_is_worked_out_once(monkeypatch):
    case = Case(mechanism(SIX_BAR), MOTION)
    forces = calls(monkeypatch, cases, "joint_forces")
    torques, inertias = calls(monkeypatch, reduced, "drive_torque"), calls(monkeypatch, reduced, "reduced_inertia")
    for _ in range(3):
        at = case.at(TIMES.copy())
        assert set(at.joint_forces) == set(case.joint_names())
        assert at.torque is case.at(TIMES).torque
        assert at.inertia is case.at(TIMES).inertia
    assert (len(forces), len(torques), len(inertias)) == (1, 1, 2)  # the torque has its own Jeq


def test_all_joints_of_a_run_share_one_analysis_and_torque_and_power_one_torque(monkeypatch):
    sample = mechanism(SIX_BAR)
    motion, case = perfect_motion(sample, MOTION, 101), Case(sample, MOTION)
    forces, torques = calls(monkeypatch, cases, "joint_forces"), calls(monkeypatch, reduced, "drive_torque")
    found = _judged(case, motion, ["Mkr", "Peq", "joint_force"])
    assert len(found) == 2 + len(case.joint_names())
    assert (len(forces), len(torques)) == (1, 1)


def test_the_truth_on_a_clock_is_the_closed_form():
    sample = mechanism(SPRUNG)
    at = Case(sample, MOTION).at(TIMES)
    sweep, speed, acceleration = sample.sweep(MOTION.angle(TIMES)), MOTION.speed(TIMES), MOTION.acceleration(TIMES)
    assert np.array_equal(at.inertia, reduced.reduced_inertia(sweep))
    assert np.array_equal(at.torque, reduced.drive_torque(sweep, speed, acceleration))
    forces = joint_forces.joint_forces(sweep, speed, acceleration)
    assert all(np.array_equal(at.joint_forces[name], force) for name, force in forces.items())


def test_a_case_keeps_the_truth_of_its_latest_clocks_alone_and_travels_without_it():
    case = Case(mechanism(SIX_BAR), MOTION, conditions="as tested")
    kept = [case.at(TIMES + shift) for shift in 1e-3 * np.arange(KEPT + 2)]
    assert case.at(kept[-1].time) is kept[-1]
    assert case.at(kept[-KEPT].time) is kept[-KEPT]
    assert len(case._seen) == KEPT
    assert case.at(kept[0].time) is not kept[0]
    there = pickle.loads(pickle.dumps(case))
    assert there._seen == {}
    assert (there.conditions, there.joint_names()) == (case.conditions, case.joint_names())
    assert np.array_equal(there.at(TIMES).inertia, case.at(TIMES).inertia)


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_joints_are_named_without_solving_anything(monkeypatch, name, variant):
    sample = mechanism(name, variant)
    named = tuple(joint_forces.joint_forces(sample.sweep(np.array([0.7])), 0.0, 0.0))
    solved = _solved(monkeypatch)
    assert Case(sample, MOTION).joint_names() == named
    assert not any(map(any, solved.values()))


# -- reductions --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_conditions_are_as_many_as_the_equations_of_the_linkage(name, variant):
    model = scene(mechanism(name, variant), Prescribed(crank_motion(start_angle=0.7)), frozenset())
    assert conditions(model) == Equations(model).rows == Equations(model).size


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_a_linkage_with_bare_pins_in_its_slots_moves_as_before(name, variant):
    whole = mechanism(name, variant)
    bare = Mechanism(without_slot_masses(whole.linkage))
    left = list(bare.linkage.links)
    sweeps = [sample.sweep(angles(20)) for sample in (whole, bare)]
    for link in left:
        one, other = (sweep.local_point(link, (0.01, 0.02), 2) for sweep in sweeps)
        assert all(np.allclose(a, b, rtol=1e-9, atol=1e-9) for a, b in zip(one, other, strict=True))
    assert np.allclose(reduced.reduced_inertia(sweeps[0], left), reduced.reduced_inertia(sweeps[1]), rtol=1e-12)


def test_a_slot_mass_that_is_pulled_at_stays():
    linkage = load(SLOTTED)
    assert "slot_slider" not in without_slot_masses(linkage).links
    pull = PointForce("P4", "slot_slider", Law(np.array([1.0, 2.0])))
    assert "slot_slider" in without_slot_masses(dataclasses.replace(linkage, forces=(pull,))).links


def test_a_reduction_that_takes_nothing_out_is_left_out():
    bare = without_loads(mechanism("centric-slider-crank").linkage)  # no gravity either, and no slot
    names = [reduction.name for reduction, _ in scenes(bare)]
    assert names == [reduction.name for reduction in REDUCTIONS if reduction.rest is None]
    assert all(rest_of(load(SLOTTED), reduction) for reduction in REDUCTIONS)
    assert fullest([bare, load(SLOTTED), bare]).name == SLOTTED


def test_a_scene_has_what_its_reduction_leaves():
    counts = {reduction.name: (len(model.bodies), loads(model)) for reduction, model in scenes(load(SLOTTED))}
    whole = counts["everything"]
    assert whole == (5, 5 + 1)  # a weight each, and the crank's damper
    assert counts["no gravity"] == (5, 1)
    assert counts["no loads"] == (5, 5)
    assert counts["slots without mass"] == (4, 4 + 1)
    assert all(counts[name] == whole for name in ("no joint forces", "motion alone", "Jeq alone", "nothing recorded"))


# -- measuring ---------------------------------------------------------------------------------------------------------


def test_the_numbers_recorded_are_those_of_all_channels():
    three = Signal(np.arange(3.0), np.zeros((3, 2, 3)))
    force = Signal(np.arange(2.0), np.zeros((2, 2)))
    assert recorded(History(position=three, torque=Signal(np.arange(3.0), np.zeros(3)), joint_force={"A": force})) == 25
    assert recorded(History()) == recorded(None) == 0


@pytest.fixture
def clock(monkeypatch):
    """Seconds that pass only when a job says so."""
    now = [0.0]
    monkeypatch.setattr(economy.time, "perf_counter", lambda: now[0])
    return now


def test_jobs_take_turns_there_and_back_and_every_repeat_is_kept(clock):
    order = []

    def job(name, seconds):
        def work():
            clock[0] += seconds
            order.append(name)
            return name

        return work

    found = interleaved([job("a", 1.0), job("b", 2.0)], budget=12.0)
    assert "".join(order) == "abbaabba"  # a round takes 3 s; a fifth would not fit
    assert found == [[(1.0, "a")] * 4, [(2.0, "b")] * 4]


def test_the_fewest_and_most_rounds_are_made_whatever_they_take(clock):
    def slow():
        clock[0] += 100.0

    assert len(interleaved([slow], budget=1.0)[0]) == economy.FEWEST
    assert len(interleaved([lambda: None], budget=1.0)[0]) == economy.MOST


def test_what_is_measured_is_told_whole_and_survives_json():
    found = measure([load(SLOTTED)], ["direct"], budget=0.0, paths=["numpy"])
    assert [cost.reduction for cost in found.runs] == [reduction.name for reduction in REDUCTIONS]
    assert all(cost.outcome == Ended.FINISHED and not cost.reason for cost in found.runs)
    assert all(len(cost.seconds) == len(cost.stepping) == economy.FEWEST for cost in found.runs)
    assert all(0.0 < inside <= whole for c in found.runs for inside, whole in zip(c.stepping, c.seconds, strict=True))
    values = {cost.reduction: cost.values for cost in found.runs}
    assert values["nothing recorded"] == 0
    assert 0 < 3 * values["Jeq alone"] == values["motion alone"] < values["no joint forces"] < values["everything"]
    told = json.loads(json.dumps(found.rows(), allow_nan=False))
    assert Economy.from_rows(told) == found
    assert told["runs"][0]["seconds_min"] == min(found.runs[0].seconds)
    assert told["angles"][0]["seconds_median"] == float(np.median(found.angles[0].seconds))


class Refusing:
    """An engine that can do nothing."""

    name = "refusing"

    def version(self):
        return "1.0"

    def obstacle(self, scene):
        return "it will not"

    def run(self, scene, setting):
        return Run(Ended.UNSUPPORTED, "it will not")


def test_what_an_engine_cannot_do_is_a_row_with_its_outcome(monkeypatch):
    monkeypatch.setattr(economy, "engine", lambda name: Refusing())
    found = economy.run_costs([load(SLOTTED)], ["refusing"], Setting.TUNED, 0.0)
    assert {(cost.engine, cost.outcome, cost.reason) for cost in found} == {("refusing", "unsupported", "it will not")}
    assert {cost.values for cost in found} == {0}


def test_the_closed_form_is_asked_for_what_the_linkage_has(monkeypatch):
    asked = calls(monkeypatch, economy, "evaluate")
    linkage = dataclasses.replace(load("juki-mf7923d"), output=None)
    found = angle_costs([linkage], ["numpy"], 0.0)
    assert [cost.reduction for cost in found] == [
        "everything",
        "Mkr",
        "Mkr, no gravity",
        "Mkr, crank at rest",
        "Q",
        "Jeq",
    ]
    assert found[0].quantities == ("Jeq", "Teq", "Q", "Mkr", "Peq")
    assert len(asked) == 1 + economy.FEWEST * len(found)  # one goes before
    assert all(len(cost.seconds) == economy.FEWEST and cost.angles == economy.ANGLES[cost.path] for cost in found)


def test_every_mechanism_of_the_catalogue_can_be_reduced():
    for name in catalogue():
        for _, model in scenes(load(name)):
            assert conditions(model) == Equations(model).size
