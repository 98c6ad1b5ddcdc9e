"""The closed form is worked out once for all that is judged on one clock, and only as far as a quantity needs it."""

import pickle

import numpy as np
import pytest

from analytic import moving
from analytic.description.crank_motion import crank_motion
from analytic.dynamics import joint_forces, reduced
from analytic.kinematics.dyad_solver import DyadSolver
from comparisons.judging.deviations import deviation
from comparisons.judging.quantities import chosen_quantities
from comparisons.reference.case import MOST_CLOCKS, Case
from engines.scene import Channel
from reports.requests.campaign import request
from reports.requests.options.campaign import CompareOptions
from tests.analytic.linkages import EVERY, mechanism
from tests.comparisons.perfect_engine import perfect_motion
from tests.counting import calls

SIX_BAR, SPRUNG = "rimoldi-164", "spring-and-damper"
MOTION = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02)
TIMES = np.linspace(0.0, MOTION.duration, 50)


def _solved(monkeypatch):
    return {step: calls(monkeypatch, DyadSolver, step) for step in ("poses", "rates", "accelerations")}


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
    assert {step: len(seen) for step, seen in solved.items()} == dict.fromkeys(solved, dyads)


def test_jeq_alone_is_judged_without_second_derivatives_forces_or_torques(monkeypatch):
    sample = mechanism(SIX_BAR)
    motion, case = perfect_motion(sample, MOTION, 101), Case(sample, MOTION)
    solved, asked = (
        _solved(monkeypatch),
        [
            calls(monkeypatch, joint_forces, "reactions"),
            calls(monkeypatch, reduced, "half_inertia_derivative"),
            calls(monkeypatch, reduced, "generalised_force"),
        ],
    )
    (found,) = _judged(case, motion, ["Jeq"])
    assert found.samples > 0
    assert not solved["accelerations"]
    assert not any(asked)


def test_jeq_alone_asks_an_engine_for_velocities_and_for_no_invariant():
    (jeq,) = chosen_quantities(Case(mechanism(SIX_BAR), MOTION), ["Jeq"])
    assert jeq.channels == {Channel.VELOCITY}
    assert not request(CompareOptions(quantity=("Jeq",))).with_invariants
    assert request(CompareOptions()).with_invariants


def test_the_truth_on_a_clock_is_worked_out_once(monkeypatch):
    case = Case(mechanism(SIX_BAR), MOTION)
    forces = calls(monkeypatch, moving, "joint_forces")
    torques, inertias = calls(monkeypatch, reduced, "balance"), calls(monkeypatch, reduced, "reduced_inertia")
    for _ in range(3):
        at = case.at(TIMES.copy())
        assert set(at.joint_forces) == set(case.joint_names())
        assert at.torque is case.at(TIMES).torque
        assert at.inertia is case.at(TIMES).inertia
    assert (len(forces), len(torques), len(inertias)) == (1, 1, 1)


def test_all_joints_of_a_run_share_one_analysis_and_torque_and_power_one_torque(monkeypatch):
    sample = mechanism(SIX_BAR)
    motion, case = perfect_motion(sample, MOTION, 101), Case(sample, MOTION)
    forces, torques = calls(monkeypatch, moving, "joint_forces"), calls(monkeypatch, reduced, "balance")
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
    kept = [case.at(TIMES + shift) for shift in 1e-3 * np.arange(MOST_CLOCKS + 2)]
    assert case.at(kept[-1].time) is kept[-1]
    assert case.at(kept[-MOST_CLOCKS].time) is kept[-MOST_CLOCKS]
    assert len(case._seen) == MOST_CLOCKS
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
    assert not any(solved.values())
