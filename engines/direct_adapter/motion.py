"""The motion of a scene under its drive: sampled instants, each solved by itself."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from engines.contract import History
from engines.direct_adapter.assembly import Equations, UnsolvableError
from engines.direct_adapter.path import Path, reach
from engines.direct_adapter.precision import Precision
from engines.direct_adapter.released import BLOCK, NODES, released_motion
from engines.direct_adapter.solution import Crank, history, solve
from engines.scene import Free, Prescribed

Array = NDArray[np.float64]

LEAST_SAMPLES = 1400
SAMPLES_PER_TURN = 120
FREE_SPACING = 1e-3  # s
FARTHEST = 16.0  # units that a free linear driver is followed from its start
FEWEST = 8  # fewer intervals cannot be read between

Details = dict[str, str | int | float]
Result = tuple[History, int, Details]


def motion(equations: Equations, precision: Precision) -> Result:
    """History, number of instants or time steps, and settings used; raises UnsolvableError with the reason."""
    if isinstance(equations.scene.drive, Prescribed):
        return _prescribed(equations, equations.scene.drive, precision)
    return _free(equations, equations.scene.drive, precision)


def _clock(duration: float, spacing: float | None, samples: int) -> Array:
    """Instants at a longest spacing, s, or so many of them."""
    if spacing is not None:
        samples = max(FEWEST, math.ceil(duration / spacing - 1e-6))
    return np.linspace(0.0, duration, samples + 1)


def _samples(turns: float) -> int:
    return max(LEAST_SAMPLES, round(SAMPLES_PER_TURN * turns))


def _prescribed(equations: Equations, drive: Prescribed, precision: Precision) -> Result:
    crank = drive.motion
    time = _clock(crank.duration, precision.spacing, _samples(crank.duration * crank.peak_speed / FULL_TURN))
    angle = crank.angle(time)
    scale = equations.driver.scale
    known = Crank(angle / scale, crank.speed(time) / scale, crank.acceleration(time) / scale)
    path = reach(equations, float(np.min(known.angle)), float(np.max(known.angle)))
    _check_reach(path, time, angle / scale)
    return _sampled(path, time, known, precision)


def _check_reach(path: Path, time: Array, angle: Array) -> None:
    """Raise UnsolvableError with the first instant whose crank angle the path does not hold."""
    if path.turns is not None:
        return
    outside = (angle < path.angle[0]) | (angle > path.angle[-1])
    if np.any(outside):
        first = int(np.argmax(outside))
        end = path.angle[0] if angle[first] < path.angle[0] else path.angle[-1]
        driver = path.equations.driver
        where = f"crank angle of {math.degrees(end):.4g}°"
        if not driver.turns:
            where = f"length of {end * driver.scale:.4g} m of its {driver.kind}"
        raise UnsolvableError(
            f"the joints cannot be closed at {time[first]:.4g} s: the linkage locks, or passes a change point, at a "
            f"{where}"
        )


def _sampled(path: Path, time: Array, crank: Crank, precision: Precision) -> Result:
    """Every instant of the clock solved, in blocks."""
    equations, blocks = path.equations, []
    for start in range(0, len(time), BLOCK):
        part = crank.part(slice(start, start + BLOCK))
        closed = path.closed(part.angle, precision.dtype)
        blocks.append(solve(equations, closed, part, equations.scene.channels, precision.refinements))
    details: Details = {
        "procedure": "each instant by Newton's method and one inverted matrix, refined",
        "rounding": float(np.finfo(precision.dtype).eps),
        "refinements": precision.refinements,
        "instants": len(time),
        "spacing_s": float(time[1]),
        "path_poses": len(path.angle),
    }
    return history(time, blocks, equations.joints, equations.scene.channels), len(time), details


def _free(equations: Equations, drive: Free, precision: Precision) -> Result:
    scale = equations.driver.scale
    start, far = equations.scene.crank_angle / scale, FULL_TURN if equations.driver.turns else FARTHEST
    around = (start - far, start + far)
    path = reach(equations, *around).away_from_stops(*around)
    windows = released_motion(equations, path, drive, precision.tolerance)
    turns = drive.duration * float(np.max(np.abs(windows.speed_at(windows.starts)))) / FULL_TURN  # or spans as long
    time = _clock(drive.duration, precision.spacing, max(round(drive.duration / FREE_SPACING), _samples(turns)))
    crank = Crank(windows.angle_at(time), windows.speed_at(time), None, drive.torque_at(time) * scale)
    result, _, details = _sampled(path, time, crank, precision)
    details |= {
        "integrator": f"Gauss collocation, {NODES} points a window",
        "tolerance": precision.tolerance,
        "windows": len(windows.base),
    }
    return result, len(windows.base), details
