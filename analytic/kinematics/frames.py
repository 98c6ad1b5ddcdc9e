"""Bodies in the plane: points of a frame and frames through points, with two derivatives over the crank angle.

Vectors are pairs (x, y) of floats or arrays that go together. A pose is (x, y, c, s): origin and cosine and sine of the
frame's angle. A rate is (x', y', θ'), an acceleration (x'', y'', θ''); primes are d/dφ.

The functions take floats, arrays, numbers that carry their errors (``analytic.numerics.rounded``) and traced numbers,
which record operations (``analytic.machine_code``). ``is_zero``, ``is_one``, ``is_origin`` and ``is_still`` spare them
the work with constants that are zero.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from analytic.description.linkage import Vector

Scalar = Any  # a float or an array; the arithmetic is the same
Pair = tuple[Scalar, Scalar]
Pose = tuple[Scalar, Scalar, Scalar, Scalar]
Rate = tuple[Scalar, Scalar, Scalar]

STILL: Rate = (0.0, 0.0, 0.0)  # the ground's; compared by identity, to skip work with zeros


def is_zero(scalar: Scalar) -> bool:
    """Whether a factor or summand is the plain float 0, as on a guide along an axis, so that it can be left out."""
    return type(scalar) is float and scalar == 0.0


def is_one(scalar: Scalar) -> bool:
    """Whether a factor is the plain float 1, so that multiplying by it can be saved."""
    return type(scalar) is float and scalar == 1.0


def is_origin(local: Vector) -> bool:
    """Whether a point of a body is the origin of its frame: both coordinates are plain zeros."""
    return is_zero(local[0]) and is_zero(local[1])


def is_still(rate: Rate) -> bool:
    """Whether a rate or acceleration is the ground's, ``STILL`` itself; one that only equals it is not."""
    return rate is STILL


def rotated(c: Scalar, s: Scalar, vector: Pair) -> Pair:
    """A vector turned by the angle whose cosine and sine are c and s."""
    a, b = vector
    if is_zero(b):
        return (0.0, 0.0) if is_zero(a) else (c * a, s * a)
    if is_zero(a):
        return (s * -b, c * b)
    return (c * a - s * b, s * a + c * b)


def arm(pose: Pose, local: Vector) -> Pair:
    """Vector, m, from a frame's origin to a point of its body, ``local`` in its frame, in the ground frame."""
    return rotated(pose[2], pose[3], local)


def point(pose: Pose, local: Vector) -> Pair:
    """Position, m, of a point of a body, ``local`` in its frame, in the ground frame."""
    if is_origin(local):
        return (pose[0], pose[1])
    r = arm(pose, local)
    return (pose[0] + r[0], pose[1] + r[1])


def point_rate(pose: Pose, rate: Rate, local: Vector) -> Pair:
    """First derivative over φ of a point of a body, ``local`` in its frame, in the ground frame."""
    if is_origin(local) or is_zero(rate[2]):
        return (rate[0], rate[1])
    r = arm(pose, local)
    return (rate[0] - rate[2] * r[1], rate[1] + rate[2] * r[0])


def point_acceleration(pose: Pose, rate: Rate, acceleration: Rate, local: Vector) -> Pair:
    """Second derivative over φ of a point of a body, ``local`` in its frame, in the ground frame."""
    if is_origin(local) or (is_zero(rate[2]) and is_zero(acceleration[2])):
        return (acceleration[0], acceleration[1])
    r = arm(pose, local)
    square = rate[2] * rate[2]
    return (
        acceleration[0] - acceleration[2] * r[1] - square * r[0],
        acceleration[1] + acceleration[2] * r[0] - square * r[1],
    )


def turned(pose: Pose, turn: Vector) -> Pair:
    """Cosine and sine of a body's angle plus a constant angle, ``turn`` (cos, sin)."""
    c, s = pose[2], pose[3]
    if is_zero(turn[1]) and is_one(turn[0]):
        return (c, s)
    return (c * turn[0] - s * turn[1], s * turn[0] + c * turn[1])


def pose_through(position: Pair, direction: Pair, local: Vector) -> Pose:
    """Pose of a body whose angle has the cosine and sine ``direction`` and whose point ``local`` lies at ``position``.

    ``local`` is in the body's frame, ``position`` in the ground's, m.
    """
    c, s = direction
    x, y = minus(position, rotated(c, s, local))
    return (x, y, c, s)


