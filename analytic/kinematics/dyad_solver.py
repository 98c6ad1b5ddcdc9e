"""Solving a dyad within a linkage: from the placed bodies' poses, rates and accelerations to those of its two links.

One class per kind, each with the same steps. What a later step needs from an earlier one is kept on the instance, so
that asking for poses alone costs nothing more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Final, Protocol

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics.frames import Pair, Pose, Rate, Scalar
from analytic.kinematics.structure import Dyad, Joint, Prismatic, Revolute

Poses = Mapping[str, Pose]
Rates = Mapping[str, Rate]
At = Callable[[Scalar], float]  # picks the value at one crank angle

# Sine of the transmission angle below which no digit of a derivative is certain: the links' angles themselves are then
# known to about the same sqrt(eps) only.
LEAST_SINE: Final = 4.0 * float(np.finfo(float).eps) ** 0.5


# Lengths that differ by less than this share of what they were computed from are taken to be equal.
ROUNDING: Final = 8.0 * float(np.finfo(float).eps)


class Group(Protocol):
    """A dyad being solved; the mappings hold every body placed before it."""

    dyad: Dyad
    own: tuple[Pose, Pose]  # poses of the dyad's links, once asked for
    determinant: Scalar  # of the closure equations, known once the poses are; zero in a dead position

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        """Poses of the first and the second link."""
        ...

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        """First derivatives over φ."""
        ...

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        """Second derivatives over φ."""
        ...

    def meets(self) -> bool:
        """Whether the links meet at every crank angle, by a quick look that may err by a rounding."""
        ...

    def missing(self) -> tuple[Scalar, Scalar]:
        """Length by which the links fail to meet, m (negative where they do), and the lengths it was computed from."""
        ...

    def shortfall(self, at: At) -> str:
        """Which link misses by how much, and what to do, where the links do not meet."""
        ...

    def dead(self) -> Scalar:
        """Where the determinant is zero to working accuracy, so that the derivatives are undefined."""
        ...


def turning(joint: Joint) -> Revolute:
    """The joint as the R joint which the dyad's kind says it is."""
    assert isinstance(joint, Revolute)
    return joint


def sliding(joint: Joint) -> Prismatic:
    """The joint as the P joint which the dyad's kind says it is."""
    assert isinstance(joint, Prismatic)
    return joint


def difference(a: Vector, b: Vector) -> Vector:
    """Difference of two constant vectors."""
    return (a[0] - b[0], a[1] - b[1])


def length_of(a: Vector) -> float:
    """Length of a constant vector."""
    return math.hypot(*a)


def frame_direction(vector: Pair, length: float, local: Vector) -> Pair:
    """Cosine and sine of a link's angle from one of its arms in the ground frame and in its own."""
    a, b = local[0] / (length * length), local[1] / (length * length)
    if b == 0.0:
        return (vector[0] * a, vector[1] * a)
    return (vector[0] * a + vector[1] * b, vector[1] * a - vector[0] * b)


def on_rail(rail: Prismatic, local: Vector) -> Vector:
    """A point of the sliding body, in the frame it slides on, at zero travel."""
    c, s = rail.turn
    x, y = rail.origin
    return (x + c * local[0] - s * local[1], y + s * local[0] + c * local[1])


def size(*vectors: Pair) -> Scalar:
    """Sum of the magnitudes of all components: what a difference of the vectors has to be judged by."""
    total: Scalar = 0.0
    for x, y in vectors:
        total = total + abs(x) + abs(y)
    return total


def mm(length: float) -> str:
    """A length for a reader."""
    return f"{length * 1e3:.4g} mm"
