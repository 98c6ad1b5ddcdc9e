"""The five dyads in closed form: two sides, each a rod or a rail, that meet in a pin or slide on each other.

A side is a link with the outer joint that holds it: a ``Rod`` turns about a pin of its host, a ``Rail`` slides along a
line of it. Its motion has one unknown rate x, which moves the point that counts along a column d: r⊥ for a rod, r being
the vector from the outer pin to that point, and the line's direction e for a rail. Each dyad is solved by the vector
method of the articles (chained vectors, sign W). Differentiated, its closure equation is linear in its unknown rates:

    the sides meet in the inner pin C (RRR, RRP, PRP):          carried₁ + x₁ d₁ = carried₂ + x₂ d₂
    a line f of the side passes through the pin A (RPR, RPP):   A' = carried + x d + t f

``carried`` is the derivative of the point as the host alone moves it. The second derivatives obey the same equation;
``carried`` then has the terms of the first rates as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Pose, Rate, Scalar
from analytic.kinematics.structure import PUSHED, TURNED, ClosedGroup, DrivenDistance, Prismatic, Revolute

At = Callable[[Scalar], float]
Written = Callable[[float], str]
Shortfall = tuple[str, str]
Poses = tuple[Any, ...]  # of both links; None stands for a side that is no link
Rates = tuple[Any, ...]

UNASSEMBLED: Final = "cannot be assembled"
UNDETERMINED: Final = "is undetermined"
# Sine of the transmission angle below which no digit of a derivative is certain: the links' angles themselves are then
# known to about the same sqrt(eps) only.
LEAST_SINE: Final = 4.0 * float(np.finfo(float).eps) ** 0.5
# Lengths that differ by less than this share of what they were computed from are taken to be equal.
ROUNDING: Final = 8.0 * float(np.finfo(float).eps)


class Rod:
    """A link that turns about an outer pin of its host, with an arm of this ``length``, m, in its own frame.

    ``place`` comes before ``pose``, ``carried`` before ``rate``, ``carried_twice`` before ``second``.
    """

    r: Pair  # from the pin to the point that counts, m, as the dyad sets it
    x: Scalar  # the link's turning over φ, as the dyad sets it

    def __init__(self, outer: Revolute, arm: Vector, length: Scalar) -> None:
        """A side that turns about an outer pin; ``arm``, m, reaches in the link's frame to the point that counts.

        ``length`` is the arm's, m.
        """
        self.near, self.far, self.arm, self.length = outer.near_local, outer.far_local, arm, length
        square = length * length
        self.over = (arm[0] / square, arm[1] / square)

    def place(self, host: Pose) -> None:
        """Hang the side on its host at a pose; sets ``base``, the pin's position, m."""
        self.host, self.base = host, frames.point(host, self.near)

    def pose(self, vector: Pair) -> Pose:
        """Pose of the link whose arm is this vector, m, in the ground frame."""
        (x, y), (a, b) = vector, self.over
        direction = (x * a, y * a) if frames.is_zero(b) else (x * a + y * b, y * a - x * b)
        return frames.pose_through(self.base, direction, self.far)

    def moment(self, gap: Pair) -> Scalar:
        """The vector product gap × d, with the side's arm turned by a quarter as d, m²."""
        return frames.dot(gap, self.r)

    def column(self, link: Pose) -> Pair:
        """The direction of d, across the arm, of any length, at a pose of the link."""
        return frames.across(frames.arm(link, self.arm))

    def carried(self, host: Rate, point: Pair) -> Pair:
        """First derivative over φ of the point that counts if the link did not turn, m/rad.

        It is the pin's, whatever ``point`` is. Keeps the rate of the ``host`` for the second.
        """
        self.host_rate, self.base_rate = host, frames.point_rate(self.host, host, self.near)
        return self.base_rate

    def rate(self, link: Pose) -> Rate:
        """First derivative over φ of the link's pose, from that of its pin and its turning."""
        return frames.rate_through(link, self.base_rate, self.x, self.far)

    @property
    def turning(self) -> Scalar:
        """First derivative of the link's angle over φ."""
        return self.x

    def carried_twice(self, host: Rate, point: Pair) -> Pair:
        """Second derivative over φ of the point that counts if the angle had no slope x': A'' − θ'² r.

        ``host`` is the second derivative of the host's pose. Keeps the pin's, A''.
        """
        self.base_second = frames.point_acceleration(self.host, self.host_rate, host, self.near)
        square = self.x * self.x
        return (self.base_second[0] - square * self.r[0], self.base_second[1] - square * self.r[1])

    def second(self, link: Pose, slope: Scalar) -> Rate:
        """Second derivative of the link's pose over φ; ``slope`` is that of its angle."""
        return frames.acceleration_through(link, self.base_second, self.x, slope, self.far)


