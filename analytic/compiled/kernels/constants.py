"""From a linkage's own numbers to the constants its dyads need: arm lengths, offsets, places on rails.

They are worked out once per design, by the formulas in the constructors of ``analytic.kinematics.turning_dyads`` and
``analytic.kinematics.sliding_dyads``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import PRP, RPP, RPR, RRP, RRR, Integers, Tables
from analytic.compiled.kernels.jit import inlined, kernel
from analytic.compiled.kernels.layout import (
    ALONG,
    ANCHOR,
    CRANK_CENTRE,
    CRANK_CONSTANTS,
    CRANK_FAR,
    CRANK_INERTIA,
    CRANK_MASS,
    DYAD_CONSTANTS,
    FAR_POINT,
    FIRST_JOINT,
    FROM_SLIDER,
    INNER_JOINT,
    KIND,
    NEAR_POINT,
    SECOND_JOINT,
    SIGN,
    THROUGH,
)
from analytic.kinematics.dyad_solver import LEAST_SINE

Array = NDArray[np.float64]
Pair = tuple[float, float]
Rail = tuple[float, float, float, float, float, float]


@inlined
def _vector(numbers: Array, at: int) -> Pair:
    return numbers[at], numbers[at + 1]


@kernel
def _rail(numbers: Array, dyad: Integers, joint: int) -> Rail:
    """A P joint seen from the near body: along, turn and origin, as ``structure.prismatic_joint`` has them."""
    ex, ey = _vector(numbers, dyad[joint + ALONG])
    length = math.hypot(ex, ey)
    ex, ey = ex / length, ey / length
    ax, ay = _vector(numbers, dyad[joint + ANCHOR])
    px, py = _vector(numbers, dyad[joint + THROUGH])
    ox, oy = px - (ax * ex - ay * ey), py - (ax * ey + ay * ex)
    if dyad[joint + FROM_SLIDER] == 0:
        return ex, ey, ex, ey, ox, oy
    return 1.0, 0.0, ex, -ey, -(ox * ex + oy * ey), ox * ey - oy * ex


@inlined
def _on_rail(rail: Rail, x: float, y: float) -> Pair:
    """A point of the sliding body, in the frame it slides on, at zero travel."""
    _, _, c, s, ox, oy = rail
    return ox + c * x - s * y, oy + s * x + c * y


@inlined
def _put(k: Array, at: int, vector: Pair) -> None:
    k[at], k[at + 1] = vector


@inlined
def _arm(numbers: Array, k: Array, at: int, tip: int, pin: int) -> float:
    """Store a link's arm over its squared length, which turns arms in the ground frame into angles; the length."""
    x, y = numbers[tip] - numbers[pin], numbers[tip + 1] - numbers[pin + 1]
    length = math.hypot(x, y)
    k[at], k[at + 1] = x / (length * length), y / (length * length)
    return length


@kernel
def _rrr(numbers: Array, dyad: Integers, k: Array) -> None:
    a, b, inner = FIRST_JOINT, SECOND_JOINT, INNER_JOINT
    _put(k, 0, _vector(numbers, dyad[a + NEAR_POINT]))
    _put(k, 2, _vector(numbers, dyad[b + NEAR_POINT]))
    _put(k, 4, _vector(numbers, dyad[a + FAR_POINT]))
    _put(k, 6, _vector(numbers, dyad[b + FAR_POINT]))
    first = _arm(numbers, k, 12, dyad[inner + FAR_POINT], dyad[a + FAR_POINT])
    second = _arm(numbers, k, 14, dyad[inner + NEAR_POINT], dyad[b + FAR_POINT])
    total, difference = first + second, first - second
    k[8], k[9], k[10], k[11] = total * total, difference * difference, 0.5 * difference * total, 0.5 * dyad[SIGN]
    k[16], k[17], k[18] = LEAST_SINE * first * second, total, abs(difference)


