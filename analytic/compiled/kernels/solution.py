"""All bodies of a linkage on a block of crank angles: the crank, then dyad after dyad."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CRANK_BODY, RPP, RPR, RRP, RRR, Integers, Tables
from analytic.compiled.kernels import layout
from analytic.compiled.kernels.dyads import solve_prp, solve_rpp, solve_rpr, solve_rrp, solve_rrr
from analytic.compiled.kernels.jit import counting, inlined, kernel
from analytic.compiled.kernels.layout import BLOCK, BODY, COSINE, DDX, DDY, DX, DY, FAULT, LAW, LAWS, SINE, SUMS
from analytic.compiled.kernels.rows import put_pose
from analytic.kinematics import frames

Array = NDArray[np.float64]
Pair = tuple[float, float]


@inlined
def body_at(tables: Tables, body: int) -> int:
    """Where a body's rows start in the scratch memory."""
    return LAWS + LAW * len(tables.laws) + BODY * body


@inlined
def pair(design: Array, at: int) -> Pair:
    """A vector of the design."""
    return design[at], design[at + 1]


@kernel
def fill(n: int, value: float, row: Array) -> None:
    """One value at every angle."""
    for i in range(min(n, BLOCK)):
        row[i] = value


@kernel
def place_crank(n: int, pivot: Pair, pin: Pair, block: Array, own: Array) -> None:
    """The crank turns about a fixed pin, its point ``pin``, at the angle itself."""
    for i in range(min(n, BLOCK)):
        c, s = block[COSINE + i], block[SINE + i]
        put_pose(own, i, frames.pose_through(pivot, (c, s), pin))
        x, y = frames.rotated(c, s, pin)
        own[DX + i], own[DY + i], own[DDX + i], own[DDY + i] = y, -x, x, y


@kernel
def solve_dyad(kind: int, level: int, n: int, k: Array, one: Array, two: Array, own: Array, fault: Array) -> None:
    """Poses of a dyad's two links and their derivatives up to an order."""
    if kind == RRR:
        solve_rrr(level, n, k, one, two, own, fault)
    elif kind == RRP:
        solve_rrp(level, n, k, one, two, own, fault)
    elif kind == RPR:
        solve_rpr(level, n, k, one, two, own, fault)
    elif kind == RPP:
        solve_rpp(level, n, k, one, two, own, fault)
    else:
        solve_prp(level, n, k, one, two, own, fault)


@inlined
def solve(tables: Tables, design: Array, n: int, levels: Integers, work: Array) -> None:
    """All bodies up to the orders asked for, at angles whose cosines and sines are known; faults are marked."""
    start = len(design) - layout.CRANK_CONSTANTS - layout.DYAD_CONSTANTS * len(tables.dyads)
    near = tables.crank[layout.CRANK_NEAR]
    fault = work[FAULT : FAULT + BLOCK]
    fill(n, 0.0, fault)
    at = body_at(tables, CRANK_BODY)
    place_crank(n, pair(design, near), pair(design, start), work[:SUMS], work[at : at + BODY])
    for number in range(len(tables.dyads)):
        if levels[number] >= 0:
            dyad = tables.dyads[number]
            at = start + layout.CRANK_CONSTANTS + layout.DYAD_CONSTANTS * number
            k = design[at : at + layout.DYAD_CONSTANTS]
            one, two = body_at(tables, dyad[layout.NEAR_ONE]), body_at(tables, dyad[layout.NEAR_TWO])
            at = body_at(tables, CRANK_BODY + 1 + 2 * number)
            near_one, near_two, own = work[one : one + BODY], work[two : two + BODY], work[at : at + 2 * BODY]
            solve_dyad(dyad[layout.KIND], levels[number], n, k, near_one, near_two, own, fault)


@counting
def faults(n: int, fault: Array) -> float:
    """At how many angles there is no motion."""
    total = 0.0
    for i in range(n):
        total += fault[i]
    return total