class Rail:
    """A link that slides on its host along ``e``; its point ``local`` counts. The rate ``x`` is that of its travel.

    The methods come in the order as for ``Rod``.
    """

    x: Scalar
    length = 1.0  # of e

    def __init__(self, outer: Prismatic, local: Vector) -> None:
        """A side that slides on an outer guide; ``local``, m, is the point that counts in the link's frame."""
        self.along, self.turn, self.local, self.start = outer.along, outer.turn, local, point_on_rail(outer, local)

    def place(self, host: Pose) -> None:
        """Put the side on its host at a pose; sets ``base``, the position, m, at zero travel, and ``e``."""
        self.host, self.base, self.e = host, frames.point(host, self.start), frames.arm(host, self.along)

    def pose(self, point: Pair) -> Pose:
        """Pose of the link whose point that counts is at ``point``, m, in the ground frame."""
        return frames.pose_through(point, frames.turned(self.host, self.turn), self.local)

    def moment(self, gap: Pair) -> Scalar:
        """The vector product gap × d, with the rail's unit direction as d, m."""
        return frames.cross(gap, self.e)

    def column(self, link: Pose) -> Pair:
        """The direction d of the rail, a unit vector, the same at every pose of the link."""
        return self.e

    def carried(self, host: Rate, point: Pair) -> Pair:
        """First derivative over φ of the host's point that is just now at ``point``, m/rad.

        Keeps the rate of the ``host`` for the second.
        """
        self.host_rate = host
        return frames.carried_rate(self.host, host, point)

    def rate(self, link: Pose) -> Rate:
        """First derivative over φ of the link's pose: the host carries its origin, and the travel moves it."""
        origin = frames.carried_rate(self.host, self.host_rate, (link[0], link[1]))
        return (*frames.point_along(origin, self.x, self.e), self.host_rate[2])

    @property
    def turning(self) -> Scalar:
        """First derivative of the link's angle over φ, which is its host's."""
        return self.host_rate[2]

    def carried_twice(self, host: Rate, point: Pair) -> Pair:
        """Second derivative over φ of the host's point just now at ``point``, with the Coriolis term.

        ``host`` is the second derivative of the host's pose, which is kept.
        """
        self.host_second = host
        carried = frames.carried_acceleration(self.host, self.host_rate, host, point)
        if frames.is_still(self.host_rate):
            return carried
        return frames.plus(carried, frames.coriolis(self.host_rate[2], self.x, self.e))

    def second(self, link: Pose, slope: Scalar) -> Rate:
        """Second derivative of the link's pose over φ; ``slope`` is that of its travel."""
        origin = self.carried_twice(self.host_second, (link[0], link[1]))
        return (*frames.point_along(origin, slope, self.e), self.host_second[2])


