"""The dyads with one assembly mode on blocks of crank angles: RPP and PRP.

Formulas, names and the three steps are those of ``analytic.kinematics.sliding_dyads``, arguments those of
``analytic.compiled.kernels.turning``. Both keep the directions e and f of the two lines, the determinant's reciprocal,
the pin's place and the travels along the two lines.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import kernel
from analytic.compiled.kernels.layout import BLOCK, DDW, DDX, DDY, DW, DX, DY, KEPT, SECOND, C, S, X, Y
from analytic.compiled.kernels.turning import arm, carried
from analytic.kinematics.dyad_solver import LEAST_SINE

Array = NDArray[np.float64]

EX, EY, FX, FY, SCALE, PIN_X, PIN_Y, TRAVEL_E, TRAVEL_F, _ = KEPT


@kernel
def rpp_poses(n: int, k: Array, near_a: Array, host: Array, own: Array) -> None:
    """The pin A lies on the second link's line: A = start + t e + u f."""
    ax, ay, fax, fay, lx, ly, tx, ty = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]
    ox, oy, mx, my, ux, uy, sx, sy = k[8], k[9], k[10], k[11], k[12], k[13], k[14], k[15]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[X + i] + rx, near_a[Y + i] + ry
        c, s = host[C + i], host[S + i]
        c2, s2 = arm(c, s, tx, ty)
        fx, fy = arm(c2, s2, mx, my)
        fx, fy = -fx, -fy
        ex, ey = arm(c, s, lx, ly)
        scale = 1.0 / (ex * fy - ey * fx)
        own[EX + i], own[EY + i], own[FX + i], own[FY + i], own[SCALE + i] = ex, ey, fx, fy, scale
        own[PIN_X + i], own[PIN_Y + i] = x1, y1
        rx, ry = arm(c, s, sx, sy)
        gx, gy = x1 - (host[X + i] + rx), y1 - (host[Y + i] + ry)
        slide = (gx * fy - gy * fx) * scale
        rx, ry = arm(c, s, ox, oy)
        own[SECOND + X + i], own[SECOND + Y + i] = host[X + i] + rx + slide * ex, host[Y + i] + ry + slide * ey
        own[SECOND + C + i], own[SECOND + S + i] = c2, s2
        c1, s1 = arm(c2, s2, ux, uy)
        rx, ry = arm(c1, s1, fax, fay)
        own[X + i], own[Y + i], own[C + i], own[S + i] = x1 - rx, y1 - ry, c1, s1


@kernel
def rpp_rates(n: int, k: Array, near_a: Array, host: Array, own: Array, fault: Array) -> None:
    """The pin moves as the host's point under it does, plus the two slides; a fault where the lines are parallel."""
    ax, ay, fax, fay = k[0], k[1], k[2], k[3]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = near_a[DX + i] - near_a[DW + i] * ry, near_a[DY + i] + near_a[DW + i] * rx
        w = host[DW + i]
        gx = x1 - (host[DX + i] - w * (own[PIN_Y + i] - host[Y + i]))
        gy = y1 - (host[DY + i] + w * (own[PIN_X + i] - host[X + i]))
        ex, ey, fx, fy, scale = own[EX + i], own[EY + i], own[FX + i], own[FY + i], own[SCALE + i]
        slide = (gx * fy - gy * fx) * scale
        own[TRAVEL_E + i], own[TRAVEL_F + i] = slide, (gx * ey - gy * ex) * scale
        fault[i] = fault[i] if abs(ex * fy - ey * fx) > LEAST_SINE else 1.0
        own[SECOND + DX + i] = host[DX + i] - w * (own[SECOND + Y + i] - host[Y + i]) + slide * ex
        own[SECOND + DY + i] = host[DY + i] + w * (own[SECOND + X + i] - host[X + i]) + slide * ey
        own[SECOND + DW + i] = w
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        own[DX + i], own[DY + i], own[DW + i] = x1 + w * ry, y1 - w * rx, w


@kernel
def rpp_accelerations(n: int, k: Array, near_a: Array, host: Array, own: Array) -> None:
    """The same once more, with the Coriolis term of both slides on the turning host."""
    ax, ay, fax, fay = k[0], k[1], k[2], k[3]
    for i in range(min(n, BLOCK)):
        rx, ry = arm(near_a[C + i], near_a[S + i], ax, ay)
        x1, y1 = carried(near_a, i, rx, ry)
        x2, y2 = carried(host, i, own[PIN_X + i] - host[X + i], own[PIN_Y + i] - host[Y + i])
        w, turn = host[DW + i], host[DDW + i]
        one, two, ex, ey = own[TRAVEL_E + i], own[TRAVEL_F + i], own[EX + i], own[EY + i]
        fx, fy = own[FX + i], own[FY + i]
        alongx, alongy = one * ex - two * fx, one * ey - two * fy
        gx, gy = x1 - x2 + 2.0 * w * alongy, y1 - y2 - 2.0 * w * alongx
        slide = (gx * fy - gy * fx) * own[SCALE + i]
        x2, y2 = carried(host, i, own[SECOND + X + i] - host[X + i], own[SECOND + Y + i] - host[Y + i])
        own[SECOND + DDX + i] = x2 + slide * ex - 2.0 * w * one * ey
        own[SECOND + DDY + i] = y2 + slide * ey + 2.0 * w * one * ex
        own[SECOND + DDW + i] = turn
        rx, ry = arm(own[C + i], own[S + i], fax, fay)
        square = w * w
        own[DDX + i], own[DDY + i], own[DDW + i] = x1 + turn * ry + square * rx, y1 - turn * rx + square * ry, turn


