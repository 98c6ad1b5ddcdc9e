"""Whole arrays of crank angles, and of designs, block by block: what the compiled path calls from Python.

An entry does the angles from ``start`` to ``stop`` only and writes nothing else, so that threads can share its arrays.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import Integers, Tables
from analytic.compiled.kernels import layout
from analytic.compiled.kernels.constants import derive
from analytic.compiled.kernels.jit import SOURCES, counting, entry, inlined, kernel
from analytic.compiled.kernels.layout import ACCELERATION, ANGLE, BLOCK, COSINE, FAULT, FORCE, JEQ, SINE, SPEED, SUMS
from analytic.compiled.kernels.solution import solve
from analytic.compiled.kernels.sums import (
    constant_laws,
    output,
    sum_forces,
    sum_half_derivative,
    sum_inertia,
    tabled_laws,
)
from analytic.compiled.kernels.trigonometry import cosines_and_sines

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]

# Codes of quantities; the first four are sums as they are.
CODES: Final = {"Jeq": 0, "half_slope": 1, "Q": 2, "S": 3, "Mkr": 4, "Teq": 5, "Peq": 6, "v": 7, "a": 8}
STORED: Final = 4
STORED_ROWS: Final = (JEQ, layout.HALF_DERIVATIVE, FORCE, layout.OUTPUT)
ENERGY, POWER, VELOCITY, PULL = CODES["Teq"], CODES["Peq"], CODES["v"], CODES["a"]
# What they are made up of, each with a flag in ``wanted``; the output with the order of its derivative.
WANTED_INERTIA, WANTED_SLOPE, WANTED_FORCES, WANTED_OUTPUT = range(4)


@inlined
def place(n: int, start: int, angle: Array, work: Array) -> None:
    """Copy a block's crank angles, and find the cosines and sines."""
    for i in range(n):
        work[ANGLE + i] = angle[start + i]
    cosines_and_sines(n, work[ANGLE : ANGLE + BLOCK], work[COSINE : COSINE + BLOCK], work[SINE : SINE + BLOCK])


@kernel
def begin(n: int, start: int, angle: Array, speed: Array, acceleration: Array, work: Array) -> None:
    """Copy a block's crank angles and motion, and find the cosines and sines."""
    speed_step, acceleration_step = min(len(speed) - 1, 1), min(len(acceleration) - 1, 1)
    place(n, start, angle, work)
    for i in range(n):
        work[SPEED + i] = speed[speed_step * (start + i)]
    for i in range(n):
        work[ACCELERATION + i] = acceleration[acceleration_step * (start + i)]


@inlined
def steady_torque(sums: Array, speed: float, i: int) -> float:
    """The drive's torque at a constant crank speed."""
    torque: float = sums[layout.HALF_DERIVATIVE + i] * (speed * speed)
    torque = torque - sums[FORCE + i] + sums[layout.DAMPING + i] * speed
    return torque


@kernel
def emit(quantity: int, n: int, block: Array, sums: Array, result: Array) -> None:
    """Write one quantity; formulas are those of ``analytic.evaluation.QUANTITIES``."""
    if quantity < STORED:
        row = STORED_ROWS[quantity]
        for i in range(n):
            result[i] = sums[row + i]
    elif quantity == ENERGY:
        for i in range(n):
            result[i] = 0.5 * sums[JEQ + i] * (block[SPEED + i] * block[SPEED + i])
    elif quantity == VELOCITY:
        for i in range(n):
            result[i] = sums[layout.OUTPUT_RATE + i] * block[SPEED + i]
    elif quantity == PULL:
        for i in range(n):
            speed = block[SPEED + i]
            result[i] = (
                sums[layout.OUTPUT_SECOND + i] * (speed * speed)
                + sums[layout.OUTPUT_RATE + i] * block[ACCELERATION + i]
            )
    else:
        for i in range(n):
            speed = block[SPEED + i]
            torque = sums[JEQ + i] * block[ACCELERATION + i] + steady_torque(sums, speed, i)
            result[i] = torque * speed if quantity == POWER else torque


@counting
def mark(n: int, fault: Array, moving: Booleans) -> float:
    """Note where there is motion; at how many angles there is none."""
    total = 0.0
    for i in range(n):
        moving[i] = fault[i] == 0.0
        total += fault[i]
    return total


@inlined
def sum_wanted(tables: Tables, design: Array, n: int, wanted: Integers, work: Array) -> None:
    """Those sums over the linkage that the quantities asked for are made up of."""
    if wanted[WANTED_INERTIA]:
        sum_inertia(tables, design, n, work)
    if wanted[WANTED_SLOPE]:
        sum_half_derivative(tables, design, n, work)
    if wanted[WANTED_FORCES]:
        constant_laws(tables, design, n, work)
        sum_forces(tables, design, n, work)
    if wanted[WANTED_OUTPUT] >= 0:
        output(tables, design, n, wanted[WANTED_OUTPUT], work)


@entry
def quantities(
    tables: Tables,
    designs: Array,
    first: int,
    angle: Array,
    speed: Array,
    acceleration: Array,
    start: int,
    stop: int,
    levels: Integers,
    wanted: Integers,
    codes: Integers,
    values: Array,
    moving: Booleans,
    work: Array,
    sources: int = SOURCES,
) -> float:
    """Quantities ``codes`` of some designs, whose first has the number ``first``, into ``values`` and ``moving``.

    ``designs`` (count, size) hold numbers, their constants are filled in here; ``speed`` and ``acceleration`` have an
    entry per angle or one for all. ``values`` is (quantities, all designs, angles), ``moving`` (all designs, angles).
    Where a design cannot move its values are nan; returned is the number of such places.
    """
    missing = 0.0
    for number in range(len(designs)):
        derive(tables, designs[number])
    for at in range(start, stop, BLOCK):
        n = min(BLOCK, stop - at)
        begin(n, at, angle, speed, acceleration, work)
        if wanted[WANTED_FORCES]:
            tabled_laws(tables, n, work)
        for number in range(len(designs)):
            design, row = designs[number], first + number
            solve(tables, design, n, levels, work)
            sum_wanted(tables, design, n, wanted, work)
            for place in range(len(codes)):
                emit(codes[place], n, work, work[SUMS:], values[place, row, at : at + n])
            standing = mark(n, work[FAULT : FAULT + BLOCK], moving[row, at : at + n])
            if standing > 0.0:
                missing += standing
                blank(n, at, row, work[FAULT : FAULT + BLOCK], values)
    return missing


@kernel
def blank(n: int, at: int, row: int, fault: Array, values: Array) -> None:
    """No values where there is no motion."""
    for place in range(len(values)):
        for i in range(n):
            if fault[i] != 0.0:
                values[place, row, at + i] = math.nan
