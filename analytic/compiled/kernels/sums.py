"""Sums over a whole linkage on a block of crank angles: Jeq, ½ Jeq', Q, b and the output."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CONSTANT, CRANK_BODY, Tables
from analytic.compiled.kernels import dynamics, layout
from analytic.compiled.kernels.jit import inlined
from analytic.compiled.kernels.layout import (
    ANGLE,
    BLOCK,
    BODY,
    DAMPING,
    FORCE,
    HALF_DERIVATIVE,
    JEQ,
    LAW,
    LAWS,
    ROW,
    SUMS,
)
from analytic.compiled.kernels.solution import body_at, fill, pair

Array = NDArray[np.float64]


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
        dynamics.add_inertia(n, design[mass], pair(design, centre), design[inertia], work[at : at + BODY], sums)


@inlined
def sum_half_derivative(tables: Tables, design: Array, n: int, work: Array) -> None:
    """½ Jeq'; the crank's part of Jeq is a constant."""
    sums = work[SUMS:LAWS]
    fill(n, 0.0, sums[HALF_DERIVATIVE : HALF_DERIVATIVE + BLOCK])
    for number in range(len(tables.masses)):
        body, mass, centre, inertia = tables.masses[number]
        at = body_at(tables, body)
        dynamics.add_half_derivative(n, design[mass], pair(design, centre), design[inertia], work[at : at + BODY], sums)


@inlined
def sum_weights(tables: Tables, design: Array, n: int, work: Array) -> None:
    """Gravity's part of Q."""
    sums = work[SUMS:LAWS]
    gx, gy = pair(design, tables.gravity[0])
    if gx == 0.0 and gy == 0.0:
        return
    mass, centre = tables.crank[layout.CRANK_MASS], tables.crank[layout.CRANK_CENTRE]
    m, at = design[mass], body_at(tables, CRANK_BODY)
    dynamics.add_force(n, pair(design, centre), (m * gx, m * gy), work[at : at + BODY], sums)
    for number in range(len(tables.masses)):
        body, mass, centre, _ = tables.masses[number]
        m, at = design[mass], body_at(tables, body)
        dynamics.add_force(n, pair(design, centre), (m * gx, m * gy), work[at : at + BODY], sums)


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
        dynamics.add_varying_force(n, pair(design, point), work[values : values + LAW], work[at : at + BODY], sums)
    for number in range(len(tables.torques)):
        body, law = tables.torques[number]
        values, at = LAWS + LAW * law, body_at(tables, body)
        dynamics.add_torque(n, work[values : values + LAW], work[at : at + BODY], sums)
    for number in range(len(tables.springs)):
        one, at, two, to, stiffness, length, damping = tables.springs[number]
        p, q = pair(design, at), pair(design, to)
        k, free, c = design[stiffness], design[length], design[damping]
        one, two = body_at(tables, one), body_at(tables, two)
        dynamics.add_spring(n, p, q, k, free, c, work[one : one + BODY], work[two : two + BODY], sums)
    for number in range(len(tables.dampers)):
        one, two, coefficient = tables.dampers[number]
        one, two = body_at(tables, one), body_at(tables, two)
        dynamics.add_damper(n, design[coefficient], work[one : one + BODY], work[two : two + BODY], sums)


@inlined
def output(tables: Tables, design: Array, n: int, order: int, work: Array) -> None:
    """The output's coordinate along its direction and its derivatives up to an order."""
    body, point, along = tables.output
    place, (x, y) = pair(design, point), pair(design, along)
    length = math.hypot(x, y)
    direction = (x / length, y / length)
    at = body_at(tables, body)
    rows, sums = work[at : at + BODY], work[SUMS:LAWS]
    dynamics.place_along(n, place, direction, rows, sums[layout.OUTPUT : layout.OUTPUT + ROW])
    if order >= 1:
        dynamics.rate_along(n, place, direction, rows, sums[layout.OUTPUT_RATE : layout.OUTPUT_RATE + ROW])
    if order >= 2:
        dynamics.second_along(n, place, direction, rows, sums[layout.OUTPUT_SECOND : layout.OUTPUT_SECOND + ROW])
