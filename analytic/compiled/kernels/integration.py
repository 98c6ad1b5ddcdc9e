"""Gauss collocation of the equation of motion in adaptive windows, compiled once for all linkages.

The steps are those of ``analytic.numerics.integration.integrate``, taken in the same order; what its comments say holds
here. The scheme comes with its matrices transposed: a product runs down their rows. The terms of the equation are read
from a table; where the crank cannot turn fully there is none, and they come from the linkage's own kernels.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import Tables
from analytic.compiled.kernels.jit import SOURCES, entry, inlined, kernel
from analytic.compiled.kernels.layout import ANGLE, DAMPING, FORCE, HALF_DERIVATIVE, JEQ, SUMS
from analytic.compiled.kernels.linkage import equation_rows
from analytic.numerics import step_control
from analytic.numerics.collocation import GaussScheme
from analytic.numerics.step_control import State

Array = NDArray[np.float64]
LOST: Final = -1


class Cells(NamedTuple):
    """A ``PeriodicTable`` of moment, damping and slope over the inertia; without coefficients there is none."""

    edges: Array
    period: float
    coefficients: Array


class Space(NamedTuple):
    """Memory for one integration, a number per node: made once, since kernels allocate nothing."""

    found: Array
    following: Array
    speeds: Array
    turned: Array
    series: Array
    guess: Array
    work: Array


@inlined
def product(n: int, rows: int, matrix: Array, vector: Array, result: Array) -> None:
    """Product of a matrix, given transposed, and a vector."""
    for i in range(rows):
        result[i] = 0.0
    for j in range(n):
        factor, row = vector[j], matrix[j]
        for i in range(rows):
            result[i] += row[i] * factor


@kernel
def read(cells: Cells, n: int, speeds: Array, result: Array, work: Array) -> None:
    """φ̈ from the table; the next angle is searched for from the cell of the one before."""
    edges, cell = cells.edges, 0
    last = cells.coefficients.shape[1] - 1
    whole = cells.period * np.floor((work[ANGLE] - edges[0]) / cells.period)
    for i in range(n):
        turned = work[ANGLE + i] - whole
        if not edges[0] <= turned < edges[-1]:
            whole = cells.period * np.floor((work[ANGLE + i] - edges[0]) / cells.period)
            turned = work[ANGLE + i] - whole
        while cell > 0 and turned < edges[cell]:
            cell -= 1
        while cell < len(edges) - 2 and turned >= edges[cell + 1]:
            cell += 1
        place = (2.0 * turned - edges[cell] - edges[cell + 1]) / (edges[cell + 1] - edges[cell])
        terms = cells.coefficients[cell]
        moment, damping, slope = terms[last, 0], terms[last, 1], terms[last, 2]
        for order in range(last - 1, -1, -1):
            moment = moment * place + terms[order, 0]
            damping = damping * place + terms[order, 1]
            slope = slope * place + terms[order, 2]
        w = speeds[i]
        result[i] = moment - w * (damping + slope * w)


@kernel
def accelerations(
    tables: Tables, design: Array, cells: Cells, n: int, speeds: Array, result: Array, work: Array
) -> float:
    """φ̈ at the angles in the scratch memory and the speeds given; how many of them have no motion."""
    if len(cells.coefficients):
        read(cells, n, speeds, result, work)
        return 0.0
    faults = equation_rows(tables, design, n, work)
    terms = work[SUMS:]
    for i in range(n):
        w = speeds[i]
        result[i] = (terms[FORCE + i] - w * (terms[DAMPING + i] + terms[HALF_DERIVATIVE + i] * w)) / terms[JEQ + i]
    return faults


@kernel
def stay(tables: Tables, design: Array, cells: Cells, n: int, angle: float, speed: float, space: Space) -> None:
    """Predict the window with the acceleration of an angle and a speed kept constant; nan if there is no motion."""
    for i in range(n):
        space.work[ANGLE + i] = angle
        space.speeds[i] = speed
    faults = accelerations(tables, design, cells, n, space.speeds, space.guess, space.work)
    for i in range(n):
        space.guess[i] = space.guess[i] if faults == 0.0 else np.nan


@kernel
def settles(
    tables: Tables,
    design: Array,
    cells: Cells,
    scheme: GaussScheme,
    window: tuple[float, float, float],
    rounding: float,
    space: Space,
) -> bool:
    """Whether the fixed-point iteration from the guess settles; found are then the accelerations at the nodes."""
    angle, speed, length = window
    n, square = len(scheme.nodes), length * length
    found, following, speeds, turned = space.found, space.following, space.speeds, space.turned
    for i in range(n):
        found[i] = space.guess[i]
    before = least = np.inf
    for _ in range(step_control.MOST_ITERATIONS):
        product(n, n, scheme.once, found, speeds)
        product(n, n, scheme.twice, found, turned)
        for i in range(n):
            space.work[ANGLE + i] = angle + speed * length * scheme.nodes[i] + square * turned[i]
            speeds[i] = speed + length * speeds[i]
        if accelerations(tables, design, cells, n, speeds, following, space.work) > 0.0:
            return False
        change = peak = 0.0
        for i in range(n):
            difference = abs(following[i] - found[i])
            change = difference if not difference <= change else change  # a nan stays
            peak = max(peak, abs(following[i]))
            found[i] = following[i]
        if not change <= step_control.DIVERGING * least:
            return False
        least = min(least, change)
        if step_control.has_settled(change, before, peak, rounding):
            return True
        before = change
    return False


@kernel
def error_of(scheme: GaussScheme, speed: float, length: float, rounding: float, space: Space) -> float:
    """Error of the speed over the speed in a window, from the last terms of the acceleration's series."""
    n = len(scheme.nodes)
    product(n, n, scheme.series, space.found, space.series)
    gained = peak = 0.0
    for i in range(n):
        gained += scheme.end_once[i] * space.found[i]
        peak = max(peak, abs(space.found[i]))
    tail = max(abs(space.series[n - 2]) - rounding, abs(space.series[n - 1]) - rounding, 0.0)
    return step_control.relative_error(tail, speed, gained, peak, length)


