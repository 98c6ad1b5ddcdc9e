"""Cutting a motion into intervals: nothing left out, no step longer than allowed, fresh starts where they belong."""

import math
from itertools import pairwise

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion, swing, table_motion
from analytic.description.law import FULL_TURN
from engines.stepping.intervals import Pace, intervals

CLOSE = 1e-9
STEPS = 50.0  # per turn

MOTIONS = [
    crank_motion("run-up"),
    crank_motion("run-up-quintic", clockwise=True),
    crank_motion("constant-speed"),
    crank_motion("run-up-cubic", speed=3.0),
    CrankMotion("rest", (Segment(0.0, 0.2, (0.4,)), Segment(0.2, 0.5, (0.4, 0.0, 30.0)))),
]


def _cut(motion, **pace):
    return intervals(motion, Pace(**pace))


def _fastest(part):
    """Largest speed in a part, rad/s; those used here are monotonic in each."""
    return max(abs(float(part.segment.value(time, 1))) for time in (part.start, part.end))


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.regime)
@pytest.mark.parametrize("pace", [{"steps_per_turn": STEPS, "turns": 0.7}, {"step": 1.3e-3}, {"step": 1.0}])
def test_parts_make_up_the_whole_motion_and_each_lies_in_one_segment(motion, pace):
    parts = _cut(motion, **pace)
    assert parts[0].start == 0.0
    assert parts[-1].end == motion.duration
    assert all(before.end == after.start for before, after in pairwise(parts))
    for part in parts:
        assert part.segment.start <= part.start < part.end <= part.segment.end
    jumps = [part.start for part in parts if part.after_jump]
    assert jumps == [jump for jump in motion.jumps if jump > 0.0]


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.regime)
@pytest.mark.parametrize("turns", [0.7, math.inf])
def test_no_step_is_longer_than_allowed(motion, turns):
    for part in _cut(motion, step=1.3e-3, turns=turns):
        assert part.step <= 1.3e-3 * (1.0 + CLOSE)


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.regime)
def test_a_pace_of_steps_per_turn_follows_the_speed(motion):
    parts = _cut(motion, steps_per_turn=STEPS, turns=0.7)
    for part in parts:
        assert _fastest(part) * part.step <= FULL_TURN / STEPS * (1.0 + CLOSE)
        assert _fastest(part) * (part.end - part.start) <= 0.75 * FULL_TURN  # the fastest place may lie beside


@pytest.mark.parametrize("regime", ["run-up", "run-up-cubic", "run-up-quintic"])
def test_steps_differ_by_no_more_than_a_factor_of_two_or_so(regime):
    steps = [part.step for part in _cut(crank_motion(regime), steps_per_turn=STEPS, turns=0.7)]
    assert max(steps) <= 2.2 * min(steps)


def test_a_slow_part_is_given_fewer_steps():
    motion = crank_motion("run-up")
    graded = sum(part.samples for part in _cut(motion, steps_per_turn=STEPS))
    even = sum(part.samples for part in _cut(motion, step=FULL_TURN / STEPS / motion.peak_speed))
    assert graded < 0.8 * even


def test_a_table_of_many_pieces_takes_no_more_steps_for_them():
    time = np.linspace(0.0, 1.0, 401)
    dense = table_motion("dense", time.tolist(), np.sin(time).tolist())
    coarse = swing("modified-sine", 0.0, 1.0, time=1.0)
    steps = [sum(part.samples for part in intervals(motion, Pace(least_steps=100))) for motion in (coarse, dense)]
    assert steps == [800, 400 * 5]
