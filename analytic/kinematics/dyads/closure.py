"""What the five dyads share: the vectors of the closure equations, the travels along slides, limits of rounding.

Each dyad is solved by the vector method of the articles (chained vectors, sign W). The derivatives come from
differentiating the closure equations once and twice, which are linear in the unknown rates. A dyad's file has

``constants(first, inner, second, sign)``
    Its constants, a named tuple of pairs of floats, from its three joints and the sign of its assembly mode.
``poses(k, near)``
    Poses of its two links and the ``Closure``, from the constants and the poses of the two bodies it hangs on.
``rates(k, near, near_rates, own, closure)``
    First derivatives over φ, and the ``Travel``.
``accelerations(k, hosts, links, closure, travel)``
    Second derivatives over φ.
``least(k, closure)``
    The determinant up to which it stands in a dead position, so that its derivatives are undefined.
``missing(k, near, closure)``
    Length by which the links fail to meet, m (negative where they do not meet), and the lengths it was computed from.
``shortfall(dyad, k, near, at, written)``
    What is wrong, which link misses by how much, and what to do; ``at`` picks the value at one crank angle, ``written``
    writes a length.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics.frames import Pair, Pose, Rate, Scalar, is_zero
from analytic.kinematics.structure import Prismatic

At = Callable[[Scalar], float]
Written = Callable[[float], str]
Shortfall = tuple[str, str]
Poses = tuple[Pose, Pose]
Rates = tuple[Rate, Rate]
Hosts = tuple[Poses, Rates, Rates]  # the two bodies that the dyad hangs on, with both derivatives
Links = tuple[Poses, Rates]  # its own two

UNASSEMBLED: Final = "cannot be assembled"
UNDETERMINED: Final = "is undetermined"

# Sine of the transmission angle below which no digit of a derivative is certain: the links' angles themselves are then
# known to about the same sqrt(eps) only.
LEAST_SINE: Final = 4.0 * float(np.finfo(float).eps) ** 0.5
# Lengths that differ by less than this share of what they were computed from are taken to be equal.
ROUNDING: Final = 8.0 * float(np.finfo(float).eps)


class Closure(NamedTuple):
    """A dyad at known poses: the two vectors of its closure equations, their determinant, and a pin of the dyad.

    RRR: AC, BC and the pin C. RRP: AC, the slide's direction and C. RPR: the slide's direction, BA and A. RPP and PRP:
    the directions of the two slides and the pin.
    """

    u: Pair
    v: Pair
    determinant: Scalar
    pin: Pair


class Travel(NamedTuple):
    """The determinant's reciprocal, and the first derivatives of the travels along the dyad's slides."""

    scale: Scalar
    first: Scalar
    second: Scalar


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
    """Sum of the magnitudes of all components: what a difference of two vectors has to be judged by."""
    return abs(a[0]) + abs(a[1]) + abs(b[0]) + abs(b[1])