@kernel
def carry_on(scheme: GaussScheme, growth: float, space: Space) -> None:
    """The acceleration's polynomial at the nodes of the next window, without its high terms, which grow outside."""
    n = len(scheme.nodes)
    series = space.series
    for i in range(n):
        place = 1.0 + 2.0 * growth * scheme.nodes[i]
        before, now = 1.0, place
        total = series[0] + series[1] * place
        for order in range(2, max(2, n // 2)):
            before, now = now, ((2 * order - 1) * place * now - (order - 1) * before) / order
            total += series[order] * now
        space.guess[i] = total


@kernel
def write(scheme: GaussScheme, state: State, length: float, space: Space, angles: Array, speeds: Array) -> State:
    """The series of a window's angle and speed, and the state at its end."""
    speed = state[2]
    n, found = len(scheme.nodes), space.found
    product(n, n + 2, scheme.angle, found, angles)
    product(n, n + 1, scheme.speed, found, speeds)
    for i in range(n + 2):
        angles[i] *= length * length
    for i in range(n + 1):
        speeds[i] *= length
    speeds[0] += speed
    angles[0] += 0.5 * length * speed
    angles[1] += 0.5 * length * speed
    once = twice = 0.0
    for i in range(n):
        once += scheme.end_once[i] * found[i]
        twice += scheme.end_twice[i] * found[i]
    return step_control.at_end(state, length, once, twice)


@entry
def advance(
    tables: Tables,
    design: Array,
    cells: Cells,
    scheme: GaussScheme,
    start: tuple[float, float],
    duration: float,
    tolerance: float,
    rounding: float,
    space: Space,
    starts: Array,
    base: Array,
    angles: Array,
    speeds: Array,
    sources: int = SOURCES,
) -> int:
    """Integrate from ``start``, (φ, ω); the number of windows, or LOST where the motion cannot be followed.

    ``starts``, ``base``, ``angles`` and ``speeds`` take the windows, one a row, as
    ``analytic.numerics.collocation.Windows`` has them one a column.
    """
    state = start[0], 0.0, start[1], 0.0, 0.0
    stay(tables, design, cells, len(scheme.nodes), start[0], start[1], space)
    length = step_control.first_window(start[1], space.guess[0], duration)
    longest, time, done, starts[0] = length, 0.0, 0, 0.0
    while time < duration:
        last = length >= step_control.ALL_BUT * (duration - time)
        length = duration - time if last else length
        angle, _, speed, _, turns = state
        settled = settles(tables, design, cells, scheme, (angle, speed, length), rounding, space)
        error = error_of(scheme, speed, length, rounding, space) if settled else np.inf
        factor = step_control.growth(error, tolerance, len(scheme.nodes))
        if error <= tolerance:
            base[done] = angle + turns * step_control.FULL_TURN
            state = write(scheme, state, length, space, angles[done], speeds[done])
            time = duration if last else time + length
            done += 1
            starts[done] = time
            carry_on(scheme, factor, space)
            longest = max(longest, length)
        else:
            factor = min(factor, step_control.MOST_RETRY)
            stay(tables, design, cells, len(scheme.nodes), angle, speed, space)
        length *= factor
        if done == len(base) or step_control.is_lost(starts, done, length, longest):
            return done if time >= duration else LOST
    return done
