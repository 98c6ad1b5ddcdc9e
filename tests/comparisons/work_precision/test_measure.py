"""One point measured once in a real engine: times, errors by quantity, and what goes wrong told."""

import pickle

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.case import Case, own_case
from comparisons.runs.failures import AdapterError
from comparisons.work_precision.measure import chosen, longest_step, measure
from engines.contract import Method, Setting
from engines.registry import engine
from engines.scene import Channel

CASE = Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up-quintic", hold_time=0.0, ramp_time=0.2))
PICKLED = pickle.dumps(CASE)
EXACT = Method("exact", "")
FOUR = ("Mkr", "Jeq", "phi", "joint_force")


def test_an_exact_method_has_errors_of_round_off_in_every_quantity():
    taken = measure(PICKLED, "direct", EXACT, 24.0, FOUR, with_errors=True)
    assert taken.outcome == "finished"
    assert set(taken.errors) == set(FOUR)
    assert all(error.error_rms <= error.error_max < 1e-12 and error.peak > 0.0 for error in taken.errors.values())
    assert taken.errors["Mkr"].unit == "N m"
    assert min(taken.seconds, taken.steps, taken.calibration) > 0
    assert min(taken.setup, taken.readout) >= 0.0


def test_the_worst_joint_stands_for_all():
    pytest.importorskip("pymunk")
    method = Method("centred", "")
    taken = measure(PICKLED, "pymunk", method, 24.0, FOUR, with_errors=True)
    scene = CASE.scene(frozenset(Channel))
    history = engine("pymunk").run_method(scene, method, longest_step(CASE, 24.0)).history
    time = history.joint_force["A"].time
    errors = [
        np.linalg.norm(history.joint_force[name].values - truth.T, axis=1).max() / np.linalg.norm(truth, axis=0).max()
        for name, truth in CASE.at(time).joint_forces.items()
    ]
    assert len(errors) > 2
    assert taken.errors["joint_force"].error_max == pytest.approx(max(errors), rel=1e-9)
    assert max(errors) > 1.5 * min(errors) > 1e-6
    assert [one.name for one in chosen(CASE, ("joint_force:A",))["joint_force:A"]] == ["joint_force:A"]


def test_a_repeat_takes_no_errors():
    taken = measure(PICKLED, "direct", Setting.TUNED, None, FOUR, with_errors=False)
    assert (taken.outcome, dict(taken.errors)) == ("finished", {})


def test_what_an_engine_raises_is_told():
    with pytest.raises(AdapterError, match="direct raised UnknownNameError"):
        measure(PICKLED, "direct", Method("no such", ""), 24.0, ("Mkr",), with_errors=True)


def test_a_step_is_a_share_of_the_fastest_turn():
    assert longest_step(CASE, 100.0) * 100.0 * CASE.motion.peak_speed == pytest.approx(2.0 * np.pi)


def test_a_released_crank_has_no_torque_to_judge_and_a_phase_instead():
    linkage = load("slotted-takeup")
    case = own_case(Mechanism(linkage), next(one for one in linkage.regimes if one.name == "free"))
    assert set(chosen(case, FOUR)) == {"Jeq", "phi", "joint_force"}
