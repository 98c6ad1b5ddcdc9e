"""The motion of a scene under its drive by a recipe: sampled instants solved exactly, or time steps."""

from __future__ import annotations

import math

import numpy as np

from engines.contract import History
from engines.direct_adapter.assembly import UnsolvableError
from engines.direct_adapter.collocation import POINTS, Problem, integrate
from engines.direct_adapter.equations import Equations, Reals
from engines.direct_adapter.instants import Crank, history, solve
from engines.direct_adapter.path import FULL_TURN, Path, reach
from engines.direct_adapter.recipes import Exact, Recipe, RungeKutta
from engines.direct_adapter.released import equation_of_motion
from engines.direct_adapter.stepping import step_through
from engines.scene import Free, Prescribed

BLOCK = 512  # instants solved at once: their matrices stay in a processor's cache
LEAST_SAMPLES = 1400
SAMPLES_PER_TURN = 120
FREE_SPACING = 1e-3  # s
LEAST_STEPS = 8  # fewer samples cannot be read between

Details = dict[str, str | int | float]
Result = tuple[History, int, Details]


def motion(equations: Equations, recipe: Recipe) -> Result:
    """History, number of instants or time steps, and settings used; raises UnsolvableError with the reason."""
    if isinstance(recipe, RungeKutta):
        return _stepped(equations, recipe)
    if isinstance(equations.scene.drive, Prescribed):
        return _prescribed(equations, equations.scene.drive, recipe)
    return _free(equations, equations.scene.drive, recipe)


def _stepped(equations: Equations, recipe: RungeKutta) -> Result:
    drive = equations.scene.drive
    duration = drive.motion.duration if isinstance(drive, Prescribed) else drive.duration
    time = _clock(duration, _fitting(duration, recipe.step))
    found = step_through(equations, time, recipe.largest_gap)
    details: Details = {
        "procedure": "accelerations and joint forces from one system (index 1), Runge-Kutta 4, no stabilisation",
        "step_s": float(time[1]),
    }
    return history(time, found, equations.joints, equations.scene.channels), len(time) - 1, details


def _clock(duration: float, steps: int) -> Reals:
    return np.linspace(0.0, duration, steps + 1)


def _fitting(duration: float, step: float) -> int:
    return max(LEAST_STEPS, math.ceil(duration / step - 1e-6))


def _samples(turns: float) -> int:
    return max(LEAST_SAMPLES, round(SAMPLES_PER_TURN * turns))


def _prescribed(equations: Equations, drive: Prescribed, recipe: Exact) -> Result:
    crank = drive.motion
    samples = _samples(crank.duration * crank.peak_speed / FULL_TURN)
    time = _clock(crank.duration, samples if recipe.spacing is None else _fitting(crank.duration, recipe.spacing))
    angle = crank.angle(time)
    known = Crank(angle, crank.speed(time), crank.acceleration(time))
    path = reach(equations, float(np.min(angle)), float(np.max(angle)))
    _check_reach(path, time, angle)
    return _sampled(path, time, known, recipe)


def _check_reach(path: Path, time: Reals, angle: Reals) -> None:
    """Raise UnsolvableError with the first instant whose crank angle the path does not hold."""
    if path.turns is not None:
        return
    outside = (angle < path.angle[0]) | (angle > path.angle[-1])
    if np.any(outside):
        first = int(np.argmax(outside))
        end = path.angle[0] if angle[first] < path.angle[0] else path.angle[-1]
        raise UnsolvableError(
            f"the joints cannot be closed at {time[first]:.4g} s: the linkage locks at a crank angle of "
            f"{math.degrees(end):.4g}°"
        )


def _sampled(path: Path, time: Reals, crank: Crank, recipe: Exact) -> Result:
    """Every instant of the clock solved, in blocks."""
    equations, found = path.equations, []
    for start in range(0, len(time), BLOCK):
        part = crank.part(slice(start, start + BLOCK))
        closed = path.closed(part.angle, recipe.precision)
        found.append(solve(equations, closed, part, equations.scene.channels, recipe.refinements))
    details: Details = {
        "procedure": "each instant by Newton's method and one inverted matrix, refined",
        "rounding": float(np.finfo(recipe.precision).eps),
        "refinements": recipe.refinements,
        "instants": len(time),
        "spacing_s": float(time[1]),
        "path_poses": len(path.angle),
    }
    return history(time, found, equations.joints, equations.scene.channels), len(time), details


def _free(equations: Equations, drive: Free, recipe: Exact) -> Result:
    start = equations.scene.crank_angle
    speed = equations.scene.bodies[equations.crank].angular_velocity
    path = reach(equations, start - FULL_TURN, start + FULL_TURN)
    law = equation_of_motion(equations, path, drive.torque)
    period = FULL_TURN if path.turns is not None else math.inf
    problem = Problem(law, recipe.tolerance, period, law.breaks)
    trajectory = integrate(problem, start, speed, drive.duration)
    samples = max(round(drive.duration / FREE_SPACING), _samples(drive.duration * trajectory.peak_speed / FULL_TURN))
    time = _clock(drive.duration, samples if recipe.spacing is None else _fitting(drive.duration, recipe.spacing))
    angle, speeds = trajectory(time)
    crank = Crank(angle, speeds, None, drive.torque)
    result, _, details = _sampled(path, time, crank, recipe)
    steps = len(trajectory.windows)
    details |= {
        "integrator": f"Gauss collocation, {POINTS} points a window",
        "tolerance": recipe.tolerance,
        "windows": steps,
    }
    return result, steps, details
