"""Cutting a motion into stretches: nothing left out, no step longer than asked, fresh starts where they belong."""

import dataclasses
import math
from itertools import pairwise

import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from comparisons.reference.start_state import scene
from engines.exudyn_adapter.recipes import AS_SHIPPED, TRAPEZOIDAL, Recipe
from engines.exudyn_adapter.segments import FULL_TURN, prescribed_stretches
from engines.scene import Prescribed
from tests.analytic.linkages import mechanism

CLOSE = 1e-9
STEPS = 50.0  # per turn

MOTIONS = [
    crank_motion("run-up"),
    crank_motion("run-up-quintic", clockwise=True),
    crank_motion("constant-speed"),
    crank_motion("run-up-cubic", speed=3.0),
    CrankMotion("rest", (Segment(0.0, 0.2, (0.4,)), Segment(0.2, 0.5, (0.4, 0.0, 30.0)))),
]


def _cut(motion, **recipe):
    model = scene(mechanism("juki-mf7923d"), Prescribed(crank_motion()), ())
    model = dataclasses.replace(model, drive=Prescribed(motion))
    return prescribed_stretches(model, Recipe(**{"rule": TRAPEZOIDAL, **recipe}))


def _fastest(stretch):
    """Largest speed in a stretch, rad/s; those used here are monotonic in each."""
    return max(abs(float(stretch.segment.value(time, 1))) for time in (stretch.start, stretch.end))


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.regime)
@pytest.mark.parametrize("recipe", [{"steps_per_turn": STEPS, "turns": 0.7}, {"step": 1.3e-3}, {"step": 1.0}])
def test_stretches_make_up_the_whole_motion_and_each_lies_in_one_segment(motion, recipe):
    stretches = _cut(motion, **recipe)
    assert stretches[0].start == 0.0
    assert stretches[-1].end == motion.duration
    assert all(before.end == after.start for before, after in pairwise(stretches))
    for stretch in stretches:
        assert stretch.segment.start <= stretch.start < stretch.end <= stretch.segment.end
    jumps = [stretch.start for stretch in stretches if stretch.after_jump]
    assert jumps == [jump for jump in motion.jumps if jump > 0.0]


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.regime)
@pytest.mark.parametrize("turns", [0.7, math.inf])
def test_no_step_is_longer_than_asked(motion, turns):
    for stretch in _cut(motion, step=1.3e-3, turns=turns):
        assert stretch.step <= 1.3e-3 * (1.0 + CLOSE)


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.regime)
def test_a_recipe_for_steps_per_turn_follows_the_speed(motion):
    stretches = _cut(motion, steps_per_turn=STEPS, turns=0.7)
    for stretch in stretches:
        assert _fastest(stretch) * stretch.step <= FULL_TURN / STEPS * (1.0 + CLOSE)
        assert _fastest(stretch) * (stretch.end - stretch.start) <= 0.75 * FULL_TURN  # the fastest place may lie beside


@pytest.mark.parametrize("regime", ["run-up", "run-up-cubic", "run-up-quintic"])
def test_steps_differ_by_no_more_than_a_factor_of_two_or_so(regime):
    steps = [stretch.step for stretch in _cut(crank_motion(regime), steps_per_turn=STEPS, turns=0.7)]
    assert max(steps) <= 2.2 * min(steps)


def test_a_slow_part_is_given_fewer_steps():
    motion = crank_motion("run-up")
    graded = sum(stretch.samples for stretch in _cut(motion, steps_per_turn=STEPS))
    even = sum(stretch.samples for stretch in _cut(motion, step=FULL_TURN / STEPS / motion.peak_speed))
    assert graded < 0.8 * even


def test_exudyns_own_rule_runs_through():
    (stretch,) = _cut(crank_motion("run-up"), rule=AS_SHIPPED, step=1e-3)
    assert (stretch.start, stretch.end, stretch.samples) == (0.0, 0.7, 700)