class Strut(Rod):
    """The driving cylinder: a rod of the length φ, which turns about its near end and is no link, so has no pose."""

    def __init__(self, cylinder: DrivenDistance, length: Scalar) -> None:
        """A driving cylinder as a side, with its length, m, which is φ."""
        self.near, self.length = cylinder.near_local, length

    def pose(self, vector: Pair) -> None:  # type: ignore[override]
        """Return None, as a cylinder has no pose of its own, and keep its direction u, from ``vector``, m."""
        self.u = (vector[0] / self.length, vector[1] / self.length)

    def column(self, link: Pose) -> Pair:
        """The direction across the cylinder."""
        return frames.across(self.u)

    def carried(self, host: Rate, point: Pair) -> Pair:
        """First derivative over φ of its far end if it did not turn: the length grows with φ.

        Keeps the rate of the ``host`` for the second.
        """
        return frames.plus(super().carried(host, point), self.u)

    def carried_twice(self, host: Rate, point: Pair) -> Pair:
        """Second derivative over φ of its far end without x', with the Coriolis term of the growing length.

        ``host`` is the second derivative of the host's pose.
        """
        return frames.plus(super().carried_twice(host, point), frames.coriolis(self.x, 1.0, self.u))


def point_on_rail(rail: Prismatic, local: Vector) -> Vector:
    """A point of the sliding body, ``local`` in its frame, in the frame it slides on, at zero travel, m."""
    c, s = rail.turn
    x, y = rail.origin
    return (x + c * local[0] - s * local[1], y + s * local[0] + c * local[1])


def _magnitude_sum(a: Pair, b: Pair) -> Scalar:
    """Sum of the magnitudes of all components of two vectors: the scale of rounding in their difference."""
    return abs(a[0]) + abs(a[1]) + abs(b[0]) + abs(b[1])


class _DyadForm:
    """What is common to all: parallel guides, of which the others know more. ``sign`` picks the assembly mode.

    ``coordinate`` is φ, which the driving cylinder needs as its length. ``make_sides`` makes the sides from the joints.
    ``determinant`` vanishes in dead positions; its sign is that of the assembly mode.
    """

    determinant: Scalar
    make_sides: Callable[[], tuple[Any, ...]]

    def __init__(self, dyad: ClosedGroup, sign: Scalar, coordinate: Scalar = None) -> None:
        """Set up the sides of a dyad; ``sign`` selects its assembly mode, ``coordinate`` is φ, m, for a cylinder.

        ``sign`` is 1 or -1, or one for each φ, 0 with a single mode.
        """
        self.dyad, self.sign, self.coordinate = dyad, sign, coordinate
        self.joints: tuple[Any, ...] = dyad.joints  # of the kinds that the group's says
        self.sides = self.make_sides()

    @property
    def outer_pins(self) -> str:
        """Names of the two outer pins, quoted, as words: "'A' and 'B'"."""
        return f"'{self.joints[0].point}' and '{self.joints[2].point}'"

    def least_determinant(self) -> Scalar:
        """The magnitude of the determinant up to which the dyad stands in a dead position.

        Its derivatives are undefined there.
        """
        return LEAST_SINE

    def dead_position(self) -> str:
        """The words, the end of a sentence, for how the links stand in a dead position."""
        return f"the guides of {self.dyad.words} parallel"

    def reach_margin(self) -> tuple[Scalar, Scalar]:
        """For guides: 1 where they cross by more than rounding, −1 where they are parallel, and 0 in place of lengths.

        Other forms give the length, m, by which the links reach beyond meeting, negative if short, and the lengths it
        comes from.
        """
        return np.sign(abs(self.determinant) - ROUNDING), 0.0

    def gap(self) -> Scalar:
        """Distance of the two outer pins, m; infinite for these forms, which have not two."""
        return math.inf

    def snap_to_touch(self, margin: Scalar, gap: Scalar) -> None:
        """Where a ``margin``, m, is a rounding of zero, set lengths of the sides with which the links just touch.

        ``gap``, m, is the distance of the outer pins there. Nothing for guides.
        """

    def fault(self, at: At, written: Written) -> Shortfall:
        """Why the links do not meet, as a fault and a sentence on the link, the length it misses and the remedy.

        ``at`` picks a value's number at one crank angle, ``written`` writes a length, m. The fault is ``UNASSEMBLED``
        or ``UNDETERMINED``, always the latter for guides.
        """
        return UNDETERMINED, (
            f"the guides of {self.dyad.words} are parallel, so nothing holds the two in place; turn one of the guides"
        )


