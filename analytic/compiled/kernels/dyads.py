"""The five dyads on blocks of crank angles: loops over the formulas of ``analytic.kinematics.dyads``.

A step takes the number of angles ``n``, the dyad's constants ``k``, the rows of the two bodies that it hangs on, and
the dyad's own rows, which it fills. Rows come as separate arrays because the compiler must not take them for one.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

import analytic.compiled.kernels.formulas  # noqa: F401 - lets the loops call the formulas
from analytic.compiled.kernels.jit import inlined, kernel
from analytic.compiled.kernels.layout import BLOCK, KEPT, SECOND, C, X
from analytic.compiled.kernels.rows import pose, put_pose, put_rate, put_second, rate, second
from analytic.kinematics.dyads import prp, rpp, rpr, rrp, rrr
from analytic.kinematics.dyads.arms import ROUNDING
from analytic.kinematics.dyads.closure import Closure, Travel
from analytic.kinematics.frames import Pair

Array = NDArray[np.float64]
Solver = Callable[[int, int, Array, Array, Array, Array, Array], None]

UX, UY, VX, VY, DETERMINANT, PIN_X, PIN_Y, SCALE, FIRST, OTHER = KEPT


@inlined
def pairs(k: Array) -> tuple[Pair, ...]:
    """A dyad's constants as they were stored."""
    return (
        (k[0], k[1]),
        (k[2], k[3]),
        (k[4], k[5]),
        (k[6], k[7]),
        (k[8], k[9]),
        (k[10], k[11]),
        (k[12], k[13]),
        (k[14], k[15]),
    )


@inlined
def closure_at(own: Array, i: int) -> Closure:
    """The closure's vectors, stored with the poses."""
    u, v = (own[UX + i], own[UY + i]), (own[VX + i], own[VY + i])
    return Closure(u, v, own[DETERMINANT + i], (own[PIN_X + i], own[PIN_Y + i]))


@inlined
def put_closure(own: Array, i: int, closure: Closure) -> None:
    """Store them, but for the pin."""
    own[UX + i], own[UY + i] = closure.u
    own[VX + i], own[VY + i] = closure.v
    own[DETERMINANT + i] = closure.determinant


def _poses(formulas: Any, constants: Any, slides: int) -> Any:
    count = len(constants._fields)

    @kernel
    def poses(n: int, k: Array, one: Array, two: Array, own: Array) -> None:
        known = constants(*pairs(k)[:count])
        for i in range(min(n, BLOCK)):
            links, closure = formulas.poses(known, (pose(one, i), pose(two, i)))
            put_closure(own, i, closure)
            if slides > 0:
                own[PIN_X + i], own[PIN_Y + i] = closure.pin
            put_pose(own, i, links[0])
            put_pose(own, SECOND + i, links[1])

    return poses


def _gaps(formulas: Any, constants: Any) -> Any:
    count = len(constants._fields)

    @kernel
    def gaps(n: int, k: Array, one: Array, two: Array, own: Array, fault: Array) -> None:
        known = constants(*pairs(k)[:count])
        for i in range(min(n, BLOCK)):
            length, of = formulas.missing(known, (pose(one, i), pose(two, i)), closure_at(own, i))
            meets = (length + ROUNDING * of >= 0.0) & (abs(own[X + i]) < np.inf) & (abs(own[C + i]) < np.inf)
            fault[i] = fault[i] if meets else 1.0

    return gaps


def _rates(formulas: Any, constants: Any, slides: int) -> Any:
    count = len(constants._fields)

    @kernel
    def rates(n: int, k: Array, one: Array, two: Array, own: Array, fault: Array) -> None:
        known = constants(*pairs(k)[:count])
        for i in range(min(n, BLOCK)):
            closure = closure_at(own, i)
            links, travel = formulas.rates(
                known,
                (pose(one, i), pose(two, i)),
                (rate(one, i), rate(two, i)),
                (pose(own, i), pose(own, SECOND + i)),
                closure,
            )
            fault[i] = fault[i] if abs(closure.determinant) > formulas.least(known, closure) else 1.0
            own[SCALE + i] = travel.scale
            if slides > 0:
                own[FIRST + i] = travel.first
            if slides > 1:
                own[OTHER + i] = travel.second
            put_rate(own, i, links[0])
            put_rate(own, SECOND + i, links[1])

    return rates


def _accelerations(formulas: Any, constants: Any) -> Any:
    count = len(constants._fields)

    @kernel
    def accelerations(n: int, k: Array, one: Array, two: Array, own: Array) -> None:
        known = constants(*pairs(k)[:count])
        for i in range(min(n, BLOCK)):
            links = formulas.accelerations(
                known,
                ((pose(one, i), pose(two, i)), (rate(one, i), rate(two, i)), (second(one, i), second(two, i))),
                ((pose(own, i), pose(own, SECOND + i)), (rate(own, i), rate(own, SECOND + i))),
                closure_at(own, i),
                Travel(own[SCALE + i], own[FIRST + i], own[OTHER + i]),
            )
            put_second(own, i, links[0])
            put_second(own, SECOND + i, links[1])

    return accelerations


def _solver(formulas: ModuleType, constants: type, slides: int) -> Solver:
    """Kernel of one kind: poses of a dyad's two links and their derivatives up to an order; faults are marked.

    A kind without ``slides`` needs neither pin nor travels later, so that they are not stored.
    """
    poses, gaps = _poses(formulas, constants, slides), _gaps(formulas, constants)
    rates, accelerations = _rates(formulas, constants, slides), _accelerations(formulas, constants)

    @kernel
    def solve(level: int, n: int, k: Array, one: Array, two: Array, own: Array, fault: Array) -> None:
        poses(n, k, one, two, own)
        if level == 0:
            gaps(n, k, one, two, own, fault)
        if level >= 1:
            rates(n, k, one, two, own, fault)
        if level >= 2:
            accelerations(n, k, one, two, own)

    return solve


solve_rrr = _solver(rrr, rrr.RRRConstants, slides=0)
solve_rrp = _solver(rrp, rrp.RRPConstants, slides=1)
solve_rpr = _solver(rpr, rpr.RPRConstants, slides=1)
solve_rpp = _solver(rpp, rpp.RPPConstants, slides=2)
solve_prp = _solver(prp, prp.PRPConstants, slides=2)
