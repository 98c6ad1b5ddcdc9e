"""Gauss collocation of the equation of motion in adaptive windows, compiled once for all linkages.

The steps are those of ``analytic.numerics.integration.integrate``, taken in the same order; what its comments say holds
here. The terms of the equation come from the linkage's own kernels at every node, not from a table.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import Tables
from analytic.compiled.kernels.jit import SOURCES, entry, inlined, kernel
from analytic.compiled.kernels.layout import ANGLE, DAMPING, FORCE, HALF_DERIVATIVE, JEQ, SUMS
from analytic.compiled.kernels.linkage import equation_rows

Array = NDArray[np.float64]
State = tuple[float, float, float, float, float]  # φ within a turn, its lost rounding, ω, its lost rounding, turns

FULL_TURN: Final = 2.0 * np.pi
LOST: Final = -1
EPS: Final = float(np.finfo(float).eps)
TINY: Final = float(np.finfo(float).tiny)


class Rules(NamedTuple):
    """``analytic.numerics.collocation.GaussScheme`` with its matrices transposed: a product runs down their rows."""

    nodes: Array
    series: Array
    once: Array
    twice: Array
    end_once: Array
    end_twice: Array
    speed: Array
    angle: Array


class Controls(NamedTuple):
    """When an iteration is over, a window good and a motion lost: the constants of ``numerics.integration``."""

    most_iterations: int
    diverging: float
    least_window: float
    stuck: int
    stuck_share: float
    safety: float
    most_growth: float
    least_growth: float
    most_retry: float
    all_but: float
    first_angle: float


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
def accelerations(tables: Tables, design: Array, n: int, speeds: Array, result: Array, work: Array) -> float:
    """φ̈ at the angles in the scratch memory and the speeds given; how many of them have no motion."""
    faults = equation_rows(tables, design, n, work)
    terms = work[SUMS:]
    for i in range(n):
        w = speeds[i]
        result[i] = (terms[FORCE + i] - w * (terms[DAMPING + i] + terms[HALF_DERIVATIVE + i] * w)) / terms[JEQ + i]
    return faults


@kernel
def stay(tables: Tables, design: Array, n: int, angle: float, speed: float, space: Space) -> None:
    """Guess that the acceleration stays what it is at an angle and a speed; nan if there is no motion."""
    for i in range(n):
        space.work[ANGLE + i] = angle
        space.speeds[i] = speed
    faults = accelerations(tables, design, n, space.speeds, space.guess, space.work)
    for i in range(n):
        space.guess[i] = space.guess[i] if faults == 0.0 else np.nan


@kernel
def settles(
    tables: Tables,
    design: Array,
    rules: Rules,
    controls: Controls,
    window: tuple[float, float, float],
    rounding: float,
    space: Space,
) -> bool:
    """Whether the fixed-point iteration from the guess settles; found are then the accelerations at the nodes."""
    angle, speed, length = window
    n, square = len(rules.nodes), length * length
    found, following, speeds, turned = space.found, space.following, space.speeds, space.turned
    for i in range(n):
        found[i] = space.guess[i]
    before = least = np.inf
    for _ in range(controls.most_iterations):
        product(n, n, rules.once, found, speeds)
        product(n, n, rules.twice, found, turned)
        for i in range(n):
            space.work[ANGLE + i] = angle + speed * length * rules.nodes[i] + square * turned[i]
            speeds[i] = speed + length * speeds[i]
        if accelerations(tables, design, n, speeds, following, space.work) > 0.0:
            return False
        change = peak = 0.0
        for i in range(n):
            difference = abs(following[i] - found[i])
            change = difference if not difference <= change else change  # a nan stays
            peak = max(peak, abs(following[i]))
            found[i] = following[i]
        if not change <= controls.diverging * least:
            return False
        least = min(least, change)
        if change <= 4.0 * EPS * peak + rounding or (change >= 0.5 * before and change <= 1e4 * EPS * peak):
            return True
        before = change
    return False


@kernel
def error_of(rules: Rules, speed: float, length: float, rounding: float, space: Space) -> float:
    """Error of the speed over the speed in a window, from the last terms of the acceleration's series."""
    n = len(rules.nodes)
    product(n, n, rules.series, space.found, space.series)
    gained = peak = 0.0
    for i in range(n):
        gained += rules.end_once[i] * space.found[i]
        peak = max(peak, abs(space.found[i]))
    tail = max(abs(space.series[n - 2]) - rounding, abs(space.series[n - 1]) - rounding, 0.0) * length
    scale = max(abs(speed), abs(speed + length * gained), length * peak)
    return tail / scale if scale > 0.0 else 0.0


