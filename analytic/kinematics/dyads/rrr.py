"""RRR: both links turn about placed pins A and B and share the inner pin C; r = AC and q = BC."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics import frames
from analytic.kinematics.dyads.closure import (
    LEAST_SINE,
    ROUNDING,
    UNASSEMBLED,
    UNDETERMINED,
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
    size,
)
from analytic.kinematics.frames import Scalar
from analytic.kinematics.structure import Dyad, Revolute


class RRRConstants(NamedTuple):
    """A and B in the frames of their placed bodies and of the links, the links' arms over their squares, lengths."""

    a: Vector
    b: Vector
    pin_a: Vector
    pin_b: Vector
    first: Vector
    second: Vector
    lengths: Vector
    sign: Vector  # and a zero


def constants(first: Revolute, inner: Revolute, second: Revolute, sign: float) -> RRRConstants:
    """The dyad's constants from its joints and its assembly sign."""
    r, q = frames.minus(inner.far_local, first.far_local), frames.minus(inner.near_local, second.far_local)
    length_r, length_q = frames.length(r), frames.length(q)
    return RRRConstants(
        first.near_local,
        second.near_local,
        first.far_local,
        second.far_local,
        over_square(r, length_r * length_r),
        over_square(q, length_q * length_q),
        (length_r, length_q),
        (sign, 0.0),
    )


def poses(k: RRRConstants, host_poses: Poses) -> tuple[Poses, Closure]:
    """Two circles: A + r = B + q with |r| and |q| given; C lies left of A→B for sign +1.

    The determinant r × q is |AB| times C's distance from the line AB. The radicand is formed as a product (Heron), not
    as a difference of squares, to stay accurate near the dead positions. Where A is on B, C is undefined (nan).
    """
    a, b = frames.point(host_poses[0], k.a), frames.point(host_poses[1], k.b)
    value, two = k.lengths
    total, difference = value + two, value - two
    d = frames.minus(b, a)
    square = frames.dot(d, d)
    determinant = (0.5 * k.sign[0]) * frames.root((total * total - square) * (square - difference * difference))
    scale = frames.inverse(square)
    along = 0.5 + (0.5 * difference * total) * scale
    across = determinant * scale
    r = (along * d[0] - across * d[1], along * d[1] + across * d[0])
    c = frames.plus(a, r)
    q = frames.minus(c, b)
    first = frames.pose_through(a, direction(r, k.first), k.pin_a)
    second = frames.pose_through(b, direction(q, k.second), k.pin_b)
    return (first, second), Closure(r, q, determinant, c)


def rates(
    k: RRRConstants, host_poses: Poses, host_rates: Rates, link_poses: Poses, closure: Closure
) -> tuple[Rates, Travel]:
    """Closure once differentiated: A' + θ1' r⊥ = B' + θ2' q⊥."""
    a, b = frames.point_rate(host_poses[0], host_rates[0], k.a), frames.point_rate(host_poses[1], host_rates[1], k.b)
    scale = frames.inverse(closure.determinant)
    apart = frames.minus(b, a)
    first, two = frames.dot(apart, closure.v) * scale, frames.dot(apart, closure.u) * scale
    pair = frames.rate_through(link_poses[0], a, first, k.pin_a), frames.rate_through(link_poses[1], b, two, k.pin_b)
    return pair, Travel(scale, 0.0, 0.0)


def accelerations(k: RRRConstants, hosts: Hosts, links: Links, closure: Closure, travel: Travel) -> Rates:
    """Closure twice differentiated: A'' + θ1'' r⊥ - θ1'² r = B'' + θ2'' q⊥ - θ2'² q."""
    host_poses, host_rates, host_seconds = hosts
    link_poses, link_rates = links
    a = frames.point_acceleration(host_poses[0], host_rates[0], host_seconds[0], k.a)
    b = frames.point_acceleration(host_poses[1], host_rates[1], host_seconds[1], k.b)
    r, q = closure.u, closure.v
    w, v = link_rates[0][2], link_rates[1][2]
    w_squared, v_squared = w * w, v * v
    g = (b[0] - a[0] + w_squared * r[0] - v_squared * q[0], b[1] - a[1] + w_squared * r[1] - v_squared * q[1])
    first, second = frames.dot(g, q) * travel.scale, frames.dot(g, r) * travel.scale
    return (
        frames.acceleration_through(link_poses[0], a, w, first, k.pin_a),
        frames.acceleration_through(link_poses[1], b, v, second, k.pin_b),
    )


