"""Points and angles of bodies on a block of crank angles, written out with their derivatives over φ."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import kernel
from analytic.compiled.kernels.layout import BLOCK, DDW, DW, DX, DY, C, S, X, Y
from analytic.compiled.kernels.trigonometry import arctangents
from analytic.compiled.kernels.turning import arm, carried

Array = NDArray[np.float64]

HALF_TURN: Final = math.pi


@kernel
def place(n: int, x: float, y: float, body: Array, first: Array, second: Array) -> None:
    """Coordinates of the point (x, y) of a body."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        first[i], second[i] = body[X + i] + rx, body[Y + i] + ry


@kernel
def place_rate(n: int, x: float, y: float, body: Array, first: Array, second: Array) -> None:
    """Their first derivatives."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        w = body[DW + i]
        first[i], second[i] = body[DX + i] - w * ry, body[DY + i] + w * rx


@kernel
def place_second(n: int, x: float, y: float, body: Array, first: Array, second: Array) -> None:
    """Their second derivatives."""
    for i in range(min(n, BLOCK)):
        rx, ry = arm(body[C + i], body[S + i], x, y)
        first[i], second[i] = carried(body, i, rx, ry)


@kernel
def trace(n: int, point: tuple[float, float], body: Array, at: int, places: Array) -> None:
    """A point's coordinates from the angle ``at`` on and their derivatives, into ``places`` (orders, 2, angles)."""
    x, y = point
    place(n, x, y, body, places[0, 0, at : at + n], places[0, 1, at : at + n])
    if len(places) > 1:
        place_rate(n, x, y, body, places[1, 0, at : at + n], places[1, 1, at : at + n])
    if len(places) > 2:
        place_second(n, x, y, body, places[2, 0, at : at + n], places[2, 1, at : at + n])


@kernel
def copied(n: int, row: Array, result: Array) -> None:
    """Write out a row; assigning slices would look for overlaps and allocate."""
    for i in range(min(n, BLOCK)):
        result[i] = row[i]


@kernel
def turn(n: int, body: Array, at: int, turns: Array) -> None:
    """A body's angle in [-π, π] from the angle ``at`` on and its derivatives, into ``turns`` (orders, angles)."""
    arctangents(n, body[S : S + BLOCK], body[C : C + BLOCK], turns[0, at : at + n])
    if len(turns) > 1:
        copied(n, body[DW : DW + BLOCK], turns[1, at : at + n])
    if len(turns) > 2:
        copied(n, body[DDW : DDW + BLOCK], turns[2, at : at + n])


@kernel
def unwrap(angle: Array, start: int, stop: int) -> None:
    """Shift angles in [-π, π] by whole turns to within half a turn of the one before."""
    shift, before = 0.0, angle[start]
    for i in range(start, stop):
        here = angle[i]
        if here - before > HALF_TURN:
            shift -= 2.0 * HALF_TURN
        elif here - before < -HALF_TURN:
            shift += 2.0 * HALF_TURN
        before = here
        angle[i] = here + shift
