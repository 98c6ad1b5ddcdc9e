"""The ways of the direct engine that can be studied: fixed Runge-Kutta steps as asked, and exact instants."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.dynamics import reduced
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.reference.start_state import scene
from engines.contract import Method, Outcome, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.direct_adapter.assembly import UnsolvableError
from engines.direct_adapter.equations import Equations
from engines.direct_adapter.motion import motion
from engines.direct_adapter.recipes import METHODS, RungeKutta
from engines.scene import Channel, Free, Prescribed
from tests.analytic.linkages import mechanism

ENGINE = DirectEngine()
EVERYTHING = frozenset(Channel)
NAMES = [method.name for method in METHODS]
STEP = 2e-3
ORDER = 0.3  # that an observed order may be off
SAME = 1e-12
EXACT = 1e-13  # of the torque's peak


def _method(name):
    return next(method for method in METHODS if method.name == name)


def _driven(name="juki-mf7923d", regime="run-up-quintic", **changes):
    driven = crank_motion(regime, **{"ramp_time": 0.15, "hold_time": 0.03, "start_angle": 0.3, **changes})
    return driven, scene(mechanism(name), Prescribed(driven), EVERYTHING)


def _free():
    return scene(mechanism("juki-mf7923d"), Free(0.01, 0.3), EVERYTHING, start_angle=0.4)


def _torque_error(name, driven, run):
    torque = run.history.torque
    sweep = mechanism(name).sweep(driven.angle(torque.time))
    truth = reduced.drive_torque(sweep, driven.speed(torque.time), driven.acceleration(torque.time))
    return np.abs(torque.values - truth).max() / np.abs(truth).max()


def test_names_are_unique_and_the_first_is_the_newcomers():
    assert len(set(NAMES)) == len(NAMES)
    assert ENGINE.methods(_free()) == METHODS
    naive = ENGINE.run(_driven()[1], Setting.NAIVE)
    studied = ENGINE.run_method(_driven()[1], METHODS[0], naive.details["step_s"])
    assert np.array_equal(naive.history.torque.values, studied.history.torque.values)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("model", [_driven(regime="run-up")[1], _free()], ids=["prescribed", "free"])
def test_every_method_gives_a_finite_history_on_its_clock(name, model):
    run = ENGINE.run_method(model, _method(name), STEP)
    assert run.outcome is Outcome.FINISHED, run.reason
    duration = model.drive.motion.duration if isinstance(model.drive, Prescribed) else model.drive.duration
    history = run.history
    signals = [history.position, history.velocity, history.acceleration, history.torque]
    for signal in (*signals, *history.joint_force.values()):
        assert signal.time == pytest.approx(np.linspace(0.0, duration, round(duration / STEP) + 1))
        assert np.all(np.isfinite(signal.values))
    assert run.details["method"] == name


@pytest.mark.parametrize("name", NAMES)
def test_steps_and_solves_are_counted(name):
    coarse, fine = (ENGINE.run_method(_driven()[1], _method(name), step) for step in (STEP, STEP / 2.0))
    assert 0 < coarse.steps < fine.steps
    assert coarse.steps <= coarse.solver_work < fine.solver_work


def test_runge_kutta_solves_four_systems_a_step_and_is_of_fourth_order():
    runs, errors = [], []
    for step in (2e-3, 1e-3):
        driven, model = _driven("rimoldi-164")
        runs.append(ENGINE.run_method(model, METHODS[0], step))
        errors.append(_torque_error("rimoldi-164", driven, runs[-1]))
    assert runs[0].solver_work == 4 * runs[0].steps + 1
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=ORDER)


@pytest.mark.parametrize("name", ["exact", "exact, extended"])
def test_exact_instants_do_not_depend_on_their_spacing(name):
    driven, model = _driven("rimoldi-164")
    coarse, fine = (ENGINE.run_method(model, _method(name), step) for step in (4e-3, 1e-3))
    assert max(_torque_error("rimoldi-164", driven, run) for run in (coarse, fine)) <= EXACT
    free = [ENGINE.run_method(_free(), _method(name), step).history.position.values[-1] for step in (4e-3, 1e-3)]
    assert np.abs(free[0] - free[1]).max() <= SAME


def test_the_linear_systems_of_an_instant_are_counted_one_by_one():
    model = _driven()[1]
    only_positions = scene(mechanism("juki-mf7923d"), model.drive, {Channel.POSITION})
    assert Equations(model).solves == 0
    all_of_it, positions = (ENGINE.run_method(m, _method("exact"), STEP) for m in (model, only_positions))
    # Levers, bends and reactions of every instant come on top.
    assert all_of_it.solver_work - positions.solver_work == 3 * positions.steps


def test_joints_that_drift_apart_are_handed_back_to_be_judged_from_outside():
    model = _driven("rimoldi-164", "run-up")[1]
    with pytest.raises(UnsolvableError, match="drifted apart"):
        motion(Equations(model), RungeKutta(STEP, largest_gap=SAME))
    run = ENGINE.run_method(model, METHODS[0], STEP)
    assert run.outcome is Outcome.FINISHED, run.reason
    assert run.history is not None


def test_a_motion_that_is_no_number_any_more_has_diverged():
    run = ENGINE.run_method(_driven("near-toggle", "run-up", ramp_time=0.6)[1], METHODS[0], 1e-3)
    assert run.outcome is Outcome.DIVERGED
    assert "no number" in run.reason


def test_unknown_methods_and_steps_that_are_none_are_misuse():
    with pytest.raises(UnknownNameError, match="leapfrog"):
        ENGINE.run_method(_driven()[1], Method("leapfrog", "not ours"), STEP)
    for step in (0.0, -1e-3, math.inf, math.nan):
        with pytest.raises(LinkproofError, match="step"):
            ENGINE.run_method(_driven()[1], METHODS[0], step)