@kernel
def prp_poses(n: int, k: Array, one: Array, two: Array, own: Array) -> None:
    """The pin C lies where the two lines cross: C = one + t e = two + u f."""
    lx, ly, tx, ty, bx, by, px, py = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]
    mx, my, ux, uy, dx, dy, qx, qy = k[8], k[9], k[10], k[11], k[12], k[13], k[14], k[15]
    for i in range(min(n, BLOCK)):
        ex, ey = arm(one[C + i], one[S + i], lx, ly)
        fx, fy = arm(two[C + i], two[S + i], mx, my)
        scale = 1.0 / (ex * fy - ey * fx)
        rx, ry = arm(one[C + i], one[S + i], bx, by)
        x1, y1 = one[X + i] + rx, one[Y + i] + ry
        rx, ry = arm(two[C + i], two[S + i], dx, dy)
        gx, gy = two[X + i] + rx - x1, two[Y + i] + ry - y1
        slide = (gx * fy - gy * fx) * scale
        x1, y1 = x1 + slide * ex, y1 + slide * ey
        own[EX + i], own[EY + i], own[FX + i], own[FY + i], own[SCALE + i] = ex, ey, fx, fy, scale
        own[PIN_X + i], own[PIN_Y + i] = x1, y1
        c1, s1 = arm(one[C + i], one[S + i], tx, ty)
        rx, ry = arm(c1, s1, px, py)
        own[X + i], own[Y + i], own[C + i], own[S + i] = x1 - rx, y1 - ry, c1, s1
        c2, s2 = arm(two[C + i], two[S + i], ux, uy)
        rx, ry = arm(c2, s2, qx, qy)
        own[SECOND + X + i], own[SECOND + Y + i] = x1 - rx, y1 - ry
        own[SECOND + C + i], own[SECOND + S + i] = c2, s2


@kernel
def prp_rates(n: int, k: Array, one: Array, two: Array, own: Array, fault: Array) -> None:
    """C moves as the point of each host under it, plus that host's slide; a fault where the lines are parallel."""
    px, py, qx, qy = k[6], k[7], k[14], k[15]
    for i in range(min(n, BLOCK)):
        cx, cy, w1, w2 = own[PIN_X + i], own[PIN_Y + i], one[DW + i], two[DW + i]
        x1, y1 = one[DX + i] - w1 * (cy - one[Y + i]), one[DY + i] + w1 * (cx - one[X + i])
        gx = two[DX + i] - w2 * (cy - two[Y + i]) - x1
        gy = two[DY + i] + w2 * (cx - two[X + i]) - y1
        ex, ey, fx, fy, scale = own[EX + i], own[EY + i], own[FX + i], own[FY + i], own[SCALE + i]
        slide = (gx * fy - gy * fx) * scale
        own[TRAVEL_E + i], own[TRAVEL_F + i] = slide, (gx * ey - gy * ex) * scale
        fault[i] = fault[i] if abs(ex * fy - ey * fx) > LEAST_SINE else 1.0
        x1, y1 = x1 + slide * ex, y1 + slide * ey
        rx, ry = arm(own[C + i], own[S + i], px, py)
        own[DX + i], own[DY + i], own[DW + i] = x1 + w1 * ry, y1 - w1 * rx, w1
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], qx, qy)
        own[SECOND + DX + i], own[SECOND + DY + i], own[SECOND + DW + i] = x1 + w2 * ry, y1 - w2 * rx, w2


@kernel
def prp_accelerations(n: int, k: Array, one: Array, two: Array, own: Array) -> None:
    """The same once more, with the Coriolis term of each slide on its host."""
    px, py, qx, qy = k[6], k[7], k[14], k[15]
    for i in range(min(n, BLOCK)):
        cx, cy = own[PIN_X + i], own[PIN_Y + i]
        w1, w2, turn1, turn2 = one[DW + i], two[DW + i], one[DDW + i], two[DDW + i]
        ex, ey, fx, fy = own[EX + i], own[EY + i], own[FX + i], own[FY + i]
        x1, y1 = carried(one, i, cx - one[X + i], cy - one[Y + i])
        coriolis = 2.0 * w1 * own[TRAVEL_E + i]
        x1, y1 = x1 - coriolis * ey, y1 + coriolis * ex
        x2, y2 = carried(two, i, cx - two[X + i], cy - two[Y + i])
        coriolis = 2.0 * w2 * own[TRAVEL_F + i]
        gx, gy = x2 - coriolis * fy - x1, y2 + coriolis * fx - y1
        slide = (gx * fy - gy * fx) * own[SCALE + i]
        x1, y1 = x1 + slide * ex, y1 + slide * ey
        rx, ry = arm(own[C + i], own[S + i], px, py)
        square = w1 * w1
        own[DDX + i], own[DDY + i], own[DDW + i] = x1 + turn1 * ry + square * rx, y1 - turn1 * rx + square * ry, turn1
        rx, ry = arm(own[SECOND + C + i], own[SECOND + S + i], qx, qy)
        square = w2 * w2
        own[SECOND + DDX + i], own[SECOND + DDY + i] = x1 + turn2 * ry + square * rx, y1 - turn2 * rx + square * ry
        own[SECOND + DDW + i] = turn2


@kernel
def crossing_faults(n: int, own: Array, fault: Array) -> None:
    """A fault where the two lines are parallel."""
    for i in range(min(n, BLOCK)):
        sine = own[EX + i] * own[FY + i] - own[EY + i] * own[FX + i]
        fault[i] = fault[i] if abs(sine) > LEAST_SINE else 1.0
