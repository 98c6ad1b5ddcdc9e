"""From a linkage's own numbers to the constants its dyads need, once per design: arm lengths, offsets, places on rails.

The formulas are those of ``analytic.kinematics.dyads``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import PRP, RPP, RPR, RRP, RRR, Integers, Tables
from analytic.compiled.kernels import layout
from analytic.compiled.kernels.jit import inlined, kernel
from analytic.compiled.kernels.solution import pair
from analytic.kinematics.dyads import prp, rpp, rpr, rrp, rrr
from analytic.kinematics.frames import Pair, minus, rotated

Array = NDArray[np.float64]
Joint = Callable[[Array, Integers, int], Any]


class PinPlaces(NamedTuple):
    """What the formulas read of a ``structure.Revolute``."""

    near_local: Pair
    far_local: Pair


class Rail(NamedTuple):
    """What they read of a ``structure.Prismatic``."""

    along: Pair
    turn: Pair
    origin: Pair


@inlined
def _pin(numbers: Array, dyad: Integers, joint: int) -> PinPlaces:
    return PinPlaces(pair(numbers, dyad[joint + layout.NEAR_POINT]), pair(numbers, dyad[joint + layout.FAR_POINT]))


@kernel
def _rail(numbers: Array, dyad: Integers, joint: int) -> Rail:
    """A P joint seen from the near body, as ``structure.prismatic_joint`` has it."""
    x, y = pair(numbers, dyad[joint + layout.ALONG])
    length = math.hypot(x, y)
    along = (x / length, y / length)
    anchor = rotated(along[0], along[1], pair(numbers, dyad[joint + layout.ANCHOR]))
    origin = minus(pair(numbers, dyad[joint + layout.THROUGH]), anchor)
    if dyad[joint + layout.FROM_SLIDER] == 0:
        return Rail(along, along, origin)
    x, y = rotated(along[0], -along[1], origin)
    return Rail((1.0, 0.0), (along[0], -along[1]), (-x, -y))


@inlined
def _store(constants: tuple[Pair, ...], k: Array) -> None:
    for at, (x, y) in enumerate(constants):
        k[2 * at], k[2 * at + 1] = x, y


def _deriver(dyad: ModuleType, first: Joint, inner: Joint, second: Joint) -> Callable[[Array, Integers, Array], None]:
    """Kernel that stores the constants of one kind, from its joints as they are read."""
    constants: Any = dyad.constants

    @kernel
    def derived(numbers: Array, row: Integers, k: Array) -> None:
        one, two = first(numbers, row, layout.FIRST_JOINT), second(numbers, row, layout.SECOND_JOINT)
        _store(constants(one, inner(numbers, row, layout.INNER_JOINT), two, float(row[layout.SIGN])), k)

    return derived


_rrr = _deriver(rrr, _pin, _pin, _pin)
_rrp = _deriver(rrp, _pin, _pin, _rail)
_rpr = _deriver(rpr, _pin, _rail, _pin)
_rpp = _deriver(rpp, _pin, _rail, _rail)
_prp = _deriver(prp, _rail, _pin, _rail)


@kernel
def derive(tables: Tables, design: Array) -> None:
    """Fill in the constants that follow a design's numbers: those of the crank, then those of each dyad."""
    dyads, crank = tables.dyads, tables.crank
    start = len(design) - layout.CRANK_CONSTANTS - layout.DYAD_CONSTANTS * len(dyads)
    pin = pair(design, crank[layout.CRANK_FAR])
    x, y = minus(pair(design, crank[layout.CRANK_CENTRE]), pin)
    design[start], design[start + 1] = pin
    design[start + 2] = design[crank[layout.CRANK_MASS]] * (x * x + y * y) + design[crank[layout.CRANK_INERTIA]]
    for number in range(len(dyads)):
        at = start + layout.CRANK_CONSTANTS + layout.DYAD_CONSTANTS * number
        dyad, k = dyads[number], design[at : at + layout.DYAD_CONSTANTS]
        if dyad[layout.KIND] == RRR:
            _rrr(design, dyad, k)
        elif dyad[layout.KIND] == RRP:
            _rrp(design, dyad, k)
        elif dyad[layout.KIND] == RPR:
            _rpr(design, dyad, k)
        elif dyad[layout.KIND] == RPP:
            _rpp(design, dyad, k)
        elif dyad[layout.KIND] == PRP:
            _prp(design, dyad, k)
