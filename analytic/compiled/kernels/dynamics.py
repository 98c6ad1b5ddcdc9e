"""What a rigid crank feels of links, loads and springs, on blocks of crank angles, once the bodies' motion is known.

Formulas are those of ``analytic.dynamics.link_sums``. Each kernel adds one link's or load's part to the rows of sums.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import inlined, kernel
from analytic.compiled.kernels.layout import BLOCK, DAMPING, DDW, DW, FORCE, HALF_DERIVATIVE, JEQ, ROW
from analytic.compiled.kernels.rows import pose, rate, second
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
