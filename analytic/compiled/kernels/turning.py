"""The dyads with two assembly modes on blocks of crank angles: RRR, RRP and RPR.

Formulas, names and the three steps are those of ``analytic.kinematics.turning_dyads``. A step takes the number of
angles ``n``, the dyad's constants ``k`` (``analytic.compiled.kernels.constants``), the rows of the bodies its outer
joints hang on, and the dyad's own rows, which it fills. Rows come as separate arrays because the compiler must not take
them for one.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import inlined, kernel
from analytic.compiled.kernels.layout import BLOCK, DDW, DDX, DDY, DW, DX, DY, KEPT, SECOND, C, S, X, Y
from analytic.kinematics.dyad_solver import LEAST_SINE, ROUNDING

Array = NDArray[np.float64]
Pair = tuple[float, float]

# Rows kept by RRR: r, q and the determinant; by RRP: r, e, C, determinant, scale and slide; by RPR: e, determinant and
# slide. ``scale`` is the determinant's reciprocal.
K0, K1, K2, K3, K4, K5, K6, K7, K8, K9 = KEPT


@inlined
def arm(c: float, s: float, x: float, y: float) -> Pair:
    """A vector of a body's frame in the ground frame."""
    return c * x - s * y, s * x + c * y


@kernel
def rrr_poses(n: int, k: Array, near_a: Array, near_b: Array, own: Array) -> None:
    """Two circles: A + r = B + q with |r| and |q| given."""
    ax, ay, bx, by, fax, fay, fbx, fby = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]
    spread, gap, difference, half_sign = k[8], k[9], k[10], k[11]
    onex, oney, twox, twoy = k[12], k[13], k[14], k[15]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[X + i] + rx, near_a[Y + i] + ry
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        x2, y2 = near_b[X + i] + rx, near_b[Y + i] + ry
        dx, dy = x2 - x1, y2 - y1
        square = dx * dx + dy * dy
        radicand = (spread - square) * (square - gap)
        determinant = half_sign * math.sqrt(max(radicand, 0.0))
        inverse = 1.0 / square
        along = 0.5 + difference * inverse
        across = determinant * inverse
        rx, ry = along * dx - across * dy, along * dy + across * dx
        qx, qy = rx + x1 - x2, ry + y1 - y2
        c1, s1 = rx * onex + ry * oney, ry * onex - rx * oney
        c2, s2 = qx * twox + qy * twoy, qy * twox - qx * twoy
        own[K0 + i], own[K1 + i], own[K2 + i], own[K3 + i], own[K4 + i] = rx, ry, qx, qy, determinant
        rx, ry = arm(c1, s1, fax, fay)
        own[X + i], own[Y + i], own[C + i], own[S + i] = x1 - rx, y1 - ry, c1, s1
        rx, ry = arm(c2, s2, fbx, fby)
        own[SECOND + X + i], own[SECOND + Y + i] = x2 - rx, y2 - ry
        own[SECOND + C + i], own[SECOND + S + i] = c2, s2


@kernel
def rrr_rates(n: int, k: Array, near_a: Array, near_b: Array, own: Array, fault: Array) -> None:
    """A' + θ1' r⊥ = B' + θ2' q⊥; a fault where A, B and C are in one line."""
    ax, ay, bx, by, fax, fay, fbx, fby = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]
    least = k[16]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[DX + i] - near_a[DW + i] * ry, near_a[DY + i] + near_a[DW + i] * rx
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        x2, y2 = near_b[DX + i] - near_b[DW + i] * ry, near_b[DY + i] + near_b[DW + i] * rx
        dx, dy = x2 - x1, y2 - y1
        determinant = own[K4 + i]
        scale = 1.0 / determinant
        w1 = (dx * own[K2 + i] + dy * own[K3 + i]) * scale
        w2 = (dx * own[K0 + i] + dy * own[K1 + i]) * scale
        fault[i] = fault[i] if abs(determinant) > least else 1.0
        own[K5 + i] = scale
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        own[DX + i], own[DY + i], own[DW + i] = x1 + w1 * ry, y1 - w1 * rx, w1
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], fbx, fby)
        own[SECOND + DX + i], own[SECOND + DY + i], own[SECOND + DW + i] = x2 + w2 * ry, y2 - w2 * rx, w2


