"""A free crank: finding the step at which it can be followed, and following it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from analytic.description.law import FULL_TURN
from engines.contract import History
from engines.pymunk_adapter.checks import DivergedError
from engines.pymunk_adapter.cost import Cost
from engines.pymunk_adapter.passes import step_count
from engines.pymunk_adapter.plans import Aim, Plan
from engines.pymunk_adapter.release import followed
from engines.pymunk_adapter.space import Rig
from engines.scene import Channel, Free

# A step is cut by no more than this at a time: the pace seen with too long a step may be nonsense. One that is longer
# than wanted by less than the slack will do.
STEP_CUT = 8.0
SLACK = 1.25

# Where the angle is in doubt, which goes with a power of the step, the next step is this much below the one foreseen
# to do, and no less than a share of the last.
SHORTER, LARGEST_CUT = 0.9, 0.25

# Bounds of the search for a step, and of the steps of a pass: minutes of work, gigabytes of samples.
MOST_TRIALS = 10
MOST_STEPS = 10_000_000


def free_history(rig: Rig, drive: Free, plan: Plan, cost: Cost) -> tuple[History, float]:
    """The motion of a free crank and the step of its samples, s; raises DivergedError where no step is found."""
    if isinstance(plan.pace, Aim):
        return _aimed(rig, drive, plan.ratios, plan.pace, cost)
    step = drive.duration / step_count(drive.duration, plan.pace)
    return followed(rig, drive, step, plan.ratios, cost)[0], step


def _aimed(rig: Rig, drive: Free, ratios: tuple[int, ...], aim: Aim, cost: Cost) -> tuple[History, float]:
    """The motion at the step that the aim asks for.

    How fast a free crank gets is not known before, and at too long a step it loses so much energy that it never gets
    there. So a first pass measures the pace, and the step is cut until the angle depends on the coarsest pass no
    more than it may.
    """
    step, doubt = drive.duration / aim.least_samples, math.inf
    watched = replace(rig, scene=replace(rig.scene, channels=frozenset({Channel.VELOCITY, Channel.ACCELERATION})))
    for _ in range(MOST_TRIALS):
        step = drive.duration / step_count(drive.duration, step)
        if drive.duration / step * max(ratios) > MOST_STEPS:
            break
        try:
            trial, _ = followed(watched, drive, step, (1,), cost)
            pace = max(_pace(trial, rig.layout.crank), 1.0 / drive.duration)
            wanted = FULL_TURN / pace / aim.samples_per_turn
            if SLACK * wanted < step:
                step = max(wanted, step / STEP_CUT)
                continue
            history, doubt = followed(rig, drive, step, ratios, cost)
        except DivergedError:
            step /= STEP_CUT
            continue
        if doubt <= aim.doubt:
            return history, step
        step *= max(LARGEST_CUT, SHORTER * (aim.doubt / doubt) ** (1.0 / len(ratios)))
    raise DivergedError(
        f"no step down to {step:.2g} s gives a motion to rely on: the crank's angle stays in doubt by {doubt:.2g} rad"
    )


def _pace(history: History, crank: int) -> float:
    """The faster of turning and swinging: peak speed, and peak acceleration over peak speed, 1/s."""
    assert history.velocity is not None
    assert history.acceleration is not None
    speed = float(np.max(np.abs(history.velocity.values[:, crank, 2])))
    acceleration = float(np.max(np.abs(history.acceleration.values[:, crank, 2])))
    return max(speed, acceleration / speed if speed else 0.0)