@kernel
def carry_on(rules: Rules, growth: float, space: Space) -> None:
    """The acceleration's polynomial at the nodes of the next window, without its high terms, which grow outside."""
    n = len(rules.nodes)
    series = space.series
    for i in range(n):
        place = 1.0 + 2.0 * growth * rules.nodes[i]
        before, now = 1.0, place
        total = series[0] + series[1] * place
        for order in range(2, max(2, n // 2)):
            before, now = now, ((2 * order - 1) * place * now - (order - 1) * before) / order
            total += series[order] * now
        space.guess[i] = total


@inlined
def carried(value: float, lost: float, change: float) -> tuple[float, float]:
    """A sum with the rounding of each addition kept (Kahan)."""
    change += lost
    total = value + change
    return total, change - (total - value)


@inlined
def first_window(speed: float, acceleration: float, duration: float, controls: Controls) -> float:
    """Time in which the crank turns a little."""
    rate = max(abs(speed), math.sqrt(abs(acceleration) * controls.first_angle))
    return min(duration, controls.first_angle / rate) if rate > 0.0 else duration


@inlined
def growth_for(error: float, tolerance: float, n: int, controls: Controls) -> float:
    """By how much the next window may be longer."""
    growth = controls.safety * math.pow(tolerance / max(error, TINY), 1.0 / n)
    return min(max(growth, controls.least_growth), controls.most_growth)


@kernel
def is_stuck(starts: Array, done: int, controls: Controls) -> bool:
    """Whether the latest windows together are short beside one of those before: the motion is running into a wall."""
    count = controls.stuck
    if done == 0 or done % count != 0:
        return False
    recent, longest = float(starts[done] - starts[done - count]), 0.0
    for window in range(max(done - 2 * count, 0), done - count):
        longest = max(longest, float(starts[window + 1] - starts[window]))
    return recent < controls.stuck_share * longest


@kernel
def write(rules: Rules, state: State, length: float, space: Space, angles: Array, speeds: Array) -> State:
    """The series of a window's angle and speed, and the state at its end."""
    angle, angle_lost, speed, speed_lost, turns = state
    n, found = len(rules.nodes), space.found
    product(n, n + 2, rules.angle, found, angles)
    product(n, n + 1, rules.speed, found, speeds)
    for i in range(n + 2):
        angles[i] *= length * length
    for i in range(n + 1):
        speeds[i] *= length
    speeds[0] += speed
    angles[0] += 0.5 * length * speed
    angles[1] += 0.5 * length * speed
    once = twice = 0.0
    for i in range(n):
        once += rules.end_once[i] * found[i]
        twice += rules.end_twice[i] * found[i]
    angle, angle_lost = carried(angle, angle_lost, length * speed + length * length * twice)
    speed, speed_lost = carried(speed, speed_lost, length * once)
    whole = np.trunc(angle / FULL_TURN)
    return angle - whole * FULL_TURN, angle_lost, speed, speed_lost, turns + whole


@entry
def advance(
    tables: Tables,
    design: Array,
    rules: Rules,
    controls: Controls,
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
    stay(tables, design, len(rules.nodes), start[0], start[1], space)
    length = first_window(start[1], space.guess[0], duration, controls)
    longest, time, done, starts[0] = length, 0.0, 0, 0.0
    while time < duration:
        last = length >= controls.all_but * (duration - time)
        length = duration - time if last else length
        angle, _, speed, _, turns = state
        settled = settles(tables, design, rules, controls, (angle, speed, length), rounding, space)
        error = error_of(rules, speed, length, rounding, space) if settled else np.inf
        growth = growth_for(error, tolerance, len(rules.nodes), controls)
        if error <= tolerance:
            base[done] = angle + turns * FULL_TURN
            state = write(rules, state, length, space, angles[done], speeds[done])
            time = duration if last else time + length
            done += 1
            starts[done] = time
            carry_on(rules, growth, space)
            longest = max(longest, length)
        else:
            growth = min(growth, controls.most_retry)
            stay(tables, design, len(rules.nodes), angle, speed, space)
        length *= growth
        lost = length < controls.least_window * longest or time + length == time
        if lost or done == len(base) or is_stuck(starts, done, controls):
            return done if time >= duration else LOST
    return done
