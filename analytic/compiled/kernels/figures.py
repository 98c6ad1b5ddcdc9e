"""Figures of many designs: signals at a block of crank angles, brought down to numbers there and then.

A signal is a row of integers, (kind, three entries that depend on the kind, needed statistics), and a factor.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CRANK_BODY, RPP, RPR, RRP, Integers, Tables
from analytic.compiled.kernels import layout
from analytic.compiled.kernels.constants import derive
from analytic.compiled.kernels.dyads import DETERMINANT, closure_at
from analytic.compiled.kernels.evaluation import WANTED_FORCES, place, steady_torque, sum_wanted
from analytic.compiled.kernels.jit import SOURCES, counting, entry, inlined, kernel
from analytic.compiled.kernels.layout import BLOCK, BODY, FAULT, FORCE, LAWS, ROW, SUMS
from analytic.compiled.kernels.reductions import AT, BASE, FIRST, HIGH, LOW, finished, gather
from analytic.compiled.kernels.solution import body_at, faults, pair, solve
from analytic.compiled.kernels.statics import (
    WRENCH,
    books_at,
    charge_between,
    charge_outside,
    frame_at,
    load_frame,
    solve_joints,
)
from analytic.compiled.kernels.sums import constant_laws, place_along, rate_along, second_along, tabled_laws
from analytic.kinematics.frames import Pair
from analytic.kinematics.transmission import between

Array = NDArray[np.float64]

# Kinds of signals and their entries: a row of the scratch memory; a point's coordinate (body, place, order and axis as
# 2·order + axis); the sum of wrenches (from one to before another of ``Wanted.terms``, component, 3 for the force's
# magnitude); a transmission angle (dyad).
ROWS, POINT, WRENCHES, TRANSMISSION = range(4)
MAGNITUDE: Final = 3
STEEP: Final = 0.6  # ``analytic.designs.dead_positions.KEPT``
# Which forces are wanted, flags.
ON_FRAME, OF_JOINTS = 1, 2


class Wanted(NamedTuple):
    """What is computed of every design; the entries of ``sums`` are those of ``evaluation.WANTED_...``."""

    levels: Integers  # per dyad: order of the derivatives
    sums: Integers
    has_torque: bool
    forces: int
    signals: Integers  # kind, three entries, statistics
    factors: Array  # per signal
    counted: Integers  # per signal: 1 if it is counted from its own least value over the samples
    terms: Integers  # place of a wrench in the books, sign
    figures: Integers  # signal, reduction, number of the crank angle
    speed: float
    samples: int  # crank angles that the reductions take, the first ones


@kernel
def _torque(n: int, speed: float, sums: Array) -> None:
    """Mkr at a constant speed, in place of Q."""
    for i in range(min(n, BLOCK)):
        sums[FORCE + i] = steady_torque(sums, speed, i)


@kernel
def _add(n: int, sign: float, one: Array, row: Array) -> None:
    for i in range(min(n, BLOCK)):
        row[i] += sign * one[i]


@kernel
def _copy(n: int, sign: float, one: Array, row: Array) -> None:
    for i in range(min(n, BLOCK)):
        row[i] = sign * one[i]


@kernel
def _magnitude(n: int, own: Array) -> None:
    for i in range(min(n, BLOCK)):
        own[i] = math.sqrt(own[i] * own[i] + own[ROW + i] * own[ROW + i])


@inlined
def _sides(kind: int, u: Pair, v: Pair) -> tuple[Pair, Pair]:
    """The directions of ``analytic.kinematics.transmission``, from the vectors of the closure equations."""
    if kind == RRP:
        return (-u[0], -u[1]), (-v[1], v[0])
    if kind == RPR:
        return (-v[0], -v[1]), (-u[1], u[0])
    if kind == RPP:
        return (-v[0], -v[1]), u
    return u, v


@kernel
def _transmission(n: int, kind: int, own: Array, row: Array) -> None:
    for i in range(min(n, BLOCK)):
        of = closure_at(own, i)
        one, other = _sides(kind, of.u, of.v)
        row[i] = between(one, other)


@inlined
def _vector(n: int, first: int, last: int, part: int, terms: Integers, books: Array, own: int) -> None:
    """A component of a sum of wrenches, or the magnitude of its force."""
    for row in range(2 if part == MAGNITUDE else 1):
        component = row if part == MAGNITUDE else part
        target = books[own + ROW * row : own + ROW * (row + 1)]
        for term in range(first, last):
            at, sign = terms[term, 0] + ROW * component, float(terms[term, 1])
            if term == first:
                _copy(n, sign, books[at : at + ROW], target)
            else:
                _add(n, sign, books[at : at + ROW], target)
    if part == MAGNITUDE:
        _magnitude(n, books[own : own + WRENCH])


@inlined
def _coordinate(n: int, order: int, at: Pair, along: Pair, body: Array, row: Array) -> None:
    """A point's coordinate along a direction, or its derivative."""
    if order == 0:
        place_along(n, at, along, body, row)
    elif order == 1:
        rate_along(n, at, along, body, row)
    else:
        second_along(n, at, along, body, row)


