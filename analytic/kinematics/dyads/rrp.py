"""RRP: the first link turns about a placed pin A, the second slides along a line of a placed body; they share pin C."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics.dyads.closure import (
    LEAST_SINE,
    UNASSEMBLED,
    At,
    Closure,
    Poses,
    Rates,
    Shortfall,
    Travel,
    Written,
    direction,
    on_rail,
    over_square,
    size,
)
from analytic.kinematics.frames import (
    Pair,
    Scalar,
    acceleration_through,
    ahead,
    arm,
    carried_acceleration,
    carried_rate,
    coriolis,
    cross,
    dot,
    inverse,
    is_still,
    is_zero,
    minus,
    plus,
    point,
    point_acceleration,
    point_rate,
    pose_through,
    rate_through,
    root,
    turned,
)
from analytic.kinematics.structure import Dyad, Prismatic, Revolute


class RRPConstants(NamedTuple):
    """A on its placed body and on the first link, that link's arm over its square; the line, and C on the slider."""

    a: Vector
    pin_a: Vector
    first: Vector
    along: Vector
    turn: Vector
    base: Vector
    inner: Vector
    reach: Vector  # length of the arm, sign


def constants(first: Revolute, inner: Revolute, second: Prismatic, sign: float) -> RRPConstants:
    """The arm and its length; where C is on the host at zero travel."""
    r = minus(inner.far_local, first.far_local)
    length = math.hypot(r[0], r[1])
    return RRPConstants(
        first.near_local,
        first.far_local,
        over_square(r, length * length),
        second.along,
        second.turn,
        on_rail(second, inner.near_local),
        inner.near_local,
        (length, sign),
    )


def poses(k: RRPConstants, near: Poses) -> tuple[Poses, Closure]:
    """A circle and a line: A + r = base + t e with |r| given; r's component along e has the sign given."""
    host = near[1]
    length, sign = k.reach
    a, base, e = point(near[0], k.a), point(host, k.base), arm(host, k.along)
    offset = cross(e, minus(base, a))
    along = sign * root((length - offset) * (length + offset))
    r = _beside(e, along, offset)
    c = plus(a, r)
    first = pose_through(a, direction(r, k.first), k.pin_a)
    second = pose_through(c, turned(host, k.turn), k.inner)
    return (first, second), Closure(r, e, along, c)


def _beside(e: Pair, along: Scalar, offset: Scalar) -> Pair:
    """The vector with these components along e and square to it."""
    x, y = e
    if is_zero(x):
        return (-offset * y, along * y)
    if is_zero(y):
        return (along * x, offset * x)
    return (along * x - offset * y, along * y + offset * x)


def rates(k: RRPConstants, near: Poses, near_rates: Rates, own: Poses, closure: Closure) -> tuple[Rates, Travel]:
    """Closure once differentiated: A' + θ' r⊥ = carried' + t' e, carried' that of the host's point at C."""
    a = point_rate(near[0], near_rates[0], k.a)
    carried = carried_rate(near[1], near_rates[1], closure.pin)
    apart = minus(carried, a)
    r, e = closure.u, closure.v
    scale = inverse(closure.determinant)
    w = cross(e, apart) * scale
    slide = w * cross(r, e) - dot(apart, e)
    c = ahead(carried, slide, e)
    pair = rate_through(own[0], a, w, k.pin_a), rate_through(own[1], c, near_rates[1][2], k.inner)
    return pair, Travel(scale, slide, 0.0)


def accelerations(
    k: RRPConstants,
    near: Poses,
    near_rates: Rates,
    near_seconds: Rates,
    own: Poses,
    own_rates: Rates,
    closure: Closure,
    travel: Travel,
) -> Rates:
    """Closure twice differentiated, with the Coriolis term of sliding on a turning host."""
    a = point_acceleration(near[0], near_rates[0], near_seconds[0], k.a)
    carried = carried_acceleration(near[1], near_rates[1], near_seconds[1], closure.pin)
    r, e = closure.u, closure.v
    w, host = own_rates[0][2], near_rates[1]
    if not is_still(host):
        carried = plus(carried, coriolis(host[2], travel.first, e))
    square = w * w
    apart = (carried[0] - a[0] + square * r[0], carried[1] - a[1] + square * r[1])
    turn = cross(e, apart) * travel.scale
    slide = turn * cross(r, e) - dot(apart, e)
    c = ahead(carried, slide, e)
    return (
        acceleration_through(own[0], a, w, turn, k.pin_a),
        acceleration_through(own[1], c, host[2], near_seconds[1][2], k.inner),
    )


def least(k: RRPConstants, closure: Closure) -> Scalar:
    """The arm is square to the line."""
    return LEAST_SINE * k.reach[0]


def missing(k: RRPConstants, near: Poses, closure: Closure) -> tuple[Scalar, Scalar]:
    """The arm less A's distance from the line, which is |r| where the circle misses it."""
    length = k.reach[0]
    a, base = point(near[0], k.a), point(near[1], k.base)
    return length - np.sqrt(dot(closure.u, closure.u)), size(a, base) + length


def shortfall(dyad: Dyad, k: RRPConstants, near: Poses, at: At, written: Written) -> Shortfall:
    """The arm does not reach the line."""
    assert isinstance(dyad.first_joint, Revolute)
    distance = abs(at(cross(arm(near[1], k.along), minus(point(near[1], k.base), point(near[0], k.a)))))
    length = k.reach[0]
    return UNASSEMBLED, (
        f"'{dyad.first}' ({written(length)}) is {written(distance - length)} too short to reach the guide of "
        f"'{dyad.second}', {written(distance)} away from '{dyad.first_joint.point}'; lengthen it or move the "
        "guide closer"
    )
