"""The dyads with two assembly modes, whose closure is quadratic: RRR, RRP and RPR.

A and B are the outer joints, C the inner one; r = AC and q = BC. See ``closure.Group`` for the steps they share.
"""

from __future__ import annotations

import numpy as np

from analytic.kinematics import frames
from analytic.kinematics.dyad_solver import (
    LEAST_SINE,
    ROUNDING,
    At,
    Poses,
    Rates,
    difference,
    frame_direction,
    length_of,
    mm,
    on_rail,
    size,
    sliding,
    turning,
)
from analytic.kinematics.frames import Pose, Rate, Scalar
from analytic.kinematics.structure import Dyad


class TwoTurningArms:
    """RRR: both links turn about placed pins and share the inner pin."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.b = turning(dyad.first_joint), turning(dyad.second_joint)
        inner = turning(dyad.inner_joint)
        self.first_arm = difference(inner.far_local, self.a.far_local)
        self.second_arm = difference(inner.near_local, self.b.far_local)
        self.lengths = (length_of(self.first_arm), length_of(self.second_arm))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        """Two circles: A + r = B + q with |r| and |q| given."""
        a = frames.point(poses[self.a.near], self.a.near_local)
        b = frames.point(poses[self.b.near], self.b.near_local)
        self.pins = (a, b)
        self.r, self.determinant, self.radicand = frames.two_circles(a, b, *self.lengths, self.dyad.sign)
        self.q = (self.r[0] + a[0] - b[0], self.r[1] + a[1] - b[1])
        one = frames.pose_through(a, frame_direction(self.r, self.lengths[0], self.first_arm), self.a.far_local)
        two = frames.pose_through(b, frame_direction(self.q, self.lengths[1], self.second_arm), self.b.far_local)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        """Closure once differentiated: A' + θ1' r⊥ = B' + θ2' q⊥."""
        a = frames.point_rate(poses[self.a.near], rates[self.a.near], self.a.near_local)
        b = frames.point_rate(poses[self.b.near], rates[self.b.near], self.b.near_local)
        self.scale = 1.0 / self.determinant
        apart = frames.minus(b, a)
        self.w = (frames.dot(apart, self.q) * self.scale, frames.dot(apart, self.r) * self.scale)
        return (
            frames.rate_through(self.own[0], a, self.w[0], self.a.far_local),
            frames.rate_through(self.own[1], b, self.w[1], self.b.far_local),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        """Closure twice differentiated: A'' + θ1'' r⊥ - θ1'² r = B'' + θ2'' q⊥ - θ2'² q."""
        near_a, near_b = self.a.near, self.b.near
        a = frames.point_acceleration(poses[near_a], rates[near_a], accelerations[near_a], self.a.near_local)
        b = frames.point_acceleration(poses[near_b], rates[near_b], accelerations[near_b], self.b.near_local)
        one, two = self.w[0] * self.w[0], self.w[1] * self.w[1]
        g = (b[0] - a[0] + one * self.r[0] - two * self.q[0], b[1] - a[1] + one * self.r[1] - two * self.q[1])
        first, second = frames.dot(g, self.q) * self.scale, frames.dot(g, self.r) * self.scale
        return (
            frames.acceleration_through(self.own[0], a, self.w[0], first, self.a.far_local),
            frames.acceleration_through(self.own[1], b, self.w[1], second, self.b.far_local),
        )

    def meets(self) -> bool:
        """The circles cut or touch; equal circles about one centre leave the inner pin undefined."""
        defined = self.lengths[0] != self.lengths[1] or np.all(np.isfinite(self.r[0]))
        return bool(defined and np.all(self.radicand >= 0.0))

    def missing(self) -> tuple[Scalar, Scalar]:
        """The sum of the arms less the gap AB, or the gap less their difference."""
        gap = np.hypot(*frames.minus(self.pins[1], self.pins[0]))
        first, second = self.lengths
        return np.minimum(first + second - gap, gap - abs(first - second)), size(*self.pins) + first + second

    def shortfall(self, at: At) -> str:
        """Arms too short for the gap, or one too long."""
        gap = at(np.hypot(*frames.minus(self.pins[1], self.pins[0])))
        first, second = self.lengths
        links = f"'{self.dyad.first}' ({mm(first)}) and '{self.dyad.second}' ({mm(second)})"
        if gap == 0.0:
            return f"{links} have their outer pins on top of each other; move one of the pivots"
        between = f"the gap of {mm(gap)} between '{self.a.point}' and '{self.b.point}'"
        if gap > first + second:
            return (
                f"{links} together are {mm(gap - first - second)} shorter than {between}; lengthen one of them, "
                "shorten the crank or move the pivots closer together"
            )
        longer, shorter = (self.dyad.first, self.dyad.second) if first > second else (self.dyad.second, self.dyad.first)
        return (
            f"{links} differ by {mm(abs(first - second) - gap)} more than {between}; shorten '{longer}', lengthen "
            f"'{shorter}' or move the pivots apart"
        )

    def dead(self) -> Scalar:
        """A, B and C in one line."""
        return abs(self.determinant) <= LEAST_SINE * self.lengths[0] * self.lengths[1]


class ArmAndSlider:
    """RRP: the first link turns about a placed pin, the second slides along a line of a placed body."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.rail = turning(dyad.first_joint), sliding(dyad.second_joint)
        inner = turning(dyad.inner_joint)
        self.first_arm = difference(inner.far_local, self.a.far_local)
        self.length = length_of(self.first_arm)
        self.inner = inner.near_local
        self.base = on_rail(self.rail, self.inner)

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        """A circle and a line: A + r = base + t e with |r| given."""
        host = poses[self.rail.near]
        a = frames.point(poses[self.a.near], self.a.near_local)
        self.e = frames.arm((0.0, 0.0, host[2], host[3]), self.rail.along)
        base = frames.point(host, self.base)
        self.places = (a, base)
        self.r, self.determinant, self.radicand = frames.circle_and_line(a, base, self.e, self.length, self.dyad.sign)
        self.c = (a[0] + self.r[0], a[1] + self.r[1])
        one = frames.pose_through(a, frame_direction(self.r, self.length, self.first_arm), self.a.far_local)
        two = frames.pose_through(self.c, frames.turned(host, self.rail.turn), self.inner)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        """Closure once differentiated: A' + θ' r⊥ = carried' + t' e, carried' that of the host's point at C."""
        near, host = self.a.near, self.rail.near
        a = frames.point_rate(poses[near], rates[near], self.a.near_local)
        carried = frames.carried_rate(poses[host], rates[host], self.c)
        apart = frames.minus(carried, a)
        self.scale = 1.0 / self.determinant
        self.w = frames.cross(self.e, apart) * self.scale
        self.slide = -frames.dot(apart, self.e) + self.w * frames.cross(self.r, self.e)
        c = frames.ahead(carried, self.slide, self.e)
        return (
            frames.rate_through(self.own[0], a, self.w, self.a.far_local),
            frames.rate_through(self.own[1], c, rates[host][2], self.inner),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        """Closure twice differentiated, with the Coriolis term 2 θ_host' t' e⊥ of sliding on a turning host."""
        near, host = self.a.near, self.rail.near
        a = frames.point_acceleration(poses[near], rates[near], accelerations[near], self.a.near_local)
        carried = frames.carried_acceleration(poses[host], rates[host], accelerations[host], self.c)
        if rates[host] is not frames.STILL:
            coriolis = 2.0 * rates[host][2] * self.slide
            carried = (carried[0] - coriolis * self.e[1], carried[1] + coriolis * self.e[0])
        square = self.w * self.w
        apart = (carried[0] - a[0] + square * self.r[0], carried[1] - a[1] + square * self.r[1])
        turn = frames.cross(self.e, apart) * self.scale
        slide = -frames.dot(apart, self.e) + turn * frames.cross(self.r, self.e)
        c = frames.ahead(carried, slide, self.e)
        return (
            frames.acceleration_through(self.own[0], a, self.w, turn, self.a.far_local),
            frames.acceleration_through(self.own[1], c, rates[host][2], accelerations[host][2], self.inner),
        )

    def meets(self) -> bool:
        """The circle cuts or touches the line."""
        return bool(np.all(self.radicand >= 0.0))

    def missing(self) -> tuple[Scalar, Scalar]:
        """The arm less A's distance from the line, which is |r| where the circle misses it."""
        return self.length - np.hypot(*self.r), size(*self.places) + self.length

    def shortfall(self, at: At) -> str:
        """The arm does not reach the line."""
        distance = at(np.hypot(*self.r))
        return (
            f"'{self.dyad.first}' ({mm(self.length)}) is {mm(distance - self.length)} too short to reach the guide of "
            f"'{self.dyad.second}', {mm(distance)} away from '{self.a.point}'; lengthen it or move the guide closer"
        )

    def dead(self) -> Scalar:
        """The arm square to the line."""
        return abs(self.determinant) <= LEAST_SINE * self.length


class SwingingSlide:
    """RPR: both links turn about placed pins and slide along each other."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.b = turning(dyad.first_joint), turning(dyad.second_joint)
        self.rail = sliding(dyad.inner_joint)
        start = difference(on_rail(self.rail, self.a.far_local), self.b.far_local)
        self.offset = float(frames.cross(self.rail.along, start))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        """A line of the second link at a fixed offset from B passes through A: d = A - B = t e + offset e⊥."""
        a = frames.point(poses[self.a.near], self.a.near_local)
        b = frames.point(poses[self.b.near], self.b.near_local)
        self.pins = (a, b)
        self.d = frames.minus(a, b)
        self.e, self.determinant, self.radicand = frames.line_through(self.d, self.offset, self.dyad.sign)
        two = frames.pose_through(b, frame_direction(self.e, 1.0, self.rail.along), self.b.far_local)
        one = frames.pose_through(a, frames.turned(two, self.rail.turn), self.a.far_local)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        """Closure once differentiated: d' = t' e + θ' d⊥."""
        a = frames.point_rate(poses[self.a.near], rates[self.a.near], self.a.near_local)
        b = frames.point_rate(poses[self.b.near], rates[self.b.near], self.b.near_local)
        apart = frames.minus(a, b)
        self.scale = 1.0 / self.determinant
        self.w = frames.cross(self.e, apart) * self.scale
        self.slide = frames.dot(apart, self.e) + self.w * self.offset
        return (
            frames.rate_through(self.own[0], a, self.w, self.a.far_local),
            frames.rate_through(self.own[1], b, self.w, self.b.far_local),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        """Closure twice differentiated: d'' = t'' e + 2 θ' t' e⊥ + θ'' d⊥ - θ'² d."""
        near_a, near_b = self.a.near, self.b.near
        a = frames.point_acceleration(poses[near_a], rates[near_a], accelerations[near_a], self.a.near_local)
        b = frames.point_acceleration(poses[near_b], rates[near_b], accelerations[near_b], self.b.near_local)
        apart = frames.minus(a, b)
        turn = (frames.cross(self.e, apart) + self.w * (self.w * self.offset - 2.0 * self.slide)) * self.scale
        return (
            frames.acceleration_through(self.own[0], a, self.w, turn, self.a.far_local),
            frames.acceleration_through(self.own[1], b, self.w, turn, self.b.far_local),
        )

    def meets(self) -> bool:
        """A is no nearer to B than the line is; a line through B needs A away from it, to have a direction."""
        return bool(np.all(self.radicand >= 0.0 if self.offset else self.determinant > self._clearance()))

    def missing(self) -> tuple[Scalar, Scalar]:
        """The distance AB less the line's offset from B, or less what A must clear."""
        lengths = size(*self.pins) + abs(self.offset)
        return np.hypot(*self.d) - (abs(self.offset) or 2.0 * self._clearance()), lengths

    def _clearance(self) -> Scalar:
        """Distance AB below which rounding alone decides its direction."""
        return ROUNDING * size(*self.pins)

    def shortfall(self, at: At) -> str:
        """The offset is too large, or A is on B."""
        distance = at(np.hypot(*self.d))
        pins = f"'{self.a.point}' and '{self.b.point}'"
        if self.offset == 0.0:
            return (
                f"{pins} coincide, so the direction of the slide between '{self.dyad.first}' and '{self.dyad.second}' "
                "is undefined; move the pivot off the pin's path"
            )
        return (
            f"the slide between '{self.dyad.first}' and '{self.dyad.second}' is offset by {mm(abs(self.offset))}, "
            f"{mm(abs(self.offset) - distance)} more than the distance between {pins}; lessen the offset or move the "
            "pivot away"
        )

    def dead(self) -> Scalar:
        """A at the foot of the perpendicular from B to the line."""
        return abs(self.determinant) <= LEAST_SINE * (size(*self.pins) + abs(self.offset))
