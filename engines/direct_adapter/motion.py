"""The motion of a scene under its drive: sampled instants, each solved by itself."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from analytic.description.law import FULL_TURN
from engines.contract import Array, History
from engines.direct_adapter.equations import Equations, UnsolvableError
from engines.direct_adapter.path import Path, reach
from engines.direct_adapter.released import BLOCK, released_motion
from engines.direct_adapter.solution import Crank, history, solve
from engines.scene import Free, Prescribed

LEAST_SAMPLES = 1400
SAMPLES_PER_TURN = 120
FREE_SPACING = 1e-3  # s
FARTHEST = 16.0  # units that a free linear driver is followed from its start
STOP = 1e-3  # rad or units before a position that the path cannot pass
FEWEST = 8  # fewer intervals cannot be read between


def motion(equations: Equations, spacing: float | None) -> tuple[History, int]:
    """History, and number of instants or time steps; raises UnsolvableError with the reason.

    ``spacing``, s, is the longest between samples; None takes as many as show the motion's every turn.
    """
    if isinstance(equations.scene.drive, Prescribed):
        return _prescribed(equations, equations.scene.drive, spacing)
    return _free(equations, equations.scene.drive, spacing)


def _clock(duration: float, spacing: float | None, turns: float, least: int = LEAST_SAMPLES) -> Array:
    samples = max(least, round(SAMPLES_PER_TURN * turns))
    if spacing is not None:
        samples = max(FEWEST, math.ceil(duration / spacing - 1e-6))
    return np.linspace(0.0, duration, samples + 1)


def _prescribed(equations: Equations, drive: Prescribed, spacing: float | None) -> tuple[History, int]:
    crank, scale = drive.motion, equations.driver.scale
    time = _clock(crank.duration, spacing, crank.duration * crank.peak_speed / FULL_TURN)
    angle = crank.angle(time) / scale
    path = reach(equations, float(np.min(angle)), float(np.max(angle)))
    _check_reach(path, time, angle)
    return _sampled(path, time, Crank(angle, crank.speed(time) / scale, crank.acceleration(time) / scale)), len(time)


def _check_reach(path: Path, time: Array, angle: Array) -> None:
    """Raise UnsolvableError with the first instant whose crank angle the path does not hold."""
    outside = (angle < path.low) | (angle > path.high)
    if path.turns is None and np.any(outside):
        first = int(np.argmax(outside))
        end = path.low if angle[first] < path.low else path.high
        driver = path.equations.driver
        where = f"crank angle of {math.degrees(end):.4g}°"
        if not driver.turns:
            where = f"length of {end * driver.scale:.4g} m of its {driver.kind}"
        raise UnsolvableError(
            f"the joints cannot be closed at {time[first]:.4g} s: the linkage locks, or passes a change point, at a "
            f"{where}"
        )


def _sampled(path: Path, time: Array, crank: Crank) -> History:
    """Every instant of the clock solved, in blocks."""
    equations, channels = path.equations, path.equations.scene.channels
    blocks = []
    for start in range(0, len(time), BLOCK):
        part = crank.part(slice(start, start + BLOCK))
        blocks.append(solve(equations, path.closed(part.angle), part, channels))
    return history(time, blocks, equations.joints, channels)


def _free(equations: Equations, drive: Free, spacing: float | None) -> tuple[History, int]:
    scale = equations.driver.scale
    start, far = equations.scene.crank_angle / scale, FULL_TURN if equations.driver.turns else FARTHEST
    low, high = start - far, start + far
    path = reach(equations, low, high)
    if path.turns is None:
        if equations.driver.turns and path.high - path.low > FULL_TURN:
            raise UnsolvableError("the linkage is in another pose after a turn of its crank")
        path = replace(path, low=path.low + STOP * (path.low > low), high=path.high - STOP * (path.high < high))
    free = released_motion(equations, path, drive)
    turns = drive.duration * float(np.max(np.abs(free(free.ts)[1]))) / FULL_TURN  # or spans as long
    time = _clock(drive.duration, spacing, turns, max(LEAST_SAMPLES, round(drive.duration / FREE_SPACING)))
    angle, speed = free(time)
    return _sampled(path, time, Crank(angle, speed, None, drive.torque_at(time) * scale)), free.n_segments