def rate_through(pose: Pose, velocity: Pair, turn_rate: Scalar, local: Vector) -> Rate:
    """Rate of a body at a pose, whose angle has the derivative ``turn_rate`` and its point ``local`` ``velocity``.

    Both are derivatives over φ; ``local`` is in the body's frame.
    """
    if is_origin(local) or is_zero(turn_rate):
        return (velocity[0], velocity[1], turn_rate)
    r = arm(pose, local)
    return (velocity[0] + turn_rate * r[1], velocity[1] - turn_rate * r[0], turn_rate)


def acceleration_through(pose: Pose, second: Pair, turn_rate: Scalar, turn_second: Scalar, local: Vector) -> Rate:
    """Second derivative of the pose of a body whose point ``local`` has the second derivative ``second``, over φ.

    ``turn_rate`` and ``turn_second`` are the first and second derivative of its angle; ``local`` is in the body's
    frame.
    """
    if is_origin(local) or (is_zero(turn_rate) and is_zero(turn_second)):
        return (second[0], second[1], turn_second)
    r = arm(pose, local)
    square = turn_rate * turn_rate
    return (
        second[0] + turn_second * r[1] + square * r[0],
        second[1] - turn_second * r[0] + square * r[1],
        turn_second,
    )


def minus(a: Pair, b: Pair) -> Pair:
    """Difference of two vectors."""
    return (a[0] if is_zero(b[0]) else a[0] - b[0], a[1] if is_zero(b[1]) else a[1] - b[1])


def point_along(place: Pair, travel: Scalar, direction: Pair) -> Pair:
    """The point at a signed ``travel``, m, along a unit vector ``direction`` from the point ``place``."""
    x, y = direction
    return (place[0] if is_zero(x) else place[0] + travel * x, place[1] if is_zero(y) else place[1] + travel * y)


def dot(a: Pair, b: Pair) -> Scalar:
    """Scalar product."""
    if is_zero(a[0]) or is_zero(b[0]):
        return a[1] * b[1]
    if is_zero(a[1]) or is_zero(b[1]):
        return a[0] * b[0]
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Pair, b: Pair) -> Scalar:
    """Vector product, its component out of the plane."""
    if is_zero(a[0]) or is_zero(b[1]):
        return -a[1] * b[0]
    if is_zero(a[1]) or is_zero(b[0]):
        return a[0] * b[1]
    return a[0] * b[1] - a[1] * b[0]


def carried_rate(pose: Pose, rate: Rate, position: Pair) -> Pair:
    """First derivative over φ of the point of a body that is just now at ``position``, m, ground frame."""
    if is_still(rate):
        return (0.0, 0.0)
    r = (position[0] - pose[0], position[1] - pose[1])
    return (rate[0] - rate[2] * r[1], rate[1] + rate[2] * r[0])


def carried_acceleration(pose: Pose, rate: Rate, acceleration: Rate, position: Pair) -> Pair:
    """Second derivative over φ of the point of a body that is just now at ``position``, m, ground frame."""
    if is_still(acceleration):
        return (0.0, 0.0)
    r = (position[0] - pose[0], position[1] - pose[1])
    square = rate[2] * rate[2]
    return (
        acceleration[0] - acceleration[2] * r[1] - square * r[0],
        acceleration[1] + acceleration[2] * r[0] - square * r[1],
    )


def across(vector: Pair) -> Pair:
    """The vector turned by a quarter of a turn, counter-clockwise."""
    return (-vector[1], vector[0])


def plus(a: Pair, b: Pair) -> Pair:
    """Sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1])


def coriolis(turn_rate: Scalar, travel: Scalar, direction: Pair) -> Pair:
    """The Coriolis term 2 θ' t' e⊥ of sliding along e on a host that turns.

    θ' is ``turn_rate``, t' is ``travel``, here the travel's first derivative over φ, e the unit vector ``direction``.
    """
    twice = 2.0 * turn_rate * travel
    return (-twice * direction[1], twice * direction[0])


def is_plain(vector: Pair) -> bool:
    """Whether both components are plain numbers, for which the standard library's functions serve."""
    return isinstance(vector[0], float | int) and isinstance(vector[1], float | int)


def length(vector: Pair) -> Scalar:
    """Length of a vector, free from overflow."""
    return math.hypot(vector[0], vector[1]) if is_plain(vector) else np.hypot(vector[0], vector[1])


def root(square: Scalar) -> Scalar:
    """Square root; zero for numbers below zero."""
    return np.sqrt(np.maximum(square, 0.0))


def inverse(number: Scalar) -> Scalar:
    """The reciprocal of a number; infinite for zero, also for a plain one, with NumPy's warning at most."""
    return np.divide(1.0, number)