@inlined
def _solved(tables: Tables, design: Array, n: int, wanted: Wanted, work: Array, books: Array) -> None:
    """All that the signals are made up of, at the angles of a block."""
    solve(tables, design, n, wanted.levels, work)
    sum_wanted(tables, design, n, wanted.sums, work)
    if wanted.has_torque:
        _torque(n, wanted.speed, work[SUMS:LAWS])
    if wanted.forces:
        if not wanted.sums[WANTED_FORCES]:
            constant_laws(tables, design, n, work)
        charge_outside(tables, design, n, wanted.speed, work, books)
        if wanted.forces & ON_FRAME:
            load_frame(tables, design, n, work, books)
        if wanted.forces & OF_JOINTS:
            charge_between(tables, design, n, wanted.speed, work, books)
            solve_joints(tables, design, n, work, books)


@inlined
def _row(tables: Tables, design: Array, n: int, number: int, wanted: Wanted, work: Array) -> int:
    """Where in the scratch memory a signal is, but for its factor: as it stands, or now written behind the books."""
    kind, one, two, three, _ = wanted.signals[number]
    start: int = books_at(tables)
    if kind == ROWS:
        return int(one)
    at, books = frame_at(tables) + WRENCH, work[start:]
    row = books[at : at + ROW]
    if kind == POINT:
        rows, (order, axis) = body_at(tables, one), divmod(three, 2)
        along = (1.0, 0.0) if axis == 0 else (0.0, 1.0)
        _coordinate(n, order, pair(design, two), along, work[rows : rows + BODY], row)
    elif kind == WRENCHES:
        _vector(n, one, two, three, wanted.terms, books, at)
    else:
        rows = body_at(tables, CRANK_BODY + 1 + 2 * one)
        _transmission(n, tables.dyads[one, layout.KIND], work[rows : rows + 2 * BODY], row)
    return start + at


@inlined
def _block(
    tables: Tables,
    design: Array,
    n: int,
    at: int,
    weights: Array,
    wanted: Wanted,
    row: int,
    values: Array,
    tally: Array,
    work: Array,
) -> None:
    """Gather every signal at the angles of a block, the first of them number ``at``."""
    sampled = min(n, wanted.samples - at)
    for number in range(len(wanted.signals)):
        start = _row(tables, design, n, number, wanted, work)
        own, factor, gathered = work[start : start + ROW], wanted.factors[number], tally[number]
        if at == 0 and wanted.counted[number]:
            gathered[BASE] = own[0]
        if sampled > 0:
            gather(wanted.signals[number, 4], sampled, factor, own, weights[at:], gathered)
        for figure in range(len(wanted.figures)):
            signal, reduction, sample = wanted.figures[figure]
            if reduction == AT and signal == number and at <= sample < at + n:
                values[figure, row] = factor * (own[sample - at] - gathered[BASE])


@kernel
def _finish(row: int, wanted: Wanted, lost: bool, tally: Array, values: Array) -> None:
    """All figures of a design, nan where it is lost."""
    for figure in range(len(wanted.figures)):
        signal, reduction, _ = wanted.figures[figure]
        shift = -tally[signal, LOW] if wanted.counted[signal] else 0.0
        value = finished(reduction, shift, values[figure, row], tally[signal])
        values[figure, row] = math.nan if lost else value


@counting
def _steps(n: int, determinant: Array) -> float:
    """How many steps ``analytic.designs.dead_positions.are_steep`` calls steep, but for those between blocks."""
    total = 0.0
    for i in range(1, n):
        one, two = abs(determinant[i - 1]), abs(determinant[i])
        total += 1.0 if min(one, two) < STEEP * max(one, two) else 0.0
    return total


@inlined
def _steep(tables: Tables, n: int, work: Array) -> float:
    total = 0.0
    for number in range(len(tables.dyads)):
        at = body_at(tables, CRANK_BODY + 1 + 2 * number)
        total += _steps(n, work[at + DETERMINANT : at + DETERMINANT + BLOCK])
    return total


@entry
def reduced(
    tables: Tables,
    designs: Array,
    first: int,
    angle: Array,
    weights: Array,
    wanted: Wanted,
    values: Array,
    steep: Array,
    tally: Array,
    work: Array,
    sources: int = SOURCES,
) -> float:
    """Figures of some designs, whose first has the number ``first``, into ``values`` (figures, all designs).

    ``designs`` (count, size) hold numbers, their constants are filled in here; ``weights`` has an entry for each of the
    samples among the angles; ``tally`` (count, signals + 1, TALLY) is scratch memory. Where a design cannot move at any
    of the angles its figures are nan; returned is the number of such designs. Others whose ``steep`` (all designs) is
    no longer zero may not move between two of the samples.
    """
    lost = len(wanted.signals)
    for at in range(0, len(angle), BLOCK):
        n = min(BLOCK, len(angle) - at)
        place(n, at, angle, work)
        tabled_laws(tables, n, work)
        for number in range(len(designs)):
            design, own = designs[number], tally[number]
            if at == 0:
                derive(tables, design)
                own[:, :] = 0.0
                own[:, HIGH], own[:, LOW] = -math.inf, math.inf
            if own[lost, FIRST] == 0.0:
                _solved(tables, design, n, wanted, work, work[books_at(tables) :])
                own[lost, FIRST] = faults(n, work[FAULT : FAULT + BLOCK])
                steep[first + number] += _steep(tables, min(n, wanted.samples - at), work)
            if own[lost, FIRST] == 0.0:
                _block(tables, design, n, at, weights, wanted, first + number, values, own, work)
    missing = 0.0
    for number in range(len(designs)):
        fails = tally[number, lost, FIRST] > 0.0
        _finish(first + number, wanted, fails, tally[number], values)
        missing += 1.0 if fails else 0.0
    return missing
