"""RPR: both links turn about placed pins A and B and slide along each other."""

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
    point_on_rail,
    size,
)
from analytic.kinematics.frames import Pair, Scalar
from analytic.kinematics.structure import Dyad, Prismatic, Revolute


class RPRConstants(NamedTuple):
    """A and B in the frames of their placed bodies and of the links; the line of the second link that A lies on."""

    a: Vector
    b: Vector
    pin_a: Vector
    pin_b: Vector
    along: Vector
    turn: Vector
    line: Vector  # offset of the line from B, sign


def constants(first: Revolute, inner: Prismatic, second: Revolute, sign: float) -> RPRConstants:
    """The dyad's constants from its joints and its assembly sign."""
    start = frames.minus(point_on_rail(inner, first.far_local), second.far_local)
    return RPRConstants(
        first.near_local,
        second.near_local,
        first.far_local,
        second.far_local,
        inner.along,
        inner.turn,
        (frames.cross(inner.along, start), sign),
    )


def poses(k: RPRConstants, host_poses: Poses) -> tuple[Poses, Closure]:
    """A line of the second link at a fixed offset from B passes through A: d = A - B = t e + offset e⊥.

    The determinant is t, A's coordinate along the line from B's foot. Where A passes through B the direction is left
    undefined (nan).
    """
    offset, sign = k.line
    a, b = frames.point(host_poses[0], k.a), frames.point(host_poses[1], k.b)
    d = frames.minus(a, b)
    square = frames.dot(d, d)
    along = sign * frames.root(square - offset * offset)
    e = _line(d, along, offset, square)
    c, s = direction(e, k.along)
    second = frames.pose_through(b, (c, s), k.pin_b)
    first = frames.pose_through(a, frames.rotated(c, s, k.turn), k.pin_a)
    return (first, second), Closure(e, d, along, a)


def _line(d: Pair, along: Scalar, offset: Scalar, square: Scalar) -> Pair:
    """The line's direction, from the components of d along and square to it."""
    if frames.is_zero(offset):
        scale = frames.inverse(along)
        return (d[0] * scale, d[1] * scale)
    scale = frames.inverse(square)
    return ((along * d[0] + offset * d[1]) * scale, (along * d[1] - offset * d[0]) * scale)


def rates(
    k: RPRConstants, host_poses: Poses, host_rates: Rates, link_poses: Poses, closure: Closure
) -> tuple[Rates, Travel]:
    """Closure once differentiated: d' = t' e + θ' d⊥."""
    a, b = frames.point_rate(host_poses[0], host_rates[0], k.a), frames.point_rate(host_poses[1], host_rates[1], k.b)
    apart = frames.minus(a, b)
    e = closure.u
    scale = frames.inverse(closure.determinant)
    w = frames.cross(e, apart) * scale
    slide = frames.dot(apart, e) + w * k.line[0]
    return (
        frames.rate_through(link_poses[0], a, w, k.pin_a),
        frames.rate_through(link_poses[1], b, w, k.pin_b),
    ), Travel(scale, slide, 0.0)


def accelerations(k: RPRConstants, hosts: Hosts, links: Links, closure: Closure, travel: Travel) -> Rates:
    """Closure twice differentiated: d'' = t'' e + 2 θ' t' e⊥ + θ'' d⊥ - θ'² d."""
    host_poses, host_rates, host_seconds = hosts
    link_poses, link_rates = links
    a = frames.point_acceleration(host_poses[0], host_rates[0], host_seconds[0], k.a)
    b = frames.point_acceleration(host_poses[1], host_rates[1], host_seconds[1], k.b)
    w = link_rates[0][2]
    turn = (frames.cross(closure.u, frames.minus(a, b)) + w * (w * k.line[0] - 2.0 * travel.first)) * travel.scale
    return (
        frames.acceleration_through(link_poses[0], a, w, turn, k.pin_a),
        frames.acceleration_through(link_poses[1], b, w, turn, k.pin_b),
    )


def dead_determinant(k: RPRConstants, closure: Closure) -> Scalar:
    """The determinant up to which A counts as at the foot of the perpendicular from B to the line."""
    return LEAST_SINE * (size(closure.pin, frames.minus(closure.pin, closure.v)) + abs(k.line[0]))


def reach_margin(k: RPRConstants, host_poses: Poses, closure: Closure) -> tuple[Scalar, Scalar]:
    """Distance AB less the line's offset from B, m, and their sum, for its rounding.

    A line through B needs A away from it, to have a direction.
    """
    offset = abs(k.line[0])
    pins = size(frames.point(host_poses[0], k.a), frames.point(host_poses[1], k.b))
    needed = offset + (2.0 * ROUNDING) * pins * (offset == 0.0)
    return np.sqrt(frames.dot(closure.v, closure.v)) - needed, pins + offset


def dead_position_text(dyad: Dyad, closure: Closure) -> str:
    """The dead position in words: the slide is square to the line through the outer pins."""
    return f"the slide square to the line of '{dyad.first_joint.name}' and '{dyad.second_joint.name}'"


def gap(k: RPRConstants, host_poses: Poses) -> Scalar:
    """Distance of the outer pins, m."""
    d = frames.minus(frames.point(host_poses[0], k.a), frames.point(host_poses[1], k.b))
    return np.sqrt(frames.dot(d, d))


def snapped_to_touch(k: RPRConstants, margin: Scalar, gap: Scalar) -> RPRConstants:
    """Constants with the line's offset changed to the distance of the pins, so that the line just touches A."""
    return k._replace(line=(k.line[0] + np.sign(k.line[0]) * margin, k.line[1]))


def assembly_fault(dyad: Dyad, k: RPRConstants, host_poses: Poses, at: At, written: Written) -> Shortfall:
    """Why the links do not meet, as a fault and a sentence: the offset is too large, or A is on B."""
    assert isinstance(dyad.first_joint, Revolute)
    assert isinstance(dyad.second_joint, Revolute)
    distance = at(np.hypot(*frames.minus(frames.point(host_poses[0], k.a), frames.point(host_poses[1], k.b))))
    offset = abs(k.line[0])
    pins = f"'{dyad.first_joint.point}' and '{dyad.second_joint.point}'"
    if offset == 0.0:
        return UNDETERMINED, (
            f"{pins} coincide, so the direction of the slide between '{dyad.first}' and '{dyad.second}' "
            "is undefined; move the pivot off the pin's path"
        )
    return UNASSEMBLED, (
        f"the slide between '{dyad.first}' and '{dyad.second}' is offset by {written(offset)}, "
        f"{written(offset - distance)} more than the distance between {pins}; lessen the offset or move the "
        "pivot away"
    )
