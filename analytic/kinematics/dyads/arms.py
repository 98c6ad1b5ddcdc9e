"""Arms and rails of a dyad's links, and when their lengths and angles are no more than rounding."""

from __future__ import annotations

from typing import Final

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics.frames import Pair, Scalar, is_zero
from analytic.kinematics.structure import Prismatic

UNASSEMBLED: Final = "cannot be assembled"
UNDETERMINED: Final = "is undetermined"

# Sine of the transmission angle below which no digit of a derivative is certain: the links' angles themselves are then
# known to about the same sqrt(eps) only.
LEAST_SINE: Final = 4.0 * float(np.finfo(float).eps) ** 0.5
# Lengths that differ by less than this share of what they were computed from are taken to be equal.
ROUNDING: Final = 8.0 * float(np.finfo(float).eps)


def over_square(arm: Vector, square: float) -> Vector:
    """A link's arm over its squared length, which turns the arm in the ground frame into the link's angle."""
    return (arm[0] / square, arm[1] / square)


def direction(vector: Pair, arm: Vector) -> Pair:
    """Cosine and sine of a link's angle from one of its arms in the ground frame, and in its own over the square."""
    a, b = arm
    if is_zero(b):
        return (vector[0] * a, vector[1] * a)
    return (vector[0] * a + vector[1] * b, vector[1] * a - vector[0] * b)


def on_rail(rail: Prismatic, local: Vector) -> Vector:
    """A point of the sliding body, in the frame it slides on, at zero travel."""
    c, s = rail.turn
    x, y = rail.origin
    return (x + c * local[0] - s * local[1], y + s * local[0] + c * local[1])


def size(a: Pair, b: Pair) -> Scalar:
    """Sum of the magnitudes of all components: the scale of rounding in a difference of two vectors."""
    return abs(a[0]) + abs(a[1]) + abs(b[0]) + abs(b[1])