@inlined
def carried(row: Array, i: int, rx: float, ry: float) -> Pair:
    """Second derivative of a body's point at the arm (rx, ry)."""
    w = row[DW + i]
    square, turn = w * w, row[DDW + i]
    return row[DDX + i] - turn * ry - square * rx, row[DDY + i] + turn * rx - square * ry


@kernel
def rrr_accelerations(n: int, k: Array, near_a: Array, near_b: Array, own: Array) -> None:
    """A'' + θ1'' r⊥ - θ1'² r = B'' + θ2'' q⊥ - θ2'² q."""
    ax, ay, bx, by, fax, fay, fbx, fby = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = carried(near_a, i, rx, ry)
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        x2, y2 = carried(near_b, i, rx, ry)
        rx, ry, qx, qy, scale = own[K0 + i], own[K1 + i], own[K2 + i], own[K3 + i], own[K5 + i]
        one, two = own[DW + i] * own[DW + i], own[SECOND + DW + i] * own[SECOND + DW + i]
        gx, gy = x2 - x1 + one * rx - two * qx, y2 - y1 + one * ry - two * qy
        turn1, turn2 = (gx * qx + gy * qy) * scale, (gx * rx + gy * ry) * scale
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        own[DDX + i], own[DDY + i], own[DDW + i] = x1 + turn1 * ry + one * rx, y1 - turn1 * rx + one * ry, turn1
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], fbx, fby)
        own[SECOND + DDX + i], own[SECOND + DDY + i] = x2 + turn2 * ry + two * rx, y2 - turn2 * rx + two * ry
        own[SECOND + DDW + i] = turn2


@kernel
def rrr_faults(n: int, k: Array, near_a: Array, near_b: Array, own: Array, fault: Array) -> None:
    """A fault where the two circles miss each other by more than a rounding."""
    ax, ay, bx, by, reach, least = k[0], k[1], k[2], k[3], k[17], k[18]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[X + i] + rx, near_a[Y + i] + ry
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        x2, y2 = near_b[X + i] + rx, near_b[Y + i] + ry
        dx, dy = x2 - x1, y2 - y1
        square = dx * dx + dy * dy
        slack = ROUNDING * (abs(x1) + abs(y1) + abs(x2) + abs(y2) + reach)
        most, nearest = reach + slack, max(least - slack, 0.0)
        meets = (square <= most * most) & (square >= nearest * nearest) & (square > 0.0)
        fault[i] = fault[i] if meets else 1.0


@kernel
def rrp_poses(n: int, k: Array, near_a: Array, host: Array, own: Array) -> None:
    """A circle and a line: A + r = base + t e with |r| given."""
    ax, ay, fax, fay, onex, oney = k[0], k[1], k[2], k[3], k[4], k[5]
    length, sign, ex, ey, tx, ty, bx, by, cx, cy = k[6], k[7], k[8], k[9], k[10], k[11], k[12], k[13], k[14], k[15]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[X + i] + rx, near_a[Y + i] + ry
        c, s = host[C + i], host[S + i]
        rx, ry = arm(c, s, bx, by)
        gx, gy = host[X + i] + rx - x1, host[Y + i] + ry - y1
        dx, dy = arm(c, s, ex, ey)
        offset = dx * gy - dy * gx
        radicand = (length - offset) * (length + offset)
        along = sign * math.sqrt(max(radicand, 0.0))
        rx, ry = along * dx - offset * dy, along * dy + offset * dx
        x2, y2 = x1 + rx, y1 + ry
        own[K0 + i], own[K1 + i], own[K2 + i], own[K3 + i] = rx, ry, dx, dy
        own[K4 + i], own[K5 + i], own[K6 + i] = x2, y2, along
        c1, s1 = rx * onex + ry * oney, ry * onex - rx * oney
        rx, ry = arm(c1, s1, fax, fay)
        own[X + i], own[Y + i], own[C + i], own[S + i] = x1 - rx, y1 - ry, c1, s1
        c2, s2 = arm(c, s, tx, ty)
        rx, ry = arm(c2, s2, cx, cy)
        own[SECOND + X + i], own[SECOND + Y + i] = x2 - rx, y2 - ry
        own[SECOND + C + i], own[SECOND + S + i] = c2, s2


