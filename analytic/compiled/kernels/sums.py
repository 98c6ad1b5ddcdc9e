"""Sums over a linkage on a block of crank angles, once its bodies' motion is known: Jeq, ½ Jeq', Q, b and the output.

Formulas are those of ``analytic.dynamics.link_sums``. Each kernel adds one link's or load's part to the rows of sums.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CONSTANT, CRANK_BODY, Tables
from analytic.compiled.kernels import layout
from analytic.compiled.kernels.jit import inlined, kernel
from analytic.compiled.kernels.layout import (
    ANGLE,
    BLOCK,
    BODY,
    DAMPING,
    DDW,
    DW,
    FORCE,
    HALF_DERIVATIVE,
    JEQ,
    LAW,
    LAWS,
    ROW,
    SUMS,
)
from analytic.compiled.kernels.rows import pose, rate, second
from analytic.compiled.kernels.solution import body_at, fill, pair
from analytic.dynamics.link_sums import stretching, weighed
from analytic.kinematics.frames import Rate, dot, minus, point, point_acceleration, point_rate

Array = NDArray[np.float64]
Pair = tuple[float, float]


@inlined
def rate_of(body: Array, i: int, centre: Pair) -> Rate:
    """First derivatives of a body's mass centre and angle."""
    x, y = point_rate(pose(body, i), rate(body, i), centre)
    return x, y, body[DW + i]


@kernel
def add_inertia(n: int, mass: float, centre: Pair, inertia: float, body: Array, sums: Array) -> None:
    """Jeq of a link."""
    for i in range(min(n, BLOCK)):
        first = rate_of(body, i, centre)
        sums[JEQ + i] += weighed(mass, inertia, first, first)


@kernel
def add_half_derivative(n: int, mass: float, centre: Pair, inertia: float, body: Array, sums: Array) -> None:
    """½ Jeq' of a link."""
    for i in range(min(n, BLOCK)):
        x, y = point_acceleration(pose(body, i), rate(body, i), second(body, i), centre)
        other = (x, y, body[DDW + i])
        sums[HALF_DERIVATIVE + i] += weighed(mass, inertia, rate_of(body, i, centre), other)


@kernel
def add_force(n: int, at: Pair, force: Pair, body: Array, sums: Array) -> None:
    """Q of a constant force (weight among them) at a point of a body."""
    for i in range(min(n, BLOCK)):
        sums[FORCE + i] += dot(force, point_rate(pose(body, i), rate(body, i), at))


@kernel
def add_varying_force(n: int, at: Pair, law: Array, body: Array, sums: Array) -> None:
    """Q of a force that depends on the crank angle."""
    for i in range(min(n, BLOCK)):
        sums[FORCE + i] += dot((law[i], law[ROW + i]), point_rate(pose(body, i), rate(body, i), at))


@kernel
def add_torque(n: int, law: Array, body: Array, sums: Array) -> None:
    """Q of a torque on a body."""
    for i in range(min(n, BLOCK)):
        sums[FORCE + i] += law[i] * body[DW + i]


@kernel
def add_spring(
    n: int, p: Pair, q: Pair, stiffness: float, free: float, damping: float, one: Array, two: Array, sums: Array
) -> None:
    """Q of a spring between points p and q of two bodies, of length ``free`` without force, and b of its dashpot."""
    for i in range(min(n, BLOCK)):
        span = minus(point(pose(one, i), p), point(pose(two, i), q))
        rates = minus(point_rate(pose(one, i), rate(one, i), p), point_rate(pose(two, i), rate(two, i), q))
        length, stretch = stretching(span, rates)
        sums[FORCE + i] -= stiffness * (length - free) * stretch
        sums[DAMPING + i] += damping * (stretch * stretch)


@kernel
def add_damper(n: int, coefficient: float, one: Array, two: Array, sums: Array) -> None:
    """Damping b of a rotary damper."""
    for i in range(min(n, BLOCK)):
        relative = one[DW + i] - two[DW + i]
        sums[DAMPING + i] += coefficient * (relative * relative)


@kernel
def place_along(n: int, at: Pair, along: Pair, body: Array, row: Array) -> None:
    """Coordinate of a point of a body along a direction of the ground."""
    for i in range(min(n, BLOCK)):
        row[i] = dot(along, point(pose(body, i), at))


@kernel
def rate_along(n: int, at: Pair, along: Pair, body: Array, row: Array) -> None:
    """Its first derivative over φ."""
    for i in range(min(n, BLOCK)):
        row[i] = dot(along, point_rate(pose(body, i), rate(body, i), at))


@kernel
def second_along(n: int, at: Pair, along: Pair, body: Array, row: Array) -> None:
    """Its second derivative over φ."""
    for i in range(min(n, BLOCK)):
        row[i] = dot(along, point_acceleration(pose(body, i), rate(body, i), second(body, i), at))


