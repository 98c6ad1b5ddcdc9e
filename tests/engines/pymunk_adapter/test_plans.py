"""The methods offered for study: each on its clock, of its order, its work counted, and not judged by the adapter."""

import dataclasses
import itertools
import math
import subprocess
import sys

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.dynamics import reduced
from analytic.errors import LinkproofError, UnknownNameError
from analytic.motion.released import free_motion
from comparisons.reference.start_state import scene
from engines.contract import Method, Outcome, Setting
from engines.pymunk_adapter import passes, plans
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.pymunk_adapter.layout import plain_layout
from engines.pymunk_adapter.plans import METHODS, setting_plan
from engines.scene import Channel, Free, Prescribed
from tests.analytic.linkages import mechanism

pytest.importorskip("pymunk")

ENGINE = PymunkEngine()
MOTION = crank_motion("run-up-quintic", ramp_time=0.12, hold_time=0.03, start_angle=0.3)
DRIVEN = scene(mechanism("juki-mf7923d"), Prescribed(MOTION), frozenset(Channel))
LET_GO, SPEED, DURATION = 4.8, 40.0, 0.5  # rad, rad/s and s of a free crank
RELEASED = scene(mechanism("slotted-takeup"), Free(0.0, DURATION), frozenset(Channel), start_angle=LET_GO, speed=SPEED)
BY_NAME = {method.name: method for method in METHODS}

ORDERS = {"centred": 2, "centred x2": 3, "centred x3": 4, "centred x4": 5}
LOOSE_ORDER = 0.4
# Steps of a free crank, s, where others than 1 and 0.5 ms show the order. Of "centred" the terms in h² and h³ have
# opposite signs. Of "centred x4" rounding leaves 1e-12 to 8e-12 rad, as much as its error at 0.5 ms: over 150 to 300
# iterations the order seen from 1 to 0.5 ms lies anywhere between 3.9 and 6.2, from 1.4 to 0.7 ms between 4.7 and 5.1.
FREE_STEPS = {"centred": (2.5e-4, 1.25e-4), "centred x4": (1.4e-3, 7e-4)}
ROUNDING = 1e-12  # s
AMPLE = 200.0  # iterations that leave the order to the step


def _finished(model, method, step):
    run = ENGINE.run_method(model, method, step)
    assert run.outcome is Outcome.FINISHED, run.reason
    return run


def _signals(history):
    named = {channel.value: getattr(history, channel.value) for channel in set(Channel) - {Channel.JOINT_FORCE}}
    return named | dict(history.joint_force)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
@pytest.mark.parametrize(("model", "duration"), [(DRIVEN, MOTION.duration), (RELEASED, DURATION)])
def test_every_method_records_everything_on_a_clock_of_at_most_its_step(model, duration, method):
    step = 0.00213  # goes into neither ramp nor hold
    run = _finished(model, method, step)
    for name, signal in _signals(run.history).items():
        assert np.isfinite(signal.values).all(), name
        gaps = np.diff(signal.time)
        assert gaps.min() > 0.5 * step, name
        assert gaps.max() < step * (1.0 + 1e-9), name
        assert signal.time[0] <= step, name
        assert duration - step <= signal.time[-1] <= duration + ROUNDING, name
    assert run.details["method"] == method.name
    assert run.seconds > 0.0
    assert run.setup_seconds > 0.0


def test_segments_of_a_motion_are_cut_into_equal_steps():
    run = _finished(DRIVEN, BY_NAME["centred x2"], 0.00213)
    time = run.history.position.time
    ramp = MOTION.segments[0].end
    assert np.abs(time - ramp).min() < ROUNDING
    for stretch in (time[time <= ramp + ROUNDING], time[time >= ramp - ROUNDING]):
        assert np.ptp(np.diff(stretch)) < ROUNDING


def test_methods_come_defaults_first_and_under_names_of_their_own():
    names = [method.name for method in ENGINE.methods(DRIVEN)]
    assert names[0] == "defaults"
    assert len(set(names)) == len(names) == 1 + len(ORDERS)
    assert ENGINE.methods(RELEASED) == ENGINE.methods(DRIVEN)
    assert all(method.effort is None and method.effort_unit == "iterations" for method in METHODS)
    assert [method.levels for method in METHODS] == [1, 1, 2, 3, 4]