@kernel
def _rrp(numbers: Array, dyad: Integers, k: Array) -> None:
    a, inner = FIRST_JOINT, INNER_JOINT
    _put(k, 0, _vector(numbers, dyad[a + NEAR_POINT]))
    _put(k, 2, _vector(numbers, dyad[a + FAR_POINT]))
    length = _arm(numbers, k, 4, dyad[inner + FAR_POINT], dyad[a + FAR_POINT])
    k[6], k[7], k[16] = length, dyad[SIGN], LEAST_SINE * length
    rail = _rail(numbers, dyad, SECOND_JOINT)
    k[8], k[9], k[10], k[11] = rail[0], rail[1], rail[2], rail[3]
    x, y = _vector(numbers, dyad[inner + NEAR_POINT])
    _put(k, 12, _on_rail(rail, x, y))
    _put(k, 14, (x, y))


@kernel
def _rpr(numbers: Array, dyad: Integers, k: Array) -> None:
    a, b = FIRST_JOINT, SECOND_JOINT
    _put(k, 0, _vector(numbers, dyad[a + NEAR_POINT]))
    _put(k, 2, _vector(numbers, dyad[b + NEAR_POINT]))
    ax, ay = _vector(numbers, dyad[a + FAR_POINT])
    bx, by = _vector(numbers, dyad[b + FAR_POINT])
    _put(k, 4, (ax, ay))
    _put(k, 6, (bx, by))
    rail = _rail(numbers, dyad, INNER_JOINT)
    x, y = _on_rail(rail, ax, ay)
    k[8], k[9] = rail[0] * (y - by) - rail[1] * (x - bx), dyad[SIGN]
    k[10], k[11], k[12], k[13] = rail[0], rail[1], rail[2], rail[3]


@kernel
def _rpp(numbers: Array, dyad: Integers, k: Array) -> None:
    a = FIRST_JOINT
    _put(k, 0, _vector(numbers, dyad[a + NEAR_POINT]))
    ax, ay = _vector(numbers, dyad[a + FAR_POINT])
    _put(k, 2, (ax, ay))
    rail, inner = _rail(numbers, dyad, SECOND_JOINT), _rail(numbers, dyad, INNER_JOINT)
    k[4], k[5], k[6], k[7], k[8], k[9] = rail
    k[10], k[11], k[12], k[13] = inner[0], inner[1], inner[2], inner[3]
    x, y = _on_rail(inner, ax, ay)
    _put(k, 14, _on_rail(rail, x, y))


@kernel
def _prp(numbers: Array, dyad: Integers, k: Array) -> None:
    at = dyad[INNER_JOINT + FAR_POINT]
    for part, joint in enumerate((FIRST_JOINT, SECOND_JOINT)):
        rail = _rail(numbers, dyad, joint)
        x, y = _vector(numbers, at)
        start = 8 * part
        k[start], k[start + 1], k[start + 2], k[start + 3] = rail[0], rail[1], rail[2], rail[3]
        _put(k, start + 4, _on_rail(rail, x, y))
        _put(k, start + 6, (x, y))
        at = dyad[INNER_JOINT + NEAR_POINT]


@kernel
def derive(tables: Tables, design: Array) -> None:
    """Fill in the constants that follow a design's numbers: those of the crank, then those of each dyad."""
    dyads, crank = tables.dyads, tables.crank
    start = len(design) - CRANK_CONSTANTS - DYAD_CONSTANTS * len(dyads)
    x, y = _vector(design, crank[CRANK_CENTRE])
    fx, fy = _vector(design, crank[CRANK_FAR])
    x, y = x - fx, y - fy
    design[start], design[start + 1] = fx, fy
    design[start + 2] = design[crank[CRANK_MASS]] * (x * x + y * y) + design[crank[CRANK_INERTIA]]
    for number in range(len(dyads)):
        dyad = dyads[number]
        at = start + CRANK_CONSTANTS + DYAD_CONSTANTS * number
        k = design[at : at + DYAD_CONSTANTS]
        if dyad[KIND] == RRR:
            _rrr(design, dyad, k)
        elif dyad[KIND] == RRP:
            _rrp(design, dyad, k)
        elif dyad[KIND] == RPR:
            _rpr(design, dyad, k)
        elif dyad[KIND] == RPP:
            _rpp(design, dyad, k)
        elif dyad[KIND] == PRP:
            _prp(design, dyad, k)
