"""Common parts of the five dyads: the form of their files, the vectors of the closure equations, travels of slides.

Each dyad is solved by the vector method of the articles (chained vectors, sign W). The derivatives come from
differentiating the closure equations once and twice, which are linear in the unknown rates. A dyad's file has

``constants(first, inner, second, sign)``
    Its constants, a named tuple of pairs of floats, from its three joints and the sign of its assembly mode.
``poses(k, near)``
    Poses of its two links and the ``Closure``, from the constants and the poses of the two bodies it hangs on.
``rates(k, near, near_rates, link_poses, closure)``
    First derivatives over φ, and the ``Travel``.
``accelerations(k, hosts, links, closure, travel)``
    Second derivatives over φ.
``least(k, closure)``
    The determinant up to which it stands in a dead position, so that its derivatives are undefined.
``missing(k, near, closure)``
    Length, m, by which the links reach beyond meeting, negative where they do not meet, and the lengths it comes from.
``toggle(dyad, closure)``
    How its links stand in a dead position, for a reader.
``shortfall(dyad, k, near, at, written)``
    Why the links do not meet: which link misses by how much, and the remedy; ``at`` picks the value at one crank
    angle, ``written`` writes a length.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from analytic.kinematics.frames import Pair, Pose, Rate, Scalar

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