def test_asking_for_the_methods_imports_no_engine():
    script = (
        "import sys; from engines.pymunk_adapter.adapter import PymunkEngine; PymunkEngine().methods(None); "
        "print('pymunk' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


# -- order of convergence ----------------------------------------------------------------------------------------------


def _torque_error(name, method, step):
    closed = mechanism(name)
    model = scene(closed, Prescribed(MOTION), {Channel.TORQUE})
    torque = _finished(model, method, step).history.torque
    sweep = closed.sweep(MOTION.angle(torque.time))
    truth = reduced.drive_torque(sweep, MOTION.speed(torque.time), MOTION.acceleration(torque.time))
    return np.abs(torque.values - truth).max()


def _observed(errors, steps):
    return [
        math.log(a / b) / math.log(one / other)
        for (a, b), (one, other) in zip(itertools.pairwise(errors), itertools.pairwise(steps), strict=True)
    ]


@pytest.mark.parametrize(("name", "order"), ORDERS.items())
@pytest.mark.parametrize("linkage", ["juki-mf7923d", "rimoldi-164"])
def test_order_of_convergence_of_the_torque(linkage, name, order):
    method = dataclasses.replace(BY_NAME[name], effort=AMPLE)
    steps = (1.6e-3, 8e-4)
    (observed,) = _observed([_torque_error(linkage, method, step) for step in steps], steps)
    assert observed == pytest.approx(order, abs=LOOSE_ORDER)


@pytest.mark.parametrize(("name", "order"), ORDERS.items())
def test_order_of_convergence_of_a_free_crank(name, order):
    closed = mechanism("slotted-takeup")
    truth = free_motion(closed, torque=0.0, start_angle=LET_GO, start_speed=SPEED, duration=DURATION)
    crank = [body.name for body in RELEASED.bodies].index(RELEASED.crank)
    steps = FREE_STEPS.get(name, (1e-3, 5e-4))
    errors = []
    for step in steps:
        run = _finished(RELEASED, dataclasses.replace(BY_NAME[name], effort=AMPLE), step)
        position = run.history.position
        errors.append(np.abs(position.values[:, crank, 2] - truth.angle(position.time)).max())
    (observed,) = _observed(errors, steps)
    assert observed == pytest.approx(order, abs=LOOSE_ORDER)


def test_defaults_are_of_first_order_and_do_not_tell_the_sign_of_the_torque():
    closed = mechanism("juki-mf7923d")
    truth = lambda time: closed.sweep(MOTION.angle(time))  # noqa: E731
    steps, errors = (4e-4, 2e-4), []
    bar = [body.name for body in DRIVEN.bodies].index("needle_bar")
    for step in steps:
        history = _finished(DRIVEN, dataclasses.replace(METHODS[0], effort=AMPLE), step).history
        place = np.stack(truth(history.position.time).centre("needle_bar"), axis=-1)
        errors.append(np.abs(history.position.values[:, bar, :2] - place).max())
        assert history.torque.values.min() >= 0.0
    (observed,) = _observed(errors, steps)
    assert observed == pytest.approx(1.0, abs=LOOSE_ORDER)


# -- work --------------------------------------------------------------------------------------------------------------


def test_the_work_of_defaults_is_iterations_times_constraints_in_every_step():
    constraints = len(plain_layout(DRIVEN).holds) + 1  # and the motor
    run = _finished(DRIVEN, METHODS[0], 1e-3)
    assert run.steps == 150
    assert run.solver_work == run.steps * 10 * constraints  # pymunk's default iterations
    thrice = _finished(DRIVEN, dataclasses.replace(METHODS[0], effort=30), 1e-3)
    assert thrice.solver_work == 3 * run.solver_work
    assert thrice.details["iterations"] == 30


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
@pytest.mark.parametrize("model", [DRIVEN, RELEASED])
def test_work_grows_with_steps_and_iterations(model, method):
    few, many = (_finished(model, dataclasses.replace(method, effort=effort), 1e-3) for effort in (40.0, 80.0))
    fine = _finished(model, dataclasses.replace(method, effort=40.0), 2.5e-4)
    assert many.solver_work == 2 * few.solver_work > 0
    assert many.steps == few.steps
    assert fine.steps > few.steps
    assert fine.solver_work > few.solver_work


def test_without_an_effort_the_adapter_takes_as_many_iterations_as_the_linkage_needs():
    hard = scene(mechanism("shaper"), Prescribed(MOTION), {Channel.TORQUE})
    easy, many = (_finished(model, BY_NAME["centred"], 1e-3).details["iterations"] for model in (DRIVEN, hard))
    assert 10 * easy < many


@pytest.mark.parametrize("setting", Setting)
@pytest.mark.parametrize("model", [DRIVEN, RELEASED])
def test_settings_tell_their_work_too(model, setting):
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED
    assert run.solver_work > 10 * run.steps > 0


# -- nobody judges a method --------------------------------------------------------------------------------------------


def test_what_too_few_iterations_make_of_a_linkage_is_handed_back_as_it_is():
    hard = scene(mechanism("two-crank-takeup"), Prescribed(MOTION), {Channel.POSITION, Channel.TORQUE})
    torn = _finished(hard, dataclasses.replace(BY_NAME["centred"], effort=1), 1e-3).history
    truth = MOTION.angle(torn.position.time)
    crank = [body.name for body in hard.bodies].index(hard.crank)
    assert np.abs(torn.position.values[:, crank, 2] - truth).max() < 1e-6  # the motor is visited last
    closed = mechanism("two-crank-takeup").sweep(truth)
    for number, body in enumerate(hard.bodies):
        off = np.abs(torn.position.values[:, number, :2] - np.stack(closed.centre(body.name), axis=-1)).max()
        if off > 0.01:
            return
    pytest.fail("the linkage held together after all")


def test_a_setting_ends_where_a_method_goes_on(monkeypatch):
    hard = scene(mechanism("two-crank-takeup"), Prescribed(MOTION), {Channel.TORQUE})
    tuned = setting_plan(hard.drive, Setting.TUNED)
    monkeypatch.setattr(plans, "PRESCRIBED", {Setting.TUNED: dataclasses.replace(tuned, iterations=1)})
    run = ENGINE.run(hard, Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert run.history is None
    assert run.steps > 0
    assert run.solver_work > run.steps
    assert run.seconds > 0.0
    assert run.setup_seconds > 0.0
    assert run.details["iterations"] == 1


@pytest.mark.parametrize("broken", [math.inf, math.nan])
@pytest.mark.parametrize("name", ["centred", "centred x3"])
def test_a_motion_that_is_no_longer_finite_is_diverged_with_what_it_cost(monkeypatch, name, broken):
    means = passes.mean_speeds
    monkeypatch.setattr(passes, "mean_speeds", lambda *a: np.where(np.arange(a[3]) < 50, means(*a), broken))
    run = ENGINE.run_method(DRIVEN, BY_NAME[name], 1e-3)
    assert run.outcome is Outcome.DIVERGED
    assert "not finite" in run.reason
    assert run.steps > 100
    assert run.seconds > 0.0


def test_impossible_data_are_refused_as_by_a_setting():
    bodies = tuple(dataclasses.replace(body, mass=0.0) for body in DRIVEN.bodies)
    run = ENGINE.run_method(dataclasses.replace(DRIVEN, bodies=bodies), METHODS[1], 1e-3)
    assert run.outcome is Outcome.UNSUPPORTED
    assert "mass 0" in run.reason


def test_a_setting_is_a_method_at_the_step_and_effort_it_has_chosen():
    tuned = ENGINE.run(DRIVEN, Setting.TUNED)
    chosen = dataclasses.replace(BY_NAME["centred x4"], effort=tuned.details["iterations"])
    assert tuned.details["ratios"] == "1 3 5 7"
    same = _finished(DRIVEN, chosen, tuned.details["sample_step"])
    assert (same.steps, same.solver_work) == (tuned.steps, tuned.solver_work)
    found = _signals(same.history)
    for name, signal in _signals(tuned.history).items():
        assert np.array_equal(signal.values, found[name].values), name


# -- misuse ------------------------------------------------------------------------------------------------------------


def test_an_unknown_method_is_named_beside_the_known_ones():
    with pytest.raises(UnknownNameError, match=r"unknown method of pymunk 'centered'.*known are centred"):
        ENGINE.run_method(DRIVEN, Method("centered", "a slip of the pen"), 1e-3)


@pytest.mark.parametrize("step", [0.0, -1e-3, math.nan, math.inf])
def test_a_step_that_is_none_is_refused(step):
    with pytest.raises(LinkproofError, match="expected a positive finite number of seconds"):
        ENGINE.run_method(DRIVEN, METHODS[1], step)


@pytest.mark.parametrize("effort", [0.0, -3.0, math.nan, math.inf])
def test_an_effort_that_is_none_is_refused(effort):
    for method in METHODS:
        with pytest.raises(LinkproofError, match="expected at least 1 iteration"):
            ENGINE.run_method(DRIVEN, dataclasses.replace(method, effort=effort), 1e-3)