@kernel
def rrp_rates(n: int, k: Array, near_a: Array, host: Array, own: Array, fault: Array) -> None:
    """A' + θ' r⊥ = carried' + t' e, carried' that of the host's point at C; a fault where r is square to e."""
    ax, ay, fax, fay, cx, cy, least = k[0], k[1], k[2], k[3], k[14], k[15], k[16]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[DX + i] - near_a[DW + i] * ry, near_a[DY + i] + near_a[DW + i] * rx
        turn = host[DW + i]
        x2, y2 = (
            host[DX + i] - turn * (own[K5 + i] - host[Y + i]),
            host[DY + i] + turn * (own[K4 + i] - host[X + i]),
        )
        dx, dy = x2 - x1, y2 - y1
        rx, ry, ex, ey, determinant = own[K0 + i], own[K1 + i], own[K2 + i], own[K3 + i], own[K6 + i]
        scale = 1.0 / determinant
        w = (ex * dy - ey * dx) * scale
        slide = w * (rx * ey - ry * ex) - (dx * ex + dy * ey)
        x2, y2 = x2 + slide * ex, y2 + slide * ey
        fault[i] = fault[i] if abs(determinant) > least else 1.0
        own[K7 + i], own[K8 + i] = scale, slide
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        own[DX + i], own[DY + i], own[DW + i] = x1 + w * ry, y1 - w * rx, w
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], cx, cy)
        own[SECOND + DX + i], own[SECOND + DY + i], own[SECOND + DW + i] = x2 + turn * ry, y2 - turn * rx, turn


@kernel
def rrp_accelerations(n: int, k: Array, near_a: Array, host: Array, own: Array) -> None:
    """The same once more, with the Coriolis term 2 θ_host' t' e⊥ of sliding on a turning host."""
    ax, ay, fax, fay, cx, cy = k[0], k[1], k[2], k[3], k[14], k[15]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = carried(near_a, i, rx, ry)
        ex, ey, scale = own[K2 + i], own[K3 + i], own[K7 + i]
        x2, y2 = carried(host, i, own[K4 + i] - host[X + i], own[K5 + i] - host[Y + i])
        turn, second = host[DW + i], host[DDW + i]
        coriolis = 2.0 * turn * own[K8 + i]
        x2, y2 = x2 - coriolis * ey, y2 + coriolis * ex
        rx, ry = own[K0 + i], own[K1 + i]
        square = own[DW + i] * own[DW + i]
        dx, dy = x2 - x1 + square * rx, y2 - y1 + square * ry
        turned = (ex * dy - ey * dx) * scale
        slide = turned * (rx * ey - ry * ex) - (dx * ex + dy * ey)
        x2, y2 = x2 + slide * ex, y2 + slide * ey
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        own[DDX + i], own[DDY + i] = x1 + turned * ry + square * rx, y1 - turned * rx + square * ry
        own[DDW + i] = turned
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], cx, cy)
        square = turn * turn
        own[SECOND + DDX + i], own[SECOND + DDY + i] = x2 + second * ry + square * rx, y2 - second * rx + square * ry
        own[SECOND + DDW + i] = second


@kernel
def rrp_faults(n: int, k: Array, near_a: Array, host: Array, own: Array, fault: Array) -> None:
    """A fault where the circle misses the line by more than a rounding."""
    ax, ay, bx, by, length = k[0], k[1], k[12], k[13], k[6]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[X + i] + rx, near_a[Y + i] + ry
        rx, ry = arm(host[C + i], host[S + i], bx, by)
        x2, y2 = host[X + i] + rx, host[Y + i] + ry
        most = length + ROUNDING * (abs(x1) + abs(y1) + abs(x2) + abs(y2) + length)
        meets = own[K0 + i] * own[K0 + i] + own[K1 + i] * own[K1 + i] <= most * most
        fault[i] = fault[i] if meets else 1.0