def dead_determinant(k: RRRConstants, closure: Closure) -> Scalar:
    """The determinant up to which A, B and C count as in one line."""
    return LEAST_SINE * k.lengths[0] * k.lengths[1]


def reach_margin(k: RRRConstants, host_poses: Poses, closure: Closure) -> tuple[Scalar, Scalar]:
    """By how much the arms reach each other, m, negative where they do not; and the sum of the lengths, for rounding.

    It is the smaller of the arms' sum less AB, and AB less their difference.
    """
    a, b = frames.point(host_poses[0], k.a), frames.point(host_poses[1], k.b)
    first, two = k.lengths
    d = frames.minus(b, a)
    gap = np.sqrt(frames.dot(d, d))
    return np.minimum(first + two - gap, gap - abs(first - two)), size(a, b) + first + two


def dead_position_text(dyad: Dyad, closure: Closure) -> str:
    """How the arms lie in a dead position, in words: stretched or folded."""
    return "stretched in one line" if np.all(frames.dot(closure.u, closure.v) < 0.0) else "folded in one line"


def gap(k: RRRConstants, host_poses: Poses) -> Scalar:
    """Distance of the outer pins, m."""
    d = frames.minus(frames.point(host_poses[1], k.b), frames.point(host_poses[0], k.a))
    return np.sqrt(frames.dot(d, d))


def snapped_to_touch(k: RRRConstants, margin: Scalar, gap: Scalar) -> RRRConstants:
    """Constants with arm lengths that just touch: their sum, or their difference, becomes the gap."""
    total, difference = k.lengths[0] + k.lengths[1], k.lengths[0] - k.lengths[1]
    if abs(total - gap) < abs(gap - abs(difference)):
        total = gap
    elif gap <= ROUNDING * total:  # pins on top of each other: the gap's own rounding is no length
        difference = 0.0
    else:
        difference = gap if difference > 0.0 else -gap
    return k._replace(lengths=(0.5 * (total + difference), 0.5 * (total - difference)))


def assembly_fault(dyad: Dyad, k: RRRConstants, host_poses: Poses, at: At, written: Written) -> Shortfall:
    """Why the links do not meet, as a fault and a sentence: the arms are too short for the gap, or one is too long."""
    gap = at(np.hypot(*frames.minus(frames.point(host_poses[1], k.b), frames.point(host_poses[0], k.a))))
    first, second = k.lengths
    links = f"'{dyad.first}' ({written(first)}) and '{dyad.second}' ({written(second)})"
    if gap == 0.0:
        fault = UNDETERMINED if first == second else UNASSEMBLED
        return fault, f"{links} have their outer pins on top of each other; move one of the pivots"
    assert isinstance(dyad.first_joint, Revolute)
    assert isinstance(dyad.second_joint, Revolute)
    between = f"the gap of {written(gap)} between '{dyad.first_joint.point}' and '{dyad.second_joint.point}'"
    if gap > first + second:
        return UNASSEMBLED, (
            f"{links} together are {written(gap - first - second)} shorter than {between}; lengthen one of them, "
            "shorten the crank or move the pivots closer together"
        )
    longer, shorter = (dyad.first, dyad.second) if first > second else (dyad.second, dyad.first)
    return UNASSEMBLED, (
        f"{links} differ by {written(abs(first - second) - gap)} more than {between}; shorten '{longer}', lengthen "
        f"'{shorter}' or move the pivots apart"
    )