class _PinDyad(_DyadForm):
    """Two sides that meet in the inner pin C: x₁ d₁ − x₂ d₂ = carried₂ − carried₁.

    ``meet`` finds C, the determinant d₁ × d₂ and the vectors of rods, and returns the links' poses.
    """

    pin: Pair
    meet: Callable[[], Poses]

    def poses(self, hosts: Poses) -> Poses:
        """Poses of both links between their hosts, whose poses are ``hosts``; nan where they are undefined.

        The result of a cylinder, which is no link, is None.
        """
        for side, host in zip(self.sides, hosts, strict=True):
            side.place(host)
        return self.meet()

    def rates(self, hosts: Rates, links: Poses) -> Rates:
        """First derivatives over φ of the links' poses from those of the hosts; the poses must have been worked out.

        ``links`` are the poses, None for a cylinder, which has None for an answer.
        """
        carried = [side.carried(host, self.pin) for side, host in zip(self.sides, hosts, strict=True)]
        self.scale = frames.inverse(self.determinant)
        first, second = self.sides
        first.x, second.x = self._solved(carried)
        return tuple(link and side.rate(link) for side, link in zip(self.sides, links, strict=True))

    def seconds(self, hosts: Rates, links: Poses) -> Rates:
        """Second derivatives over φ of the links' poses from those of the hosts; the first ones must be known.

        ``links`` are the poses, None for a cylinder, which has None for an answer.
        """
        carried = [side.carried_twice(host, self.pin) for side, host in zip(self.sides, hosts, strict=True)]
        slopes = zip(self.sides, links, self._solved(carried), strict=True)
        return tuple(link and side.second(link, slope) for side, link, slope in slopes)

    def least_determinant(self) -> Scalar:
        """The magnitude of a determinant of columns that are parallel but for ``LEAST_SINE``.

        It is the bound of a dead position.
        """
        first, second = self.sides
        return LEAST_SINE * first.length * second.length

    def columns(self, links: Poses) -> tuple[Pair, Pair]:
        """Directions d₁ and d₂ of the sides at these poses of the links, of any length; parallel in a dead position."""
        first, second = self.sides
        return first.column(links[0]), second.column(links[1])

    def _bases_size(self) -> Scalar:
        """Sum of the magnitudes of both bases' coordinates, m: the scale of rounding in their difference."""
        first, second = self.sides
        return _magnitude_sum(first.base, second.base)

    def _solved(self, carried: Sequence[Pair]) -> tuple[Scalar, Scalar]:
        """The rates x' of both sides' unknowns, an angle or a travel, or their slopes, from what ``carried`` gives.

        ``carried`` has the derivative of the point that counts, first or second, as each host alone moves it.
        """
        first, second = self.sides
        gap = frames.minus(carried[1], carried[0])
        return second.moment(gap) * self.scale, first.moment(gap) * self.scale


