"""The methods of exudyn that can be studied: each as asked, of its order, and judged by nobody but the suite."""

import dataclasses
import math
import subprocess
import sys

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.dynamics import reduced
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.judging.jumps import near_jumps
from comparisons.reference.start_state import scene
from engines.contract import Method, Outcome, Setting
from engines.exudyn_adapter.adapter import ExudynEngine
from engines.exudyn_adapter.recipes import SETTINGS, STUDIED
from engines.scene import Channel, Free, Prescribed
from engines.stepping.histories import labelled
from tests.analytic.linkages import mechanism

exudyn = pytest.importorskip("exudyn")

ENGINE = ExudynEngine()
EVERYTHING = frozenset(Channel)
NO_FORCES = EVERYTHING - {Channel.JOINT_FORCE}
METHODS = ENGINE.methods(None)
NAMES = [method.name for method in METHODS]
STEP = 1e-3
ORDER = 0.3  # that an observed order may be off
CLOSE = 1e-9


def _method(name):
    return next(method for method in METHODS if method.name == name)


def _driven(name="juki-mf7923d", regime="run-up-quintic", channels=EVERYTHING, **changes):
    motion = crank_motion(regime, **{"ramp_time": 0.15, "hold_time": 0.03, "start_angle": 0.3, **changes})
    return motion, scene(mechanism(name), Prescribed(motion), channels)


def _free(name="juki-mf7923d", channels=EVERYTHING):
    return scene(mechanism(name), Free(0.01, 0.3), channels, start_angle=0.4)


def _signals(history):
    yield from (signal for _, signal in labelled(history))


def _torque_errors(name, motion, run):
    """Errors over the peak (n,), NaN near jumps of the acceleration."""
    torque = run.history.torque
    sweep = mechanism(name).sweep(motion.angle(torque.time))
    truth = reduced.drive_torque(sweep, motion.speed(torque.time), motion.acceleration(torque.time))
    errors = np.abs(torque.values - truth) / np.abs(truth).max()
    return np.where(near_jumps(torque.time, motion), np.nan, errors)


def test_names_are_unique_and_nothing_is_imported_to_tell_them():
    assert len(set(NAMES)) == len(NAMES)
    assert NAMES[0] == "defaults"
    assert ENGINE.methods(_free()) == METHODS
    script = (
        "import sys; from engines.registry import engine; found = engine('exudyn').methods(None); "
        "print(len(found), 'exudyn' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(len(METHODS)), "False"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("model", [_driven(regime="run-up")[1], _free()], ids=["prescribed", "free"])
def test_every_method_gives_a_finite_history_on_its_clock(name, model):
    run = ENGINE.run_method(model, _method(name), STEP)
    assert run.outcome is Outcome.FINISHED, run.reason
    duration = model.drive.motion.duration if isinstance(model.drive, Prescribed) else model.drive.duration
    for signal in _signals(run.history):
        assert np.all(np.isfinite(signal.values))
        assert np.diff(signal.time).max() <= 2.0 * STEP * (1.0 + CLOSE)  # a load has no sample at a jump
        assert np.diff(signal.time).min() > 0.0
        assert signal.time[-1] == pytest.approx(duration)
    assert run.history.position.time[0] == 0.0
    assert np.diff(run.history.position.time).max() <= STEP * (1.0 + CLOSE)
    assert run.details["method"] == name
    assert run.passes[0] <= STEP * (1.0 + CLOSE)


@pytest.mark.parametrize("name", NAMES)
def test_steps_and_iterations_are_counted(name):
    model = _driven()[1]
    coarse, fine = (ENGINE.run_method(model, _method(name), step) for step in (2e-3, 5e-4))
    ratios = STUDIED[name][1].ratios
    assert len(ratios) == _method(name).runs == len(coarse.passes)
    assert coarse.steps == sum(ratios) * (len(coarse.history.position.time) - 1)
    assert coarse.steps < fine.steps
    assert coarse.steps < coarse.solver_work < fine.solver_work
    assert fine.seconds > 0.0


@pytest.mark.parametrize(
    ("name", "order", "steps"),
    [
        ("trapezoidal", 2, (1e-3, 5e-4)),
        ("trapezoidal x2", 4, (1e-3, 5e-4)),
        ("trapezoidal x3", 6, (2.4e-3, 1.2e-3)),
    ],
)
def test_observed_order_of_convergence(name, order, steps):
    motion, model = _driven("rimoldi-164", channels={Channel.TORQUE}, ramp_time=0.3)
    method = dataclasses.replace(_method(name), effort=1e-13)
    errors = [
        np.nanmax(_torque_errors("rimoldi-164", motion, ENGINE.run_method(model, method, step))) for step in steps
    ]
    observed = math.log(errors[0] / errors[1]) / math.log(steps[0] / steps[1])
    assert observed == pytest.approx(order, abs=ORDER)


def test_the_rule_as_shipped_is_of_second_order_too():
    _, model = _driven("rimoldi-164", channels={Channel.VELOCITY})
    exact = ENGINE.run(model, Setting.BEST).history.velocity
    ends = []
    for step in (1e-3, 5e-4):
        found = ENGINE.run_method(model, _method("defaults"), step).history.velocity
        assert found.time[-1] == pytest.approx(exact.time[-1])
        ends.append(np.abs(found.values[-1] - exact.values[-1]).max())
    assert math.log2(ends[0] / ends[1]) == pytest.approx(2.0, abs=ORDER)


@pytest.mark.parametrize("name", ["defaults", "trapezoidal"])
def test_effort_is_the_tolerance_of_newtons_corrections(name):
    model = _driven()[1]
    method = _method(name)
    loose, tight = (
        ENGINE.run_method(model, dataclasses.replace(method, effort=effort), STEP) for effort in (1e-6, 1e-12)
    )
    assert method.effort_unit == "relative tolerance"
    assert loose.details["tolerance"] == 1e-6
    assert loose.solver_work < tight.solver_work


def test_an_engine_that_gives_up_has_diverged():
    run = ENGINE.run_method(_driven("parallelogram")[1], _method("trapezoidal x2"), STEP)
    assert run.outcome is Outcome.DIVERGED
    assert run.reason
    assert run.history is None


def test_unknown_methods_and_steps_that_are_none_are_misuse():
    with pytest.raises(UnknownNameError, match="leapfrog"):
        ENGINE.run_method(_driven()[1], Method("leapfrog", "not exudyn's"), STEP)
    for step in (0.0, -1e-3, math.inf, math.nan):
        with pytest.raises(LinkproofError, match="step"):
            ENGINE.run_method(_driven()[1], METHODS[0], step)


def test_settings_use_rules_that_can_be_studied():
    rules = {(recipe.damping, recipe.as_shipped) for _, recipe in STUDIED.values()}
    used = {(r.damping, r.as_shipped) for settings in SETTINGS.values() for r in settings.values()}
    assert used <= rules
