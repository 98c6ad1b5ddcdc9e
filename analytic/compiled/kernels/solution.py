"""All bodies of a linkage on a block of crank angles: the crank, then dyad after dyad."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CRANK_BODY, RPP, RPR, RRP, RRR, Integers, Tables
from analytic.compiled.kernels.jit import counting, inlined, kernel
from analytic.compiled.kernels.layout import (
    BLOCK,
    BODY,
    COSINE,
    CRANK_CONSTANTS,
    CRANK_NEAR,
    DDX,
    DDY,
    DX,
    DY,
    DYAD_CONSTANTS,
    FAULT,
    KIND,
    LAW,
    LAWS,
    NEAR_ONE,
    NEAR_TWO,
    SINE,
    SUMS,
    C,
    S,
    X,
    Y,
)
from analytic.compiled.kernels.sliding import (
    crossing_faults,
    prp_accelerations,
    prp_poses,
    prp_rates,
    rpp_accelerations,
    rpp_poses,
    rpp_rates,
)
from analytic.compiled.kernels.turning import (
    arm,
    rpr_accelerations,
    rpr_faults,
    rpr_poses,
    rpr_rates,
    rrp_accelerations,
    rrp_faults,
    rrp_poses,
    rrp_rates,
    rrr_accelerations,
    rrr_faults,
    rrr_poses,
    rrr_rates,
)

Array = NDArray[np.float64]


@inlined
def body_at(tables: Tables, body: int) -> int:
    """Where a body's rows start in the scratch memory."""
    return LAWS + LAW * len(tables.laws) + BODY * body


@kernel
def fill(n: int, value: float, row: Array) -> None:
    """One value at every angle."""
    for i in range(min(n, BLOCK)):
        row[i] = value


@kernel
def place_crank(n: int, x: float, y: float, fx: float, fy: float, block: Array, own: Array) -> None:
    """The crank turns about a fixed pin, its point (fx, fy), at the angle itself."""
    for i in range(min(n, BLOCK)):
        c, s = block[COSINE + i], block[SINE + i]
        rx, ry = arm(c, s, fx, fy)
        own[X + i], own[Y + i], own[C + i], own[S + i] = x - rx, y - ry, c, s
        own[DX + i], own[DY + i], own[DDX + i], own[DDY + i] = ry, -rx, rx, ry


@kernel
def solve_turning(kind: int, level: int, n: int, k: Array, one: Array, two: Array, own: Array, fault: Array) -> None:
    """Poses of the two links of an RRR, RRP or RPR, and their derivatives up to an order."""
    if kind == RRR:
        rrr_poses(n, k, one, two, own)
        if level == 0:
            rrr_faults(n, k, one, two, own, fault)
        if level >= 1:
            rrr_rates(n, k, one, two, own, fault)
        if level >= 2:
            rrr_accelerations(n, k, one, two, own)
    elif kind == RRP:
        rrp_poses(n, k, one, two, own)
        if level == 0:
            rrp_faults(n, k, one, two, own, fault)
        if level >= 1:
            rrp_rates(n, k, one, two, own, fault)
        if level >= 2:
            rrp_accelerations(n, k, one, two, own)
    else:
        rpr_poses(n, k, one, two, own)
        if level == 0:
            rpr_faults(n, k, one, two, own, fault)
        if level >= 1:
            rpr_rates(n, k, one, two, own, fault)
        if level >= 2:
            rpr_accelerations(n, k, one, two, own)


@kernel
def solve_sliding(kind: int, level: int, n: int, k: Array, one: Array, two: Array, own: Array, fault: Array) -> None:
    """The same of an RPP or PRP."""
    if kind == RPP:
        rpp_poses(n, k, one, two, own)
        if level >= 1:
            rpp_rates(n, k, one, two, own, fault)
        if level >= 2:
            rpp_accelerations(n, k, one, two, own)
    else:
        prp_poses(n, k, one, two, own)
        if level >= 1:
            prp_rates(n, k, one, two, own, fault)
        if level >= 2:
            prp_accelerations(n, k, one, two, own)
    if level == 0:
        crossing_faults(n, own, fault)


@inlined
def solve(tables: Tables, design: Array, n: int, levels: Integers, work: Array) -> None:
    """All bodies up to the orders asked for, at angles whose cosines and sines are known; faults are marked."""
    start = len(design) - CRANK_CONSTANTS - DYAD_CONSTANTS * len(tables.dyads)
    near = tables.crank[CRANK_NEAR]
    fault = work[FAULT : FAULT + BLOCK]
    fill(n, 0.0, fault)
    at = body_at(tables, CRANK_BODY)
    place_crank(n, design[near], design[near + 1], design[start], design[start + 1], work[:SUMS], work[at : at + BODY])
    for number in range(len(tables.dyads)):
        if levels[number] >= 0:
            dyad = tables.dyads[number]
            at = start + CRANK_CONSTANTS + DYAD_CONSTANTS * number
            k = design[at : at + DYAD_CONSTANTS]
            one, two = body_at(tables, dyad[NEAR_ONE]), body_at(tables, dyad[NEAR_TWO])
            at = body_at(tables, CRANK_BODY + 1 + 2 * number)
            near_one, near_two, own = work[one : one + BODY], work[two : two + BODY], work[at : at + 2 * BODY]
            kind, level = dyad[KIND], levels[number]
            if kind <= RPR:
                solve_turning(kind, level, n, k, near_one, near_two, own, fault)
            else:
                solve_sliding(kind, level, n, k, near_one, near_two, own, fault)


@counting
def faults(n: int, fault: Array) -> float:
    """At how many angles there is no motion."""
    total = 0.0
    for i in range(n):
        total += fault[i]
    return total
