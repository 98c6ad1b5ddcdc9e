"""Long runs lose no digits: full turns are taken off the angles on the way, and nobody sees it."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.dynamics import reduced
from comparisons.invariants import invariants
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.pymunk_adapter import stepping
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.pymunk_adapter.layout import exact_layout
from engines.pymunk_adapter.space import add_motor, build_world
from engines.pymunk_adapter.stepping import calls, march_wound
from engines.scene import Channel, Prescribed
from tests.analytic.linkages import mechanism

pytest.importorskip("pymunk")

STEP, RATE = 1e-4, 100.0  # s, rad/s
SAME = 1e-9  # of the scene's size and in rad, after a few turns
DRIFT = 1e-10  # rad, in ten thousand steps
TENFOLD = 10.0  # what the last of a thousand turns may be worse by than the first


def _turned(name, count):
    model = scene(mechanism(name), Prescribed(crank_motion("constant-speed", start_angle=0.3)), frozenset())
    world = build_world(exact_layout(model), iterations=300, error_bias=0.0)
    on = calls(world, add_motor(world))
    seen, impulses = march_wound(world, on, STEP, rates=[-RATE] * count, looks=[1] * count, loads=None)
    return world, seen, impulses


@pytest.mark.parametrize("name", ["moving-guides", "two-crank-takeup", "juki-mf7923d"])
def test_taking_turns_off_changes_nothing(monkeypatch, name):
    worlds, seen = [], []
    for stretch in (100, 10**9):
        monkeypatch.setattr(stepping, "UNWINDING", stretch)
        world, found, impulses = _turned(name, 2000)
        assert len(found) == len(impulses) == 2000
        worlds.append(world)
        seen.append(found)
    assert np.ptp(seen[0][:, worlds[0].layout.crank, 0, 2]) > 3.0 * 2.0 * math.pi
    assert np.abs(seen[0][:, :, 0] - seen[1][:, :, 0]).max() < SAME
    for one, other in zip(worlds[0].bodies, worlds[1].bodies, strict=True):
        assert one.angle == pytest.approx(other.angle, abs=SAME)


def test_what_was_seen_before_comes_first_and_as_it_was():
    model = scene(mechanism("juki-mf7923d"), Prescribed(crank_motion(start_angle=20.0)), frozenset())
    world = build_world(exact_layout(model), iterations=10, error_bias=0.0)
    on = calls(world, add_motor(world))
    on.look()
    seen, impulses = march_wound(world, on, STEP, rates=[0.0] * 3, looks=[0, 0, 1], loads=None)
    assert len(seen) == 2
    assert len(impulses) == 1
    assert seen[:, world.layout.crank, 0, 2] == pytest.approx(20.0)


def test_a_crank_that_turns_on_and_on_is_where_its_speed_brings_it():
    world, seen, _ = _turned("juki-mf7923d", 10_000)
    angle = seen[:, world.layout.crank, 0, 2]
    steady = angle[0] + RATE * STEP * np.arange(10_000)
    assert np.abs(angle - steady).max() < DRIFT


@pytest.mark.slow
def test_the_last_of_a_thousand_turns_is_as_good_as_the_first():
    closed = mechanism("juki-mf7923d")
    motion = crank_motion("constant-speed", ramp_time=59.9, hold_time=0.1)
    model = scene(closed, Prescribed(motion), {Channel.POSITION, Channel.TORQUE})
    run = PymunkEngine().run(model, Setting.TUNED)
    assert run.outcome is Outcome.FINISHED, run.reason
    time = run.history.torque.time
    turn = 2.0 * math.pi / motion.peak_speed
    first, last = time <= turn, time >= time[-1] - turn
    sweep = closed.sweep(motion.angle(time[first | last]))
    truth = reduced.drive_torque(sweep, motion.speed(time[first | last]), motion.acceleration(time[first | last]))
    off = np.abs(run.history.torque.values[first | last] - truth)
    assert off[-last.sum() :].max() < TENFOLD * off[: first.sum()].max()
    gaps = invariants.joint_gaps(ObservedMotion(model, run.history)).values
    assert gaps[last].max() < TENFOLD * gaps[first].max()