class RRR(_PinDyad):
    """Two circles: A + r = B + q with |r| and |q| given; C lies left of A→B for sign +1.

    The determinant r × q is |AB| times C's distance from the line AB.
    """

    def make_sides(self) -> tuple[Any, Any]:
        """Both arms, from A to C and from B to C."""
        first, inner, second = self.joints
        return _rod(first, inner.far_local), _rod(second, inner.near_local)

    def meet(self) -> Poses:
        """Poses of both links; the radicand is a product (Heron), so that it is accurate near dead positions.

        Sets the determinant, the arms and the place of the inner pin.
        """
        first, second = self.sides
        total, difference = first.length + second.length, first.length - second.length
        d = frames.minus(second.base, first.base)
        square = frames.dot(d, d)
        radicand = (total * total - square) * (square - difference * difference)
        self.determinant = (0.5 * self.sign) * frames.root(radicand)
        scale = frames.inverse(square)
        along, across = 0.5 + (0.5 * difference * total) * scale, self.determinant * scale
        first.r = (along * d[0] - across * d[1], along * d[1] + across * d[0])
        self.pin = frames.plus(first.base, first.r)
        second.r = frames.minus(self.pin, second.base)
        return first.pose(first.r), second.pose(second.r)

    def dead_position(self) -> str:
        """The words for a dead position: the arms are stretched or folded."""
        first, second = self.sides
        return "stretched in one line" if np.all(frames.dot(first.r, second.r) < 0.0) else "folded in one line"

    def gap(self) -> Scalar:
        """The distance AB of the outer pins, m."""
        d = frames.minus(self.sides[1].base, self.sides[0].base)
        return np.sqrt(frames.dot(d, d))

    def reach_margin(self) -> tuple[Scalar, Scalar]:
        """The smaller of arms' sum less AB and AB less arms' difference, m, and the lengths it comes from."""
        first, second = (side.length for side in self.sides)
        gap = self.gap()
        return np.minimum(first + second - gap, gap - abs(first - second)), self._bases_size() + first + second

    def snap_to_touch(self, margin: Scalar, gap: Scalar) -> None:
        """Take the gap, m, as the arms' sum or difference, whichever is nearer, so that the links just meet.

        Sets both arms' lengths, equal ones where the pins lie on top of each other; ``margin`` does not count.
        """
        first, second = self.sides
        total, difference = first.length + second.length, first.length - second.length
        if abs(total - gap) < abs(gap - abs(difference)):
            total = gap
        elif gap <= ROUNDING * total:  # pins on top of each other: the gap's own rounding is no length
            difference = 0.0
        else:
            difference = gap if difference > 0.0 else -gap
        first.length, second.length = 0.5 * (total + difference), 0.5 * (total - difference)

    def fault(self, at: At, written: Written) -> Shortfall:
        """The shortfall, as a fault and a sentence: arms too short for the gap, one too long, or pins that coincide.

        The fault is ``UNDETERMINED`` where pins coincide and the arms are equal, else ``UNASSEMBLED``. ``at`` takes a
        value's number at the place, ``written`` writes a length, m.
        """
        dyad, (first, second), other = self.dyad, (side.length for side in self.sides), self.dyad.links[1]
        gap = at(self.gap())
        links = f"'{dyad.first}' ({written(first)}) and '{other}' ({written(second)})"
        if gap == 0.0:
            fault = UNDETERMINED if first == second else UNASSEMBLED
            return fault, f"{links} have their outer pins on top of each other; move one of the pivots"
        between = f"the gap of {written(gap)} between {self.outer_pins}"
        if gap > first + second:
            return UNASSEMBLED, (
                f"{links} together are {written(gap - first - second)} shorter than {between}; lengthen one of them, "
                "shorten the crank or move the pivots closer together"
            )
        longer, shorter = (dyad.first, other) if first > second else (other, dyad.first)
        return UNASSEMBLED, (
            f"{links} differ by {written(abs(first - second) - gap)} more than {between}; shorten '{longer}', lengthen "
            f"'{shorter}' or move the pivots apart"
        )


