"""RRP: the first link turns about a placed pin A, the second slides along a line of a placed body; they share pin C."""

from __future__ import annotations

import math
from typing import NamedTuple

from analytic.description.linkage import Vector
from analytic.kinematics import frames
from analytic.kinematics.dyads.closure import (
    LEAST_SINE,
    UNASSEMBLED,
    At,
    Closure,
    Hosts,
    Links,
    Poses,
    Rates,
    Shortfall,
    Travel,
    Written,
    direction,
    over_square,
    point_on_rail,
    size,
)
from analytic.kinematics.frames import Pair, Scalar
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
    """The dyad's constants from its joints and its assembly sign."""
    r = frames.minus(inner.far_local, first.far_local)
    length = frames.length(r)
    return RRPConstants(
        first.near_local,
        first.far_local,
        over_square(r, length * length),
        second.along,
        second.turn,
        point_on_rail(second, inner.near_local),
        inner.near_local,
        (length, sign),
    )


def poses(k: RRPConstants, host_poses: Poses) -> tuple[Poses, Closure]:
    """A circle and a line: A + r = base + t e with |r| given; r's component along e has the sign given."""
    host = host_poses[1]
    length, sign = k.reach
    a, base, e = frames.point(host_poses[0], k.a), frames.point(host, k.base), frames.arm(host, k.along)
    offset = frames.cross(e, frames.minus(base, a))
    along = sign * frames.root((length - offset) * (length + offset))
    r = _vector_from_components(e, along, offset)
    c = frames.plus(a, r)
    first = frames.pose_through(a, direction(r, k.first), k.pin_a)
    second = frames.pose_through(c, frames.turned(host, k.turn), k.inner)
    return (first, second), Closure(r, e, along, c)


def _vector_from_components(e: Pair, along: Scalar, offset: Scalar) -> Pair:
    """The vector with these components along e and square to it."""
    x, y = e
    if frames.is_zero(x):
        return (-offset * y, along * y)
    if frames.is_zero(y):
        return (along * x, offset * x)
    return (along * x - offset * y, along * y + offset * x)


def rates(
    k: RRPConstants, host_poses: Poses, host_rates: Rates, link_poses: Poses, closure: Closure
) -> tuple[Rates, Travel]:
    """Closure once differentiated: A' + θ' r⊥ = carried' + t' e, carried' that of the host's point at C."""
    a = frames.point_rate(host_poses[0], host_rates[0], k.a)
    carried = frames.carried_rate(host_poses[1], host_rates[1], closure.pin)
    apart = frames.minus(carried, a)
    r, e = closure.u, closure.v
    scale = frames.inverse(closure.determinant)
    w = frames.cross(e, apart) * scale
    slide = w * frames.cross(r, e) - frames.dot(apart, e)
    c = frames.point_along(carried, slide, e)
    pair = (
        frames.rate_through(link_poses[0], a, w, k.pin_a),
        frames.rate_through(link_poses[1], c, host_rates[1][2], k.inner),
    )
    return pair, Travel(scale, slide, 0.0)


def accelerations(k: RRPConstants, hosts: Hosts, links: Links, closure: Closure, travel: Travel) -> Rates:
    """Closure twice differentiated, with the Coriolis term of sliding on a turning host."""
    host_poses, host_rates, host_seconds = hosts
    link_poses, link_rates = links
    a = frames.point_acceleration(host_poses[0], host_rates[0], host_seconds[0], k.a)
    carried = frames.carried_acceleration(host_poses[1], host_rates[1], host_seconds[1], closure.pin)
    r, e = closure.u, closure.v
    w, host = link_rates[0][2], host_rates[1]
    if not frames.is_still(host):
        carried = frames.plus(carried, frames.coriolis(host[2], travel.first, e))
    square = w * w
    apart = (carried[0] - a[0] + square * r[0], carried[1] - a[1] + square * r[1])
    turn = frames.cross(e, apart) * travel.scale
    slide = turn * frames.cross(r, e) - frames.dot(apart, e)
    c = frames.point_along(carried, slide, e)
    return (
        frames.acceleration_through(link_poses[0], a, w, turn, k.pin_a),
        frames.acceleration_through(link_poses[1], c, host[2], host_seconds[1][2], k.inner),
    )


def dead_determinant(k: RRPConstants, closure: Closure) -> Scalar:
    """The determinant up to which the arm counts as square to the line."""
    return LEAST_SINE * k.reach[0]


def reach_margin(k: RRPConstants, host_poses: Poses, closure: Closure) -> tuple[Scalar, Scalar]:
    """Length of the arm less A's distance from the line, m, and their sum, for its rounding."""
    length = k.reach[0]
    a, base = frames.point(host_poses[0], k.a), frames.point(host_poses[1], k.base)
    return length - abs(frames.cross(closure.v, frames.minus(base, a))), size(a, base) + length


def dead_position_text(dyad: Dyad, closure: Closure) -> str:
    """The dead position in words: the arm square to the line."""
    return f"'{dyad.first}' square to the guide of '{dyad.second}'"


def gap(k: RRPConstants, host_poses: Poses) -> Scalar:
    """Infinite: there are no two outer pins that could meet."""
    return math.inf


def snapped_to_touch(k: RRPConstants, margin: Scalar, gap: Scalar) -> RRPConstants:
    """Constants with the arm's length changed so that it just reaches the line."""
    return k._replace(reach=(k.reach[0] - margin, k.reach[1]))


def assembly_fault(dyad: Dyad, k: RRPConstants, host_poses: Poses, at: At, written: Written) -> Shortfall:
    """Why the links do not meet, as a fault and a sentence: the arm does not reach the line."""
    assert isinstance(dyad.first_joint, Revolute)
    gap = frames.minus(frames.point(host_poses[1], k.base), frames.point(host_poses[0], k.a))
    distance = abs(at(frames.cross(frames.arm(host_poses[1], k.along), gap)))
    length = k.reach[0]
    return UNASSEMBLED, (
        f"'{dyad.first}' ({written(length)}) is {written(distance - length)} too short to reach the guide of "
        f"'{dyad.second}', {written(distance)} away from '{dyad.first_joint.point}'; lengthen it or move the "
        "guide closer"
    )
