"""The five dyads in closed form: positions, then first and second derivatives over the crank angle, all exact.

Vectors are pairs (x, y) of floats or arrays of one shape. A pose is (x, y, c, s): origin and cosine and sine of the
frame's angle. A rate is (x', y', θ'), an acceleration (x'', y'', θ''); primes are d/dφ. Each dyad is solved by
the vector method of the articles (chained vectors, sign W); the derivatives come from differentiating the closure
equations once and twice, which are linear in the unknown rates.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from analytic.description.linkage import Vector

Scalar = Any  # a float or an array; the arithmetic is the same
Pair = tuple[Scalar, Scalar]
Pose = tuple[Scalar, Scalar, Scalar, Scalar]
Rate = tuple[Scalar, Scalar, Scalar]

STILL: Rate = (0.0, 0.0, 0.0)  # the ground's; compared by identity, to skip work with zeros


def _none(scalar: Scalar) -> bool:
    """Whether a factor or summand is a plain zero, as on a guide along an axis: its work can then be left out."""
    return type(scalar) is float and scalar == 0.0


def arm(pose: Pose, local: Vector) -> Pair:
    """Vector from a frame's origin to a point of its body, in the ground frame."""
    c, s = pose[2], pose[3]
    a, b = local
    if b == 0.0:
        return (c * a, s * a) if a != 0.0 else (0.0, 0.0)
    if a == 0.0:
        return (s * -b, c * b)
    return (c * a - s * b, s * a + c * b)


def point(pose: Pose, local: Vector) -> Pair:
    """Position of a point of a body."""
    if local == (0.0, 0.0):
        return (pose[0], pose[1])
    r = arm(pose, local)
    return (pose[0] + r[0], pose[1] + r[1])


def point_rate(pose: Pose, rate: Rate, local: Vector) -> Pair:
    """First derivative of a point of a body."""
    if local == (0.0, 0.0) or _none(rate[2]):
        return (rate[0], rate[1])
    r = arm(pose, local)
    return (rate[0] - rate[2] * r[1], rate[1] + rate[2] * r[0])


def point_acceleration(pose: Pose, rate: Rate, acceleration: Rate, local: Vector) -> Pair:
    """Second derivative of a point of a body."""
    if local == (0.0, 0.0) or (_none(rate[2]) and _none(acceleration[2])):
        return (acceleration[0], acceleration[1])
    r = arm(pose, local)
    square = rate[2] * rate[2]
    return (
        acceleration[0] - acceleration[2] * r[1] - square * r[0],
        acceleration[1] + acceleration[2] * r[0] - square * r[1],
    )


def turned(pose: Pose, turn: Vector) -> Pair:
    """Cosine and sine of a body's angle plus a constant angle (cos, sin)."""
    c, s = pose[2], pose[3]
    if turn == (1.0, 0.0):
        return (c, s)
    return (c * turn[0] - s * turn[1], s * turn[0] + c * turn[1])


def pose_through(position: Pair, direction: Pair, local: Vector) -> Pose:
    """Pose of a body whose angle is known and whose point ``local`` lies at ``position``."""
    return (*minus(position, arm((0.0, 0.0, *direction), local)), *direction)


def rate_through(pose: Pose, velocity: Pair, turn_rate: Scalar, local: Vector) -> Rate:
    """Rate of a body whose point ``local`` has the given derivative."""
    if local == (0.0, 0.0) or _none(turn_rate):
        return (*velocity, turn_rate)
    r = arm(pose, local)
    return (velocity[0] + turn_rate * r[1], velocity[1] - turn_rate * r[0], turn_rate)


def acceleration_through(pose: Pose, second: Pair, turn_rate: Scalar, turn_second: Scalar, local: Vector) -> Rate:
    """Second derivative of a body whose point ``local`` has the given second derivative."""
    if local == (0.0, 0.0) or (_none(turn_rate) and _none(turn_second)):
        return (*second, turn_second)
    r = arm(pose, local)
    square = turn_rate * turn_rate
    return (
        second[0] + turn_second * r[1] + square * r[0],
        second[1] - turn_second * r[0] + square * r[1],
        turn_second,
    )


def minus(a: Pair, b: Pair) -> Pair:
    """Difference of two vectors."""
    return (a[0] if _none(b[0]) else a[0] - b[0], a[1] if _none(b[1]) else a[1] - b[1])