class RRP(_PinDyad):
    """A circle and a line: A + r = base + t e with |r| given; r · e, the determinant, has the sign given."""

    def make_sides(self) -> tuple[Any, Any]:
        """The arm from A as first side, the slide as second."""
        first, inner, second = self.joints
        return _rod(first, inner.far_local), Rail(second, inner.near_local)

    def meet(self) -> Poses:
        """Poses of both links, from A's distance to the line as the arm's component across it.

        Sets the offset, the determinant, the arm and the place of the inner pin. Raises nothing: where A is farther
        from the line than the arm is long, the determinant is 0 and the poses do not close.
        """
        rod, rail = self.sides
        offset = self.offset = frames.cross(rail.e, frames.minus(rail.base, rod.base))
        self.determinant = self.sign * frames.root((rod.length - offset) * (rod.length + offset))
        rod.r = frames.rotated(self.determinant, offset, rail.e)
        self.pin = frames.plus(rod.base, rod.r)
        return rod.pose(rod.r), rail.pose(self.pin)

    def _solved(self, carried: Sequence[Pair]) -> tuple[Scalar, Scalar]:
        """The rates x' of the arm's angle and the slide's travel, or their slopes, from what ``carried`` gives.

        They are solved with the sides exchanged, since the slide comes second.
        """
        return super()._solved(carried[::-1])  # r⊥ × e is −r · e

    def dead_position(self) -> str:
        """The words for a dead position: the arm is square to the line."""
        return f"'{self.joints[0].far}' square to the guide of '{self.joints[2].far}'"

    def reach_margin(self) -> tuple[Scalar, Scalar]:
        """The arm's length less A's distance from the line, m, and the lengths it comes from."""
        length = self.sides[0].length
        return length - abs(self.offset), self._bases_size() + length

    def snap_to_touch(self, margin: Scalar, gap: Scalar) -> None:
        """Take the distance from A to the line as the arm's length, so that the arm just reaches it.

        That is the length less the ``margin``, m; ``gap`` does not count.
        """
        self.sides[0].length -= margin

    def fault(self, at: At, written: Written) -> Shortfall:
        """The shortfall, as a fault, always ``UNASSEMBLED``, and a sentence, of an arm that does not reach the line.

        ``at`` takes a value's number at the place, ``written`` writes a length, m.
        """
        dyad, distance, length = self.dyad, at(abs(self.offset)), self.sides[0].length
        return UNASSEMBLED, (
            f"'{dyad.first}' ({written(length)}) is {written(distance - length)} too short to reach the guide of "
            f"'{dyad.links[1]}', {written(distance)} away from '{self.joints[0].point}'; lengthen it or move the "
            "guide closer"
        )


class PRP(_PinDyad):
    """Two lines: C = base₁ + t e = base₂ + u f, with one assembly mode; the determinant is e × f."""

    def make_sides(self) -> tuple[Any, Any]:
        """Both slides."""
        first, inner, second = self.joints
        return Rail(first, inner.far_local), Rail(second, inner.near_local)

    def meet(self) -> Poses:
        """Poses of both links; the first travel follows from the vector product with the second line.

        Sets the determinant and the place of the inner pin.
        """
        first, second = self.sides
        self.determinant = frames.cross(first.e, second.e)
        travel = second.moment(frames.minus(second.base, first.base)) * frames.inverse(self.determinant)
        self.pin = frames.point_along(first.base, travel, first.e)
        return first.pose(self.pin), second.pose(self.pin)