@inlined
def tabled_laws(tables: Tables, n: int, work: Array) -> None:
    """Values of the laws that are splines over the crank angle, at the block's angles."""
    curves = tables.curves
    for law in range(len(tables.laws)):
        pieces, components, start = tables.laws[law]
        if pieces == CONSTANT:
            continue
        first, period = curves[start], curves[start + pieces] - curves[start]
        for i in range(n):
            x = work[ANGLE + i]
            x -= period * math.floor((x - first) / period)
            low, high = 0, pieces
            while high - low > 1:
                middle = (low + high) // 2
                if x >= curves[start + middle]:
                    low = middle
                else:
                    high = middle
            x -= curves[start + low]
            at = start + pieces + 1 + 4 * components * low
            for component in range(components):
                c = at + 4 * component
                value = ((curves[c] * x + curves[c + 1]) * x + curves[c + 2]) * x + curves[c + 3]
                work[LAWS + LAW * law + ROW * component + i] = value


@inlined
def constant_laws(tables: Tables, design: Array, n: int, work: Array) -> None:
    """Values of the laws that are constants of the design."""
    for law in range(len(tables.laws)):
        pieces, components, at = tables.laws[law]
        if pieces == CONSTANT:
            for component in range(components):
                start = LAWS + LAW * law + ROW * component
                fill(n, design[at + component], work[start : start + BLOCK])


@inlined
def sum_inertia(tables: Tables, design: Array, n: int, work: Array) -> None:
    """Jeq."""
    sums = work[SUMS:LAWS]
    crank = len(design) - layout.DYAD_CONSTANTS * len(tables.dyads) - 1
    fill(n, design[crank], sums[JEQ : JEQ + BLOCK])
    for number in range(len(tables.masses)):
        body, mass, centre, inertia = tables.masses[number]
        at = body_at(tables, body)
        add_inertia(n, design[mass], pair(design, centre), design[inertia], work[at : at + BODY], sums)


@inlined
def sum_half_derivative(tables: Tables, design: Array, n: int, work: Array) -> None:
    """½ Jeq'; the crank's part of Jeq is a constant."""
    sums = work[SUMS:LAWS]
    fill(n, 0.0, sums[HALF_DERIVATIVE : HALF_DERIVATIVE + BLOCK])
    for number in range(len(tables.masses)):
        body, mass, centre, inertia = tables.masses[number]
        at = body_at(tables, body)
        add_half_derivative(n, design[mass], pair(design, centre), design[inertia], work[at : at + BODY], sums)


@inlined
def sum_weights(tables: Tables, design: Array, n: int, work: Array) -> None:
    """Gravity's part of Q."""
    sums = work[SUMS:LAWS]
    gx, gy = pair(design, tables.gravity[0])
    if gx == 0.0 and gy == 0.0:
        return
    mass, centre = tables.crank[layout.CRANK_MASS], tables.crank[layout.CRANK_CENTRE]
    m, at = design[mass], body_at(tables, CRANK_BODY)
    add_force(n, pair(design, centre), (m * gx, m * gy), work[at : at + BODY], sums)
    for number in range(len(tables.masses)):
        body, mass, centre, _ = tables.masses[number]
        m, at = design[mass], body_at(tables, body)
        add_force(n, pair(design, centre), (m * gx, m * gy), work[at : at + BODY], sums)


@inlined
def sum_forces(tables: Tables, design: Array, n: int, work: Array) -> None:
    """Q and b; the springs and their dashpots have a part in both."""
    sums = work[SUMS:LAWS]
    fill(n, 0.0, sums[FORCE : FORCE + BLOCK])
    fill(n, 0.0, sums[DAMPING : DAMPING + BLOCK])
    sum_weights(tables, design, n, work)
    for number in range(len(tables.forces)):
        body, point, law = tables.forces[number]
        values, at = LAWS + LAW * law, body_at(tables, body)
        add_varying_force(n, pair(design, point), work[values : values + LAW], work[at : at + BODY], sums)
    for number in range(len(tables.torques)):
        body, law = tables.torques[number]
        values, at = LAWS + LAW * law, body_at(tables, body)
        add_torque(n, work[values : values + LAW], work[at : at + BODY], sums)
    for number in range(len(tables.springs)):
        one, at, two, to, stiffness, length, damping = tables.springs[number]
        p, q = pair(design, at), pair(design, to)
        k, free, c = design[stiffness], design[length], design[damping]
        one, two = body_at(tables, one), body_at(tables, two)
        add_spring(n, p, q, k, free, c, work[one : one + BODY], work[two : two + BODY], sums)
    for number in range(len(tables.dampers)):
        one, two, coefficient = tables.dampers[number]
        one, two = body_at(tables, one), body_at(tables, two)
        add_damper(n, design[coefficient], work[one : one + BODY], work[two : two + BODY], sums)


@inlined
def output(tables: Tables, design: Array, n: int, order: int, work: Array) -> None:
    """The output's coordinate along its direction and its derivatives up to an order."""
    body, point, along = tables.output
    place, (x, y) = pair(design, point), pair(design, along)
    length = math.hypot(x, y)
    direction = (x / length, y / length)
    at = body_at(tables, body)
    rows, sums = work[at : at + BODY], work[SUMS:LAWS]
    place_along(n, place, direction, rows, sums[layout.OUTPUT : layout.OUTPUT + ROW])
    if order >= 1:
        rate_along(n, place, direction, rows, sums[layout.OUTPUT_RATE : layout.OUTPUT_RATE + ROW])
    if order >= 2:
        second_along(n, place, direction, rows, sums[layout.OUTPUT_SECOND : layout.OUTPUT_SECOND + ROW])
