"""A state on the joints and the drive to start a part from, by exudyn's own static solver.

A rule with its constraints on velocity level lets positions drift off the joints, by the square of the step in every
turn; any rule has to be told of an acceleration that jumps. Where the crank is prescribed, its angle φ alone fixes the
coordinates q, which the static solver finds to rounding; from their differences between angles near by follow

    q̇ = q' φ̇,    q̈ = q'' φ̇² + q' φ̈.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engines.exudyn_adapter.model import Foreign, Model
from engines.stepping.intervals import Interval

Array = NDArray[np.float64]
State = tuple[Array, Array, Array]  # coordinates and their first two time derivatives

FROM = "exudyn's static solver at seven crank angles"
TURNED = 5e-3  # rad between these: rounding of q'' and what the differences leave out are about equal
# Central differences of sixth order for the first and second derivative, at 1 … 3 times that on either side.
FIRST = (3 / 4, -3 / 20, 1 / 60)
SECOND = (3 / 2, -3 / 20, 1 / 90)
TOLERANCE = 1e-9  # of a correction of the static solver, whose square, which is the next, is rounding
# What a start may change of coordinates, in the unit of length and rad, and of velocities, over the largest. A larger
# change is another assembly mode, found near a change point.
LARGEST_CHANGE = 1e-2


def end_state(model: Model) -> State:
    """The state that the latest solve has ended with, its angles unwound."""
    state = model.mbs.systemData
    values = (state.GetODE2Coordinates(), state.GetODE2Coordinates_t(), state.GetODE2Coordinates_tt())
    position, velocity, acceleration = map(np.array, values)
    return model.unwind(position), velocity, acceleration


def set_initial(model: Model, position: Array, *rates: Array) -> None:
    """Let the next solve start from coordinates and, where given, their time derivatives."""
    state, initial = model.mbs.systemData, model.exudyn.ConfigurationType.Initial
    state.SetODE2Coordinates(position, configuration=initial)
    for put, rate in zip((state.SetODE2Coordinates_t, state.SetODE2Coordinates_tt), rates, strict=False):
        put(rate, configuration=initial)


def closed_state(model: Model, part: Interval, reached: State) -> State | None:
    """The state at the start of a part of a prescribed motion, near the one reached; None where none is found."""
    assert part.segment is not None
    angle, speed, second = (float(part.segment.value(part.start, order)) for order in range(3))
    try:
        position = _at_angle(model, reached[0], angle)
        rate, bend = np.zeros_like(position), np.zeros_like(position)
        for sign in (1.0, -1.0):
            place = position
            for count, (first_weight, second_weight) in enumerate(zip(FIRST, SECOND, strict=True), start=1):
                place = _at_angle(model, place, angle + sign * count * TURNED)
                rate += sign * first_weight / TURNED * (place - position)
                bend += second_weight / TURNED**2 * (place - position)
    except model.exudyn.ExudynError:
        return None
    velocity = rate * speed
    is_near = np.abs(position - reached[0]).max() <= LARGEST_CHANGE
    is_like = np.abs(velocity - reached[1]).max() <= LARGEST_CHANGE * np.abs(velocity).max()
    return (position, velocity, bend * speed**2 + rate * second) if is_near and is_like else None


def _at_angle(model: Model, guess: Array, angle: float) -> Array:
    """Coordinates at a crank angle, rad; raises ExudynError where exudyn finds none."""
    exudyn, mbs = model.exudyn, model.mbs
    model.hold_drive(angle)
    set_initial(model, guess)
    mbs.SolveStatic(_settings(exudyn))
    return np.array(mbs.systemData.GetODE2Coordinates())


def _settings(exudyn: Foreign) -> Foreign:
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenDense
    settings.staticSolver.useLoadFactor = False
    newton = settings.staticSolver.newton
    newton.residualMode = 1  # corrections are judged, not loads
    newton.relativeTolerance = newton.absoluteTolerance = TOLERANCE
    return settings