class _SlideDyad(_DyadForm):
    """The first link turns with the second, the side, whose line f passes through A: A' = carried + x d + t f.

    ``align`` finds f and the determinant f × d, and returns the pose of the second link.
    """

    f: Pair
    side: Any
    align: Callable[[], Pose]
    side_column: Callable[[], Pair]

    def poses(self, hosts: Poses) -> Poses:
        """Poses of both links between their hosts, whose poses are ``hosts``; nan where they are undefined."""
        (self.side,), (outer, inner, _) = self.sides, self.joints
        self.host, self.near, self.far = hosts[0], outer.near_local, outer.far_local
        self.pin = frames.point(self.host, self.near)
        self.side.place(hosts[1])
        second = self.align()
        direction = frames.rotated(second[2], second[3], inner.turn)
        return frames.pose_through(self.pin, direction, self.far), second

    def columns(self, links: Poses) -> tuple[Pair, Pair]:
        """Directions d and f of the sides at these poses of the links, of any length; parallel in a dead position."""
        return self.side_column(), frames.arm(links[1], self.joints[1].along)

    def rates(self, hosts: Rates, links: Poses) -> Rates:
        """First derivatives over φ of the links' poses from those of the hosts; ``links`` are the poses.

        They must have been worked out. Keeps what the second ones need.
        """
        self.host_rate, moved = hosts[0], frames.point_rate(self.host, hosts[0], self.near)
        self.scale = frames.inverse(self.determinant)
        gap = frames.minus(moved, self.side.carried(hosts[1], self.pin))
        self.travel = self.side.moment(gap) * self.scale
        self.side.x = frames.cross(self.f, gap) * self.scale
        second = self.side.rate(links[1])
        return frames.rate_through(links[0], moved, second[2], self.far), second

    def seconds(self, hosts: Rates, links: Poses) -> Rates:
        """Second derivatives over φ of the links' poses from those of the hosts, with the Coriolis term of the travel.

        ``links`` are the poses; the first derivatives must be known.
        """
        turning = self.side.turning
        moved = frames.point_acceleration(self.host, self.host_rate, hosts[0], self.near)
        carried = self.side.carried_twice(hosts[1], self.pin)
        gap = frames.minus(frames.minus(moved, carried), frames.coriolis(turning, self.travel, self.f))
        second = self.side.second(links[1], frames.cross(self.f, gap) * self.scale)
        return frames.acceleration_through(links[0], moved, turning, second[2], self.far), second


class RPR(_SlideDyad):
    """A line of the second link at a fixed offset from B passes through A: d = A − B = t e + offset e⊥.

    The determinant is t, A's coordinate along the line from B's foot.
    """

    def make_sides(self) -> tuple[Any]:
        """The line of the second link, as the only side, an arm of unit length.

        Sets the line's ``offset`` from B, m.
        """
        first, inner, second = self.joints
        self.offset = frames.cross(inner.along, frames.minus(point_on_rail(inner, first.far_local), second.far_local))
        return (Rod(second, inner.along, 1.0),)

    def align(self) -> Pose:
        """The second link's pose, from the slide's direction; nan where A passes through B, which leaves it open.

        Sets f and the determinant.
        """
        d = self.side.r = frames.minus(self.pin, self.side.base)
        square = frames.dot(d, d)
        self.determinant = self.sign * frames.root(square - self.offset * self.offset)
        if frames.is_zero(self.offset):
            scale = frames.inverse(self.determinant)
            self.f = (d[0] * scale, d[1] * scale)
        else:
            scale = frames.inverse(square)
            self.f = frames.rotated(self.determinant * scale, -self.offset * scale, d)
        second: Pose = self.side.pose(self.f)
        return second

    def side_column(self) -> Pair:
        """The direction across the line of the pins."""
        return frames.across(self.side.r)

    def least_determinant(self) -> Scalar:
        """The magnitude of the determinant, m, up to which A counts as at the foot of B's perpendicular to the line."""
        return LEAST_SINE * (_magnitude_sum(self.pin, self.side.base) + abs(self.offset))

    def dead_position(self) -> str:
        """The words for a dead position: the slide is square to the line through the outer pins."""
        return f"the slide square to the line of '{self.joints[0].name}' and '{self.joints[2].name}'"

    def gap(self) -> Scalar:
        """The distance AB of the outer pins, m."""
        return np.sqrt(frames.dot(self.side.r, self.side.r))

    def reach_margin(self) -> tuple[Scalar, Scalar]:
        """Distance AB less the line's offset from B, m, and the lengths it comes from.

        Without an offset it is AB less a rounding.
        """
        offset, pins = abs(self.offset), _magnitude_sum(self.pin, self.side.base)
        return self.gap() - (offset + (2.0 * ROUNDING) * pins * (offset == 0.0)), pins + offset

    def snap_to_touch(self, margin: Scalar, gap: Scalar) -> None:
        """Set the line's offset to the distance of the pins, so that the line just touches A.

        Its size grows by the ``margin``, m; ``gap`` does not count. An offset of 0 stays.
        """
        self.offset += np.sign(self.offset) * margin

    def fault(self, at: At, written: Written) -> Shortfall:
        """The shortfall, as a fault and a sentence: the offset too large, or A on B.

        The fault is ``UNASSEMBLED``, in the second case ``UNDETERMINED``. ``at`` takes a value's number at the place,
        ``written`` writes a length, m.
        """
        dyad, distance, offset = self.dyad, at(self.gap()), abs(self.offset)
        if offset == 0.0:
            return UNDETERMINED, (
                f"{self.outer_pins} coincide, so the direction of the slide between {dyad.words} is "
                "undefined; move the pivot off the pin's path"
            )
        return UNASSEMBLED, (
            f"the slide between {dyad.words} is offset by {written(offset)}, "
            f"{written(offset - distance)} more than the distance between {self.outer_pins}; lessen the offset or "
            "move the pivot away"
        )


