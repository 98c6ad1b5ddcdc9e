"""Common parts of the five dyads: the form of their files, the vectors of the closure equations, travels of slides.

Each dyad is solved by the vector method of the articles (chained vectors, sign W). The derivatives come from
differentiating the closure equations once and twice, which are linear in the unknown rates. A dyad's file has

``constants(first, inner, second, sign)``
    Its constants, a named tuple of pairs of floats, from its three joints and the sign of its assembly mode.
``poses(k, host_poses)``
    Poses of its two links and the ``Closure``, from the constants and the poses of the two bodies it hangs on.
``rates(k, host_poses, host_rates, link_poses, closure)``
    First derivatives over φ, and the ``Travel``.
``accelerations(k, hosts, links, closure, travel)``
    Second derivatives over φ.
``dead_determinant(k, closure)``
    The determinant up to which it stands in a dead position, so that its derivatives are undefined.
``reach_margin(k, host_poses, closure)``
    Length, m, by which the links reach beyond meeting, negative where they do not meet, and the lengths it comes from.
``dead_position_text(dyad, closure)``
    How its links stand in a dead position, for a reader.
``assembly_fault(dyad, k, host_poses, at, written)``
    Why the links do not meet: which link misses by how much, and the remedy; ``at`` picks the value at one crank
    angle, ``written`` writes a length.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics.frames import Pair, Pose, Rate, Scalar, cross, is_zero
from analytic.kinematics.structure import Dyad, Prismatic

At = Callable[[Scalar], float]
Written = Callable[[float], str]
Shortfall = tuple[str, str]
Poses = tuple[Pose, Pose]
Rates = tuple[Rate, Rate]
Hosts = tuple[Poses, Rates, Rates]  # the two bodies that the dyad hangs on, with both derivatives
Links = tuple[Poses, Rates]  # its own two


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


# Arms and rails of a dyad's links, and when their lengths and angles are no more than rounding.

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


def point_on_rail(rail: Prismatic, local: Vector) -> Vector:
    """A point of the sliding body, in the frame it slides on, at zero travel."""
    c, s = rail.turn
    x, y = rail.origin
    return (x + c * local[0] - s * local[1], y + s * local[0] + c * local[1])


def size(a: Pair, b: Pair) -> Scalar:
    """Sum of the magnitudes of all components of two vectors: the scale of rounding in their difference."""
    return abs(a[0]) + abs(a[1]) + abs(b[0]) + abs(b[1])


# Common part of RPP and PRP: two lines along e and f, t e − u f = gap, with one assembly mode.
#
# The determinant e × f vanishes where the lines are parallel.

Constants = tuple[Vector, ...]


def solve_slides(e: Pair, f: Pair, gap: Pair, scale: Scalar) -> Pair:
    """Solve t e − u f = gap for (t, u): travels along two slides, or their derivatives; ``scale`` is 1 / e × f."""
    return (cross(gap, f) * scale, cross(gap, e) * scale)


def dead_determinant(k: Constants, closure: Closure) -> Scalar:
    """The determinant up to which the two lines count as parallel."""
    return LEAST_SINE


def reach_margin(k: Constants, host_poses: Poses, closure: Closure) -> tuple[Scalar, Scalar]:
    """No length is missing, but parallel lines do not cross."""
    return np.sign(abs(closure.determinant) - ROUNDING), 0.0


def dead_position_text(dyad: Dyad, closure: Closure) -> str:
    """The dead position in words: the lines are parallel."""
    return f"the guides of '{dyad.first}' and '{dyad.second}' parallel"


def assembly_fault(dyad: Dyad, k: Constants, host_poses: Poses, at: At, written: Written) -> Shortfall:
    """Why the links of a dyad with two guides do not meet, as a fault and a sentence: the guides are parallel."""
    return UNDETERMINED, (
        f"the guides of '{dyad.first}' and '{dyad.second}' are parallel, so nothing holds the two in "
        "place; turn one of the guides"
    )