def ahead(place: Pair, travel: Scalar, direction: Pair) -> Pair:
    """The place a travel along a direction leads to."""
    x, y = direction
    return (place[0] if _none(x) else place[0] + travel * x, place[1] if _none(y) else place[1] + travel * y)


def dot(a: Pair, b: Pair) -> Scalar:
    """Scalar product."""
    if _none(a[0]) or _none(b[0]):
        return a[1] * b[1]
    if _none(a[1]) or _none(b[1]):
        return a[0] * b[0]
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Pair, b: Pair) -> Scalar:
    """Vector product, its component out of the plane."""
    if _none(a[0]) or _none(b[1]):
        return -a[1] * b[0]
    if _none(a[1]) or _none(b[0]):
        return a[0] * b[1]
    return a[0] * b[1] - a[1] * b[0]


def carried_rate(pose: Pose, rate: Rate, position: Pair) -> Pair:
    """Derivative of the point of a body that is just now at ``position``."""
    if rate is STILL:
        return (0.0, 0.0)
    r = (position[0] - pose[0], position[1] - pose[1])
    return (rate[0] - rate[2] * r[1], rate[1] + rate[2] * r[0])


def carried_acceleration(pose: Pose, rate: Rate, acceleration: Rate, position: Pair) -> Pair:
    """Second derivative of the point of a body that is just now at ``position``."""
    if acceleration is STILL:
        return (0.0, 0.0)
    r = (position[0] - pose[0], position[1] - pose[1])
    square = rate[2] * rate[2]
    return (
        acceleration[0] - acceleration[2] * r[1] - square * r[0],
        acceleration[1] + acceleration[2] * r[0] - square * r[1],
    )


def two_circles(a: Pair, b: Pair, radius_a: float, radius_b: float, sign: int) -> tuple[Pair, Scalar, Scalar]:
    """RRR: the vectors from A to the inner pin C on two circles about A and B.

    Returns AC, the determinant AC × BC of the closure equations, which is |AB| times C's distance from the line AB, and
    the radicand. C lies left of A→B for sign +1. The radicand is formed as a product (Heron), not as a difference of
    squares, to stay accurate near the dead positions. Where A is on B, C is left undefined (nan).
    """
    d = minus(b, a)
    square = dot(d, d)
    spread = (radius_a + radius_b) ** 2
    gap = (radius_a - radius_b) ** 2
    radicand = (spread - square) * (square - gap)
    determinant = (0.5 * sign) * np.sqrt(np.maximum(radicand, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        along = 0.5 + (radius_a - radius_b) * (radius_a + radius_b) * 0.5 / square
        across = determinant / square
        return (along * d[0] - across * d[1], along * d[1] + across * d[0]), determinant, radicand


def circle_and_line(a: Pair, base: Pair, direction: Pair, radius: float, sign: int) -> tuple[Pair, Scalar, Scalar]:
    """RRP: the vector from A to the inner pin on a circle about A and on a line.

    Returns it with its component along the line, which has the given sign and is the determinant of the closure
    equations, and the radicand.
    """
    offset = cross(direction, minus(base, a))
    radicand = (radius - offset) * (radius + offset)
    along = sign * np.sqrt(np.maximum(radicand, 0.0))
    x, y = direction
    if _none(x):
        return (-offset * y, along * y), along, radicand
    if _none(y):
        return (along * x, offset * x), along, radicand
    return (along * x - offset * y, along * y + offset * x), along, radicand


def line_through(d: Pair, offset: float, sign: int) -> tuple[Pair, Scalar, Scalar]:
    """RPR: direction of a line at a fixed offset from B on which A lies, d = A − B.

    Returns the direction, A's coordinate along it from B's foot, which is the determinant of the closure equations, and
    the radicand |d|² − offset². Where A passes through B the direction is left undefined (nan).
    """
    square = dot(d, d)
    radicand = square - offset * offset
    along = sign * np.sqrt(np.maximum(radicand, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        if offset == 0.0:
            return (d[0] / along, d[1] / along), along, radicand
        return ((along * d[0] + offset * d[1]) / square, (along * d[1] - offset * d[0]) / square), along, radicand