class RPP(_SlideDyad):
    """Two lines of one direction each: A = base + x e + t f, with one assembly mode; the determinant is f × e."""

    def make_sides(self) -> tuple[Any]:
        """The slide, as the only side."""
        first, inner, second = self.joints
        return (Rail(second, point_on_rail(inner, first.far_local)),)

    def align(self) -> Pose:
        """The second link's pose: it keeps its host's direction, and x follows from the vector product with f.

        Sets f and the determinant.
        """
        rail = self.side
        self.f = frames.rotated(*frames.turned(rail.host, rail.turn), self.joints[1].along)
        self.determinant = frames.cross(self.f, rail.e)
        gap = frames.minus(self.pin, rail.base)
        travel = frames.cross(self.f, gap) * frames.inverse(self.determinant)
        second: Pose = rail.pose(frames.point_along(rail.base, travel, rail.e))
        return second

    def side_column(self) -> Pair:
        """The direction of the rail, a unit vector."""
        direction: Pair = self.side.e
        return direction


class _DrivenForm(_PinDyad):
    """One link between a placed body and the driving cylinder: a dyad of which the other side is the cylinder."""

    def fault(self, at: At, written: Written) -> Shortfall:
        """The shortfall, as a fault, always ``UNASSEMBLED``, and a sentence: the cylinder too short or too long.

        ``at`` takes a value's number at the place, ``written`` writes a length, m.
        """
        length, link = at(self.coordinate), self.dyad.first
        return UNASSEMBLED, f"the cylinder of {written(length)} does not reach '{link}'; stay within its range"


class TurnedLink(_DrivenForm, RRR):
    """A link on a pin: the triangle of its arm, the cylinder and the line between their pins (law of cosines)."""

    def make_sides(self) -> tuple[Any, Any]:
        """The arm as first side, the cylinder as second."""
        outer, cylinder = self.joints
        return _rod(outer, cylinder.far_local), Strut(cylinder, self.coordinate)


class PushedLink(_DrivenForm, RRP):
    """A link on a slide: the cylinder's far end is where the circle about its near end crosses a line."""

    def make_sides(self) -> tuple[Any, Any]:
        """The cylinder as first side, the slide as second."""
        cylinder, outer = self.joints
        return Strut(cylinder, self.coordinate), Rail(outer, cylinder.far_local)

    def dead_position(self) -> str:
        """The words for a dead position: the cylinder is square to the line."""
        return f"the cylinder square to the guide of '{self.dyad.first}'"


def _rod(outer: Revolute, inner: Vector) -> Rod:
    """A rod: the side between an outer pin and the inner pin, which is at the point ``inner`` of the link.

    It is in the link's frame, m.
    """
    arm = frames.minus(inner, outer.far_local)
    return Rod(outer, arm, frames.length(arm))


FORMS: Final[Mapping[str, Callable[[ClosedGroup, Scalar, Scalar], Any]]] = {
    "RRR": RRR, "RRP": RRP, "RPR": RPR, "RPP": RPP, "PRP": PRP, TURNED: TurnedLink, PUSHED: PushedLink,
}  # fmt: skip
