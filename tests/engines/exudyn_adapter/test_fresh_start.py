"""A state to start anew from: exudyn's static solver against the closed form."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.exudyn_adapter.adapter import ExudynEngine
from engines.exudyn_adapter.recipes import BEST, TUNED
from engines.scene import Channel, Prescribed
from engines.stepping.own_units import own_units, scaled
from tests.analytic.linkages import mechanism
from tests.engines.newton_euler import true_motion

pytest.importorskip("exudyn")
loop = pytest.importorskip("engines.exudyn_adapter.loop")

ENGINE = ExudynEngine()
EXACT = (1e-13, 1e-11, 1e-8)  # of the largest coordinate, velocity and acceleration
SMALL, RINGING = 1e-3, 1e-1  # errors over the peak
OFF = 1e-3  # of the unit of length and rad that a state is moved off the joints


def _motion(**changes):
    return crank_motion("run-up", **{"ramp_time": 0.15, "hold_time": 0.05, "start_angle": 0.3, **changes})


def _model(name, motion):
    wanted = scene(mechanism(name), Prescribed(motion), set(Channel))
    units = own_units(wanted)
    return ENGINE.build(scaled(wanted, units), TUNED), units


def _part(start, segment):
    return {"start": start, "segment": (segment.start, segment.coefficients)}


def _truth(name, motion, model, units, time):
    """Displacements from the start and their derivatives in exudyn's order, in the model's units."""
    unit = np.array([units.length, units.length, 1.0])
    states = [part / unit for part in true_motion(mechanism(name), motion, np.array([0.0, time]))]
    return (states[0][1] - states[0][0]).ravel(), states[1][1].ravel(), states[2][1].ravel()


@pytest.mark.parametrize("name", ["juki-mf7923d", "rimoldi-164", "slotted-takeup", "moving-guides", "scotch-yoke"])
def test_a_state_near_the_joints_becomes_the_closed_forms(name):
    motion = _motion()
    for segment, time in zip(motion.segments, (0.11, motion.segments[1].start), strict=True):
        model, units = _model(name, motion)
        # A body without inertia has no angle of its own.
        bodies = scene(mechanism(name), Prescribed(motion), set(Channel)).bodies
        turns = np.array([(True, True, body.inertia is not None) for body in bodies]).ravel()
        truth = [np.where(turns, part, 0.0) for part in _truth(name, motion, model, units, time)]
        moved = truth[0] + OFF * np.random.default_rng(1).uniform(-1.0, 1.0, len(truth[0]))
        found = loop.closed_state(model, _part(time, segment), (moved, truth[1], truth[2]))
        assert found is not None
        for got, wanted, exact in zip(found, truth, EXACT, strict=True):
            assert np.abs(got - wanted)[turns].max() <= exact * max(1.0, np.abs(wanted).max())


def test_no_state_is_taken_that_is_another_assembly_or_undetermined():
    motion = _motion()
    model, units = _model("rimoldi-164", motion)
    position, *rates = _truth("rimoldi-164", motion, model, units, 0.1)
    part = _part(0.1, motion.segments[0])
    far = position + np.random.default_rng(2).uniform(-2.0, 2.0, len(position))
    assert loop.closed_state(model, part, (far, *rates)) is None
    dead = crank_motion("constant-speed", start_angle=math.pi / 2.0)
    model, units = _model("parallelogram", dead)
    time = 0.5 * math.pi / dead.peak_speed  # at 180°, where the other assembly mode branches off
    reached = _truth("parallelogram", dead, model, units, time * (1.0 - 1e-4))
    assert loop.closed_state(model, _part(time, dead.segments[0]), reached) is None


def test_samples_between_two_parts_are_the_engines_own(monkeypatch):
    """What a part is started from is not handed back, however wrong it is."""
    motion, shift = crank_motion("run-up-quintic", ramp_time=0.1), 1e-3
    model = scene(mechanism("juki-mf7923d"), Prescribed(motion), set(Channel))
    whole = loop.closed_state

    def shifted(*given):
        return tuple(part + shift for part in whole(*given))

    plain = ENGINE.run(model, Setting.BEST)
    monkeypatch.setattr(loop, "closed_state", shifted)
    moved = ENGINE.run(model, Setting.BEST)
    assert plain.outcome is moved.outcome is Outcome.FINISHED
    first = BEST.parts(scaled(model, own_units(model)))[0].samples
    for one, other in (
        (plain.history.position, moved.history.position),
        (plain.history.velocity, moved.history.velocity),
    ):
        assert np.array_equal(one.values[: first + 1], other.values[: first + 1])
        assert not np.array_equal(one.values[first + 1], other.values[first + 1])


def test_fresh_starts_are_said():
    motion = _motion()
    run = ENGINE.run(scene(mechanism("juki-mf7923d"), Prescribed(motion), ()), Setting.TUNED)
    parts = TUNED.parts(scene(mechanism("juki-mf7923d"), Prescribed(motion), ()))
    assert run.details["fresh_starts"] == len(parts) - 1 > 0
    assert "fresh_starts_left_out" not in run.details


def test_a_start_that_is_not_found_is_left_out_and_said(monkeypatch):
    monkeypatch.setattr(loop, "closed_state", lambda *_: None)
    motion = crank_motion("run-up-quintic", ramp_time=0.1)
    run = ENGINE.run(scene(mechanism("juki-mf7923d"), Prescribed(motion), ()), Setting.TUNED)
    assert run.outcome is Outcome.FINISHED
    assert run.details["fresh_starts_left_out"] == run.details["parts"] - 1
    assert "fresh_starts" not in run.details


def test_without_consistent_accelerations_the_trapezoidal_rule_rings(monkeypatch):
    motion = _motion(hold_time=0.06)
    model = scene(mechanism("juki-mf7923d"), Prescribed(motion), {Channel.ACCELERATION})
    whole, errors = loop.closed_state, []
    trapezoidal = next(method for method in ENGINE.methods(model) if method.name == "trapezoidal")
    for wrong in (0.0, 1.0):

        def without(*given, wrong=wrong):
            position, velocity, acceleration = whole(*given)
            return position, velocity, (1.0 - wrong) * acceleration

        monkeypatch.setattr(loop, "closed_state", without)
        signal = ENGINE.run_method(model, trapezoidal, 1e-4).history.acceleration
        truth = true_motion(mechanism("juki-mf7923d"), motion, signal.time)[2]
        late = signal.time > motion.duration - 0.02
        errors.append(np.abs(signal.values - truth)[late].max() / np.abs(truth).max())
    assert errors[0] < SMALL
    assert errors[1] > RINGING
