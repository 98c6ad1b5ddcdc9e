"""The one way of the direct engine, at samples of the caller's."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.dynamics import reduced
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.reference.start_state import scene
from engines.contract import Method, Outcome, Setting
from engines.direct_adapter.adapter import METHODS, DirectEngine
from engines.direct_adapter.equations import Equations
from engines.scene import Channel, Free, Prescribed
from tests.analytic.linkages import mechanism

ENGINE = DirectEngine()
EVERYTHING = frozenset(Channel)
(EXACTLY,) = METHODS
STEP = 2e-3
SAME = 1e-12
EXACT = 1e-13  # of the torque's peak


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


def test_every_setting_is_the_method_as_an_exact_solution_has_no_defaults_and_no_floor_below():
    assert ENGINE.methods(_free()) == METHODS
    model = _driven()[1]
    torques = [ENGINE.run(model, setting).history.torque for setting in Setting]
    spacing = torques[0].time[1]
    torques.append(ENGINE.run_method(model, EXACTLY, spacing).history.torque)
    assert all(np.array_equal(torque.values, torques[0].values) for torque in torques)


@pytest.mark.parametrize("model", [_driven(regime="run-up")[1], _free()], ids=["prescribed", "free"])
def test_the_method_gives_a_finite_history_on_its_clock(model):
    run = ENGINE.run_method(model, EXACTLY, STEP)
    assert run.outcome is Outcome.FINISHED, run.reason
    duration = model.drive.motion.duration if isinstance(model.drive, Prescribed) else model.drive.duration
    history = run.history
    signals = [history.position, history.velocity, history.acceleration, history.torque]
    for signal in (*signals, *history.joint_force.values()):
        assert signal.time == pytest.approx(np.linspace(0.0, duration, round(duration / STEP) + 1))
        assert np.all(np.isfinite(signal.values))
    assert run.details["method"] == EXACTLY.name


def test_steps_and_solves_are_counted():
    coarse, fine = (ENGINE.run_method(_driven()[1], EXACTLY, step) for step in (STEP, STEP / 2.0))
    assert 0 < coarse.steps < fine.steps
    assert coarse.steps <= coarse.solver_work < fine.solver_work


def test_exact_instants_do_not_depend_on_their_spacing():
    driven, model = _driven("rimoldi-164")
    coarse, fine = (ENGINE.run_method(model, EXACTLY, step) for step in (4e-3, 1e-3))
    assert max(_torque_error("rimoldi-164", driven, run) for run in (coarse, fine)) <= EXACT
    free = [ENGINE.run_method(_free(), EXACTLY, step).history.position.values[-1] for step in (4e-3, 1e-3)]
    assert np.abs(free[0] - free[1]).max() <= SAME


def test_the_linear_systems_of_an_instant_are_counted_one_by_one():
    model = _driven()[1]
    only_positions = scene(mechanism("juki-mf7923d"), model.drive, {Channel.POSITION})
    assert Equations(model).solves == 0
    all_of_it, positions = (ENGINE.run_method(m, EXACTLY, STEP) for m in (model, only_positions))
    # Levers, bends and reactions of every instant come on top.
    assert all_of_it.solver_work - positions.solver_work == 3 * positions.steps


def test_unknown_methods_and_steps_that_are_none_are_misuse():
    with pytest.raises(UnknownNameError, match="leapfrog"):
        ENGINE.run_method(_driven()[1], Method("leapfrog", "not ours"), STEP)
    for step in (0.0, -1e-3, math.inf, math.nan):
        with pytest.raises(LinkproofError, match="step"):
            ENGINE.run_method(_driven()[1], EXACTLY, step)
