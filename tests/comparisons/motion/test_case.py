"""A case, computed once a clock; and drivers that are not cranks, against ``direct`` and virtual work."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion, swing
from analytic.description.linkage import DriverKind
from analytic.description.loading import load
from analytic.dynamics.reduced import drive_torque, equation_of_motion, equilibria
from analytic.errors import AssemblyError
from analytic.kinematics.dead_centres import top_dead_centre, top_of_turn
from analytic.kinematics.error_bounds import relative_bounds
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, zero_of_output
from comparisons.trials.invariants.checks import checks
from comparisons.trials.judging.quantities import all_quantities
from comparisons.trials.judging.records import Error
from comparisons.trials.judging.signal_errors import signal_errors
from comparisons.trials.observed_motion import ObservedMotion
from engines.contract import History, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.mechanics.start_check import ability_obstacle
from engines.scene import Channel, Scene
from tests.analytic.linkages import double_rocker, driven

MOTIONS = {
    "boom": CrankMotion("there", (Segment(0.0, 0.8, (0.3, 0.05, 0.2, -0.1)),)),
    "cylinder-in-the-loop": CrankMotion("there", (Segment(0.0, 0.3, (0.08, 0.05, 0.3, -0.1)),)),
    "ternary-on-rods": crank_motion("run-up", start_angle=0.3),
    "linear-motor": CrankMotion("there", (Segment(0.0, 0.3, (0.0, 0.1, 1.5, -3.0)),)),
}
LINEAR = ("boom", "cylinder-in-the-loop", "linear-motor")
BLANK = Error("sample", "base", "there", "", "direct", "tuned")


def test_a_crank_that_turns_fully_counts_from_its_top_dead_centre_whatever_it_does():
    mechanism = Mechanism(load("juki-mf7923d"))
    motion = swing("cycloidal", math.radians(100.0), math.radians(140.0), speed=1.0)
    assert zero_of_output(mechanism, motion) == top_dead_centre(mechanism).coordinate


def test_a_crank_that_cannot_counts_from_the_farthest_point_of_the_motion():
    """At the crank angle where crank and coupler are in line the coupler's end is farthest from the crank's pivot."""
    mechanism = Mechanism(double_rocker(along=(-1.0, 0.0)))
    assert top_of_turn(mechanism) is None
    motion = swing("cycloidal", math.radians(-10.0), math.radians(65.0), time=0.3)
    dense = [
        max(mechanism.sweep(motion.angle([0.3 * (k + shift) / 5000 for k in range(5000)])).output())
        for shift in (0.0, 0.5)
    ]
    assert zero_of_output(mechanism, motion) == pytest.approx(max(dense), rel=1e-6)
    assert zero_of_output(mechanism, motion) >= max(dense)
    short = swing("cycloidal", math.radians(50.0), math.radians(65.0), time=0.3)
    ends = mechanism.sweep([math.radians(50.0), math.radians(65.0)]).output()
    assert zero_of_output(mechanism, short) == pytest.approx(max(ends), rel=1e-15)


def ran(case: Case) -> tuple[Scene, History]:
    scene = case.scene(Channel)
    run = DirectEngine().run(scene, Setting.TUNED)
    assert run.history is not None, run.reason
    return scene, run.history


@pytest.mark.parametrize("name", MOTIONS)
def test_direct_agrees_with_a_prescribed_travel(name):
    case = Case(driven(name), MOTIONS[name])
    case.check_motion()
    assert max(error.largest for error in signal_errors(case, *ran(case))) < 1e-12


@pytest.mark.parametrize("name", LINEAR)
def test_every_check_of_the_motion_passes_and_is_in_the_units_of_a_push(name):
    case = Case(driven(name), MOTIONS[name])
    records = {r.quantity: r for r in checks(case, ObservedMotion(*ran(case)), BLANK)}
    assert {r.outcome for r in records.values()} == {"passed"}, records
    assert (records["crank_phase"].unit, records["torque_two_routes"].unit) == ("m", "N")
    assert {q.name: q.unit for q in all_quantities(case).values() if q.name in ("Jeq", "Mkr", "Teq")} == {
        "Jeq": "kg", "Mkr": "N", "Teq": "J",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["boom", "ternary-on-rods"])
def test_a_false_push_is_seen(name):
    case = Case(driven(name), MOTIONS[name])
    scene, history = ran(case)
    assert history.torque is not None
    wrong = replace(history, torque=replace(history.torque, values=1.01 * history.torque.values))
    records = {r.quantity: r.outcome for r in checks(case, ObservedMotion(scene, wrong), BLANK)}
    assert records["torque_two_routes"] == "over-limit"


@pytest.mark.parametrize("name", LINEAR)
def test_the_range_is_said_in_the_length_unit_of_the_file(name):
    mechanism = driven(name)
    limits = mechanism.crank_range()
    low, high = limits.limits
    with pytest.raises(AssemblyError, match=r"mm .*its drive reaches .* mm"):
        limits.check(low, 2.0 * high, "sample")
    with pytest.raises(AssemblyError, match=r"at .* mm:"):
        mechanism.sweep(np.array([high + 1e-3])).poses(mechanism.structure.groups[-1].links[0])
    assert max(relative_bounds(mechanism.turn)) < 1e-8
    equation = equation_of_motion(mechanism)
    assert np.isfinite(equation.peak_moment)
    assert equation.tabulated() is equation


def test_engines_without_linear_drives_refuse_them():
    scene = Case(driven("boom"), MOTIONS["boom"]).scene(Channel)
    reason = ability_obstacle(scene, replace(DirectEngine.abilities, drivers=frozenset({DriverKind.CRANK})))
    assert reason == f"it takes no {scene.driver_kind} as the driver, only a crank"


def test_a_pushed_driver_rests_where_its_force_holds_the_loads():
    force = 1200.0
    rests = equilibria(driven("boom"), force)
    assert rests
    for rest in rests:
        beside = rest.angle + np.array([-1e-6, 0.0, 1e-6])
        needed = drive_torque(driven("boom").sweep(beside), 0.0, 0.0)
        assert needed[1] == pytest.approx(force, abs=1e-9 * max(force, abs(needed[2] - needed[0]) * 1e6))
        assert rest.stable == bool(needed[2] > needed[0])
