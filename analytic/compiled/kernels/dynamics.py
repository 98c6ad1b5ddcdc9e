"""What a rigid crank feels of links, loads and springs, on blocks of crank angles, once the bodies' motion is known.

Formulas are those of ``analytic.dynamics.reduced``. Each kernel adds one link's or load's part to the rows of sums;
places in ``design`` are those of ``analytic.compiled.flat_linkage.Tables``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import kernel
from analytic.compiled.kernels.layout import BLOCK, DAMPING, DDW, DW, DX, DY, FORCE, HALF_SLOPE, JEQ, ROW, C, S, X, Y
from analytic.compiled.kernels.turning import arm, carried

Array = NDArray[np.float64]
Pair = tuple[float, float]


@kernel
def add_inertia(n: int, mass: float, x: float, y: float, inertia: float, body: Array, sums: Array) -> None:
    """Jeq: m |S'|² + J θ'² of a link with its mass centre at (x, y)."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        w = body[DW + i]
        vx, vy = body[DX + i] - w * ry, body[DY + i] + w * rx
        sums[JEQ + i] += mass * (vx * vx + vy * vy) + inertia * (w * w)


@kernel
def add_half_slope(n: int, mass: float, x: float, y: float, inertia: float, body: Array, sums: Array) -> None:
    """½ Jeq': m S'·S'' + J θ' θ'' of a link with its mass centre at (x, y)."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        w = body[DW + i]
        vx, vy = body[DX + i] - w * ry, body[DY + i] + w * rx
        ax, ay = carried(body, i, rx, ry)
        sums[HALF_SLOPE + i] += mass * (vx * ax + vy * ay) + inertia * (w * body[DDW + i])


@kernel
def add_force(n: int, x: float, y: float, fx: float, fy: float, body: Array, sums: Array) -> None:
    """Q of a constant force (weight among them) at the point (x, y) of a body."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        w = body[DW + i]
        sums[FORCE + i] += fx * (body[DX + i] - w * ry) + fy * (body[DY + i] + w * rx)


@kernel
def add_varying_force(n: int, x: float, y: float, law: Array, body: Array, sums: Array) -> None:
    """Q of a force that depends on the crank angle, at the point (x, y) of a body."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        w = body[DW + i]
        sums[FORCE + i] += law[i] * (body[DX + i] - w * ry) + law[ROW + i] * (body[DY + i] + w * rx)


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
    (x1, y1), (x2, y2) = p, q
    for i in range(min(n, BLOCK)):
        rx, ry = arm(one[C + i], one[S + i], x1, y1)
        qx, qy = arm(two[C + i], two[S + i], x2, y2)
        dx, dy = one[X + i] + rx - (two[X + i] + qx), one[Y + i] + ry - (two[Y + i] + qy)
        w, v = one[DW + i], two[DW + i]
        ux, uy = one[DX + i] - w * ry - (two[DX + i] - v * qy), one[DY + i] + w * rx - (two[DY + i] + v * qx)
        length = math.sqrt(dx * dx + dy * dy)
        rate = (dx * ux + dy * uy) / length
        rate = rate if length > 0.0 else 0.0
        sums[FORCE + i] -= stiffness * (length - free) * rate
        sums[DAMPING + i] += damping * (rate * rate)


@kernel
def add_damper(n: int, coefficient: float, one: Array, two: Array, sums: Array) -> None:
    """Damping b of a rotary damper."""
    for i in range(min(n, BLOCK)):
        relative = one[DW + i] - two[DW + i]
        sums[DAMPING + i] += coefficient * (relative * relative)


@kernel
def place_along(n: int, x: float, y: float, ex: float, ey: float, body: Array, row: Array) -> None:
    """Coordinate of the point (x, y) of a body along a direction of the ground."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        row[i] = ex * (body[X + i] + rx) + ey * (body[Y + i] + ry)


@kernel
def rate_along(n: int, x: float, y: float, ex: float, ey: float, body: Array, row: Array) -> None:
    """Its first derivative over φ."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        w = body[DW + i]
        row[i] = ex * (body[DX + i] - w * ry) + ey * (body[DY + i] + w * rx)


@kernel
def second_along(n: int, x: float, y: float, ex: float, ey: float, body: Array, row: Array) -> None:
    """Its second derivative over φ."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        ax, ay = carried(body, i, rx, ry)
        row[i] = ex * ax + ey * ay