@kernel
def rpr_poses(n: int, k: Array, near_a: Array, near_b: Array, own: Array) -> None:
    """A line of the second link at a fixed offset from B passes through A: d = A - B = t e + offset e⊥."""
    ax, ay, bx, by, fax, fay, fbx, fby = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]
    offset, sign, lx, ly, tx, ty = k[8], k[9], k[10], k[11], k[12], k[13]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[X + i] + rx, near_a[Y + i] + ry
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        x2, y2 = near_b[X + i] + rx, near_b[Y + i] + ry
        dx, dy = x1 - x2, y1 - y2
        square = dx * dx + dy * dy
        along = sign * math.sqrt(max(square - offset * offset, 0.0))
        inverse = 1.0 / square
        ex, ey = (along * dx + offset * dy) * inverse, (along * dy - offset * dx) * inverse
        own[K0 + i], own[K1 + i], own[K2 + i] = ex, ey, along
        c2, s2 = ex * lx + ey * ly, ey * lx - ex * ly
        rx, ry = arm(c2, s2, fbx, fby)
        own[SECOND + X + i], own[SECOND + Y + i] = x2 - rx, y2 - ry
        own[SECOND + C + i], own[SECOND + S + i] = c2, s2
        c1, s1 = arm(c2, s2, tx, ty)
        rx, ry = arm(c1, s1, fax, fay)
        own[X + i], own[Y + i], own[C + i], own[S + i] = x1 - rx, y1 - ry, c1, s1


@kernel
def rpr_rates(n: int, k: Array, near_a: Array, near_b: Array, own: Array, fault: Array) -> None:
    """The line turns, d' = t' e + θ' d⊥; a fault where A is at the foot of the perpendicular from B to the line."""
    ax, ay, bx, by, fax, fay, fbx, fby, offset = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7], k[8]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        size = abs(near_a[X + i] + rx) + abs(near_a[Y + i] + ry) + abs(offset)
        x1, y1 = near_a[DX + i] - near_a[DW + i] * ry, near_a[DY + i] + near_a[DW + i] * rx
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        size += abs(near_b[X + i] + rx) + abs(near_b[Y + i] + ry)
        x2, y2 = near_b[DX + i] - near_b[DW + i] * ry, near_b[DY + i] + near_b[DW + i] * rx
        dx, dy = x1 - x2, y1 - y2
        ex, ey, determinant = own[K0 + i], own[K1 + i], own[K2 + i]
        scale = 1.0 / determinant
        w = (ex * dy - ey * dx) * scale
        fault[i] = fault[i] if abs(determinant) > LEAST_SINE * size else 1.0
        own[K3 + i], own[K4 + i] = scale, dx * ex + dy * ey + w * offset
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        own[DX + i], own[DY + i], own[DW + i] = x1 + w * ry, y1 - w * rx, w
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], fbx, fby)
        own[SECOND + DX + i], own[SECOND + DY + i], own[SECOND + DW + i] = x2 + w * ry, y2 - w * rx, w


@kernel
def rpr_accelerations(n: int, k: Array, near_a: Array, near_b: Array, own: Array) -> None:
    """Once more: d'' = t'' e + 2 θ' t' e⊥ + θ'' d⊥ - θ'² d."""
    ax, ay, bx, by, fax, fay, fbx, fby, offset = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7], k[8]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = carried(near_a, i, rx, ry)
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        x2, y2 = carried(near_b, i, rx, ry)
        dx, dy = x1 - x2, y1 - y2
        w = own[DW + i]
        square = w * w
        turn = (own[K0 + i] * dy - own[K1 + i] * dx + w * (w * offset - 2.0 * own[K4 + i])) * own[K3 + i]
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        own[DDX + i], own[DDY + i], own[DDW + i] = x1 + turn * ry + square * rx, y1 - turn * rx + square * ry, turn
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], fbx, fby)
        own[SECOND + DDX + i], own[SECOND + DDY + i] = x2 + turn * ry + square * rx, y2 - turn * rx + square * ry
        own[SECOND + DDW + i] = turn


@kernel
def rpr_faults(n: int, k: Array, near_a: Array, near_b: Array, own: Array, fault: Array) -> None:
    """A fault where A is nearer to B than the line is, or on it, so that the line has no direction."""
    ax, ay, bx, by, offset = k[0], k[1], k[2], k[3], abs(k[8])
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[X + i] + rx, near_a[Y + i] + ry
        rx, ry = arm(near_b[C + i], near_b[S + i], bx, by)
        x2, y2 = near_b[X + i] + rx, near_b[Y + i] + ry
        dx, dy = x1 - x2, y1 - y2
        slack = ROUNDING * (abs(x1) + abs(y1) + abs(x2) + abs(y2) + offset)
        nearest = max(offset - slack, 0.0) if offset > 0.0 else slack
        fault[i] = fault[i] if dx * dx + dy * dy > nearest * nearest else 1.0
