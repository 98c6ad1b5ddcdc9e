"""Drivers that are not cranks: the closed form against ``direct``, virtual work against forces, units and words."""

from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from analytic.description.linkage import DriverKind
from analytic.dynamics.joint_forces import reactions
from analytic.dynamics.reduced import drive_torque, equation_of_motion, equilibria
from analytic.errors import AssemblyError
from analytic.signals import evaluate
from comparisons.case import Case, channel_truth
from comparisons.invariants.checks import checks
from comparisons.judging.quantities import all_quantities
from comparisons.judging.records import Record
from comparisons.observed_motion import ObservedMotion
from engines.contract import History, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.mechanics.start_check import ability_obstacle
from engines.scene import Channel, Scene
from tests.analytic.drives import driven

MOTIONS = {
    "boom": CrankMotion("there", (Segment(0.0, 0.8, (0.3, 0.05, 0.2, -0.1)),)),
    "cylinder-in-the-loop": CrankMotion("there", (Segment(0.0, 0.3, (0.08, 0.05, 0.3, -0.1)),)),
    "ternary-on-rods": crank_motion("run-up", start_angle=0.3),
    "linear-motor": CrankMotion("there", (Segment(0.0, 0.3, (0.0, 0.1, 1.5, -3.0)),)),
}
LINEAR = [name for name in MOTIONS if driven(name).linkage.is_linear]
LEVELS = (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION)
BLANK = Record("sample", "base", "there", "", "direct", "", "tuned", "")


def ran(case: Case) -> tuple[Scene, History]:
    scene = case.scene(Channel)
    run = DirectEngine().run(scene, Setting.TUNED)
    assert run.history is not None, run.reason
    return scene, run.history


def deviation(case: Case, scene: Scene, history: History) -> float:
    """Largest deviation of any channel of direct, over its peak."""
    worst = 0.0
    for channel in LEVELS:
        signal = getattr(history, channel.value)
        for number, body in enumerate(scene.bodies):
            true = channel_truth(case, channel, body.name, signal.time)[:, : 3 if scene.can_turn(body) else 2]
            seen = signal.values[:, number, : true.shape[1]]
            worst = max(worst, float(np.max(np.abs(seen - true)) / np.max(np.abs(true))))
    for joint, signal in history.joint_force.items():
        true = channel_truth(case, Channel.JOINT_FORCE, joint, signal.time)
        worst = max(worst, float(np.max(np.abs(signal.values - true)) / np.max(np.abs(true))))
    if history.torque and case.is_prescribed:
        true = channel_truth(case, Channel.TORQUE, "", history.torque.time)
        worst = max(worst, float(np.max(np.abs(history.torque.values - true)) / np.max(np.abs(true))))
    return worst


@pytest.mark.parametrize("name", MOTIONS)
def test_direct_agrees_with_a_prescribed_travel(name):
    case = Case(driven(name), MOTIONS[name])
    case.check_motion()
    assert deviation(case, *ran(case)) < 1e-12


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


@pytest.mark.parametrize("name", MOTIONS)
def test_the_force_of_the_drive_is_found_from_virtual_work_and_from_the_balance_of_the_links(name):
    motion = MOTIONS[name]
    time = np.linspace(0.0, motion.duration, 50)
    speed, acceleration = motion.speed(time), motion.acceleration(time)
    sweep = driven(name).sweep(motion.angle(time))
    virtual = drive_torque(sweep, speed, acceleration)
    assert reactions(sweep, speed, acceleration).torque == pytest.approx(virtual, rel=1e-11, abs=1e-12)
    by_name = evaluate(driven(name), motion.angle(time), ["Mkr"], speed=speed, acceleration=acceleration)
    assert by_name["Mkr"] == pytest.approx(virtual, rel=1e-13)


@pytest.mark.parametrize("name", LINEAR)
def test_the_range_is_said_in_the_length_unit_of_the_file(name):
    mechanism = driven(name)
    limits = mechanism.crank_range()
    low, high = limits.limits
    with pytest.raises(AssemblyError, match=r"mm .*its drive reaches .* mm"):
        limits.check(low, 2.0 * high, "sample")
    with pytest.raises(AssemblyError, match=r"at .* mm:"):
        mechanism.sweep(np.array([high + 1e-3])).poses(mechanism.structure.groups[-1].links[0])
    assert max(mechanism.error_bound()) < 1e-8
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
