"""What exudyn alone has: samples at a jump, change points, and starts of parts on states that fit the joints."""

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from engines.contract import Setting
from engines.exudyn_adapter.adapter import BEST, TUNED, ExudynEngine
from engines.stepping.own_units import own_units, scaled
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import crank_number, driven, errors_of, history_of, run_of

pytest.importorskip("exudyn")

ENGINE = ExudynEngine()
STILL = 3e-6  # rad, by which the coupler of a parallelogram turns, or a crank is off its motion


def _scene(name="juki-mf7923d", regime="run-up-quintic", **changes):
    return driven(
        mechanism(name), crank_motion(regime, **{"ramp_time": 0.05, "hold_time": 0.02, "start_angle": 0.3, **changes})
    )


def test_samples_at_a_jump_and_angles_beyond_a_turn():
    model = _scene(regime="run-up", ramp_time=0.12)  # a turn before the jump, which the next part starts without
    history, motion = history_of(ENGINE, model), model.drive.motion
    for signal, has_both in (
        (history.position, True),
        (history.velocity, True),
        (history.acceleration, False),  # the start's is given, and at a jump it has two values
        (history.torque, False),  # the multipliers belong to steps
        *((force, False) for force in history.joint_force.values()),
    ):
        assert (signal.time[0] == 0.0) == np.isclose(signal.time, motion.segments[0].end).any() == has_both
        assert signal.time[-1] == pytest.approx(motion.duration)
    angle = history.position.values[:, crank_number(model), 2]
    assert np.abs(angle - motion.angle(history.position.time)).max() < STILL


@pytest.mark.parametrize("setting", [Setting.NAIVE, Setting.TUNED])
def test_a_parallelogram_passes_its_change_points(setting):
    model = _scene("parallelogram", "constant-speed", ramp_time=0.07)
    number = [body.name for body in model.bodies].index("coupler")
    assert np.ptp(history_of(ENGINE, model, setting).position.values[:, number, 2]) < STILL


def test_a_part_that_starts_with_an_acceleration_is_as_good_as_the_others():
    motion = CrankMotion("own", (Segment(0.0, 0.03, (0.3, 0.0, 1000.0)), Segment(0.03, 0.06, (1.2, 60.0, 300.0))))
    linkage = mechanism("juki-mf7923d")
    assert max(errors_of(run_of(ENGINE, linkage, motion, Setting.BEST), linkage, motion).values()) < 1e-6


loop = pytest.importorskip("engines.exudyn_adapter.loop")


def test_no_state_far_from_the_one_that_was_reached_is_taken():
    """It may be that of another assembly."""
    model = _scene("rimoldi-164", regime="run-up")
    world, segment = ENGINE.build(scaled(model, own_units(model)), TUNED), model.drive.motion.segments[0]
    far = np.random.default_rng(2).uniform(-2.0, 2.0, 3 * len(model.bodies))
    part = {"start": 0.04, "segment": (segment.start, segment.coefficients)}
    assert loop.closed_state(world, part, (far, 0.0 * far, 0.0 * far)) is None


def test_samples_between_two_parts_are_the_engines_own(monkeypatch):
    """The state that a part starts from is not handed back, however wrong it is."""
    model = driven(mechanism("juki-mf7923d"), crank_motion("run-up-quintic", ramp_time=0.1))
    closed, plain = loop.closed_state, history_of(ENGINE, model, Setting.BEST)
    monkeypatch.setattr(loop, "closed_state", lambda *given: tuple(part + 1e-3 for part in closed(*given)))
    moved = history_of(ENGINE, model, Setting.BEST)
    first = BEST.parts(scaled(model, own_units(model)))[0].samples
    for channel in ("position", "velocity"):
        right, wrong = getattr(plain, channel).values, getattr(moved, channel).values
        assert np.array_equal(right[: first + 1], wrong[: first + 1])
        assert not np.array_equal(right[first + 1], wrong[first + 1])
