"""What the driver does for an adapter, on an engine made up for it: its samples are of second order in the step."""

import dataclasses
from typing import ClassVar

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from analytic.description.crank_motion import crank_motion
from analytic.description.law import FULL_TURN, Law
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.motion.case import scene
from engines.contract import Abilities, History, Origin, Outcome, ReadOut, Setting, Signal
from engines.scene import Channel, Free, Prescribed, SliderJoint
from engines.shared_loop import law_values
from engines.stepping.stepped_engine import Recipe, SteppedEngine, plain_law
from tests.analytic.linkages import mechanism

MOTION = crank_motion("run-up", ramp_time=0.06, hold_time=0.02)
PEAK = 3.0  # N m, of the torque in SI
ERROR = 5e5  # of the peak, times the square of the step


class MadeUp(SteppedEngine):
    """Its torque is a constant with an error; its world is the scene, by which it is known what was built."""

    name = package = "numpy"  # installed wherever this runs
    effort_unit = "iterations"
    abilities = Abilities(
        {Channel.POSITION: ReadOut("place"), Channel.TORQUE: ReadOut("torque")},
        drives=frozenset({Prescribed, Free}), joints=frozenset({SliderJoint}), loads=frozenset(),
    )  # fmt: skip
    settings: ClassVar = {
        Prescribed: {
            Setting.TUNED: Recipe(steps_per_turn=50, ratios=(3,)),
            Setting.BEST: Recipe(steps_per_turn=50, ratios=(1, 3)),
        },
        Free: {Setting.TUNED: Recipe(steps_per_turn=40)},
    }
    studied: ClassVar = {"plain": ("one run", Recipe(effort=20.0))}

    def __init__(self):
        self.built, self.courses = [], []

    def build(self, scene, recipe):
        self.built.append(scene)
        return scene

    def follow(self, world, course):
        self.courses.append(course)
        time = np.concatenate([np.linspace(p.start, p.end, p.samples + 1)[:-1] for p in course.parts])
        step = max(part.step for part in course.parts) / course.ratio
        size = max(np.hypot(*pin.first_anchor) for pin in world.pins)  # one in the scene's own units
        unit = PEAK / 0.054**2 * size**2
        torque = Signal(time, np.full(len(time), unit * (1.0 + ERROR * step**2)))
        position = Signal(time, np.zeros((len(time), len(world.bodies), 3)))
        offered = {Channel.TORQUE: {"torque": torque}, Channel.POSITION: {"position": position}}
        return History(**{name: value for c in course.channels for name, value in offered[c].items()})


def _model(drive=None, channels=frozenset(Channel)):
    return scene(mechanism("juki-mf7923d"), drive or Prescribed(MOTION), channels)


@pytest.fixture
def engine():
    return MadeUp()


def test_one_run_is_read_and_several_are_extrapolated_to_what_no_run_has(engine):
    one, several = engine.run(_model(), Setting.TUNED), engine.run(_model(), Setting.BEST)
    assert (one.history.torque.origin, several.history.torque.origin) == (Origin.READ, Origin.EXTRAPOLATED)
    assert len(one.passes) == 1
    assert several.passes[0] == pytest.approx(3.0 * several.passes[1])
    assert np.ptp(several.history.torque.values) == 0.0
    exact = several.history.torque.values[0]
    assert one.history.torque.values[0] / exact - 1.0 == pytest.approx(ERROR * one.passes[0] ** 2)


def test_what_was_computed_stays_so_however_many_runs_it_is_made_of(engine):
    follow = engine.follow
    engine.follow = lambda *given: _computed(follow(*given))
    history = engine.run(_model(), Setting.BEST).history
    assert (history.torque.origin, history.position.origin) == (Origin.COMPUTED, Origin.EXTRAPOLATED)


def _computed(history):
    return dataclasses.replace(history, torque=dataclasses.replace(history.torque, origin=Origin.COMPUTED))


def test_steps_are_those_of_the_peak_speed_and_parts_begin_at_kinks(engine):
    run = engine.run(_model(), Setting.TUNED)
    (course,) = engine.courses
    turn = 2.0 * np.pi / MOTION.peak_speed
    assert [(part.start, part.end) for part in course.parts] == [(0.0, 0.06), (0.06, 0.08)]
    assert max(part.step for part in course.parts) == pytest.approx(turn / 50, rel=0.05)
    assert run.steps == 3 * sum(part.samples for part in course.parts)
    assert run.details["parts"] == 2


def test_only_channels_that_are_asked_for_and_offered_are_recorded(engine):
    engine.run(_model(), Setting.TUNED)
    engine.run(_model(channels={Channel.VELOCITY, Channel.POSITION}), Setting.TUNED)
    engine.run(_model(Free(0.1, 0.05, 80.0)), Setting.TUNED)
    offered = {Channel.POSITION, Channel.TORQUE}
    assert [course.channels for course in engine.courses] == [offered, {Channel.POSITION}, {Channel.POSITION}]


def test_what_is_not_offered_is_unsupported_with_the_reason(engine):
    assert "no setting 'naive'" in engine.run(_model(), Setting.NAIVE).reason
    run = engine.run(scene(mechanism("scotch-yoke"), Prescribed(MOTION), {Channel.POSITION}), Setting.TUNED)
    assert (run.outcome, engine.built) == (Outcome.UNSUPPORTED, [])
    assert "slot joint" in run.reason


def test_a_method_takes_the_callers_step_and_effort(engine):
    (method,) = engine.methods(_model())
    assert (method.name, method.runs, method.effort, method.effort_unit) == ("plain", 1, 20.0, "iterations")
    run = engine.run_method(_model(), dataclasses.replace(method, effort=7.0), 1e-3)
    assert engine.courses[0].recipe.effort == 7.0
    assert run.passes[0] == pytest.approx(1e-3)
    assert run.details["method"] == "plain"
    with pytest.raises(UnknownNameError):
        engine.run_method(_model(), dataclasses.replace(method, name="other"), 1e-3)
    with pytest.raises(LinkproofError, match="positive"):
        engine.run_method(_model(), dataclasses.replace(method, effort=-1.0), 1e-3)


KNOTS = np.radians([-40.0, 15.0, 80.0, 170.0, 250.0])
VALUES = np.array([[1.0, -3.0], [2.5, 0.0], [-1.0, 4.0], [0.5, 1.0], [2.0, -2.0]])
CLOSED = np.append(KNOTS, KNOTS[0] + FULL_TURN), np.vstack([VALUES, VALUES[:1]])
AROUND = CubicSpline(*CLOSED, bc_type="periodic")
ALONG = CubicSpline(KNOTS, VALUES)

LAWS = {
    "over a turn": (Law(VALUES, KNOTS), AROUND),
    "over a travel": (Law(VALUES, KNOTS, period=None), lambda x: ALONG(np.clip(x, KNOTS[0], KNOTS[-1]))),
    "lines over a turn": (
        Law(VALUES, KNOTS, linear=True),
        lambda x: [np.interp(x, KNOTS, column, period=FULL_TURN) for column in VALUES.T],
    ),
}


@pytest.mark.parametrize("name", LAWS)
def test_a_load_at_an_angle_is_the_splines(name):
    law, true = LAWS[name]
    plain = plain_law(law)
    for angle in (*np.linspace(-9.0, 9.0, 37).tolist(), *KNOTS.tolist()):
        assert law_values(plain, angle) == pytest.approx(np.asarray(true(angle)), abs=1e-12)
