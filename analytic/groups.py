"""Solving a dyad within a linkage: from the placed bodies' poses, rates and accelerations to those of its two links.

One class per kind, each with the same three steps. What a later step needs from an earlier one is kept on the instance,
so that asking for poses alone costs nothing more.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Protocol

from analytic import dyads
from analytic.dyads import Pair, Pose, Rate, Scalar
from analytic.linkage import Vector
from analytic.structure import Dyad, Joint, Sliding, Turning

Poses = Mapping[str, Pose]
Rates = Mapping[str, Rate]


class Group(Protocol):
    """A dyad being solved; the mappings hold every body placed before it."""

    radicand: Scalar  # negative where the dyad cannot be assembled; None where it always can

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        """Poses of the first and the second link."""
        ...

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        """First derivatives over φ."""
        ...

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        """Second derivatives over φ."""
        ...


def _turning(joint: Joint) -> Turning:
    assert isinstance(joint, Turning)
    return joint


def _sliding(joint: Joint) -> Sliding:
    assert isinstance(joint, Sliding)
    return joint


def _difference(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1])


def _length(a: Vector) -> float:
    return float((a[0] * a[0] + a[1] * a[1]) ** 0.5)


def _direction(vector: Pair, length: float, local: Vector) -> Pair:
    """Cosine and sine of a link's angle from one of its arms in the ground frame and in its own."""
    a, b = local[0] / (length * length), local[1] / (length * length)
    if b == 0.0:
        return (vector[0] * a, vector[1] * a)
    return (vector[0] * a + vector[1] * b, vector[1] * a - vector[0] * b)


class TwoTurningArms:
    """RRR: both links turn about placed pins and share the inner pin."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.b = _turning(dyad.first_joint), _turning(dyad.second_joint)
        inner = _turning(dyad.inner_joint)
        self.first_arm = _difference(inner.far_local, self.a.far_local)
        self.second_arm = _difference(inner.near_local, self.b.far_local)
        self.lengths = (_length(self.first_arm), _length(self.second_arm))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        a = dyads.point(poses[self.a.near], self.a.near_local)
        b = dyads.point(poses[self.b.near], self.b.near_local)
        self.r, self.radicand = dyads.two_circles(a, b, *self.lengths, self.dyad.sign)
        self.q = (self.r[0] + a[0] - b[0], self.r[1] + a[1] - b[1])
        one = dyads.pose_through(a, _direction(self.r, self.lengths[0], self.first_arm), self.a.far_local)
        two = dyads.pose_through(b, _direction(self.q, self.lengths[1], self.second_arm), self.b.far_local)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        a = dyads.point_rate(poses[self.a.near], rates[self.a.near], self.a.near_local)
        b = dyads.point_rate(poses[self.b.near], rates[self.b.near], self.b.near_local)
        self.scale = 1.0 / dyads.cross(self.r, self.q)
        apart = dyads.minus(b, a)
        self.w = (dyads.dot(apart, self.q) * self.scale, dyads.dot(apart, self.r) * self.scale)
        return (
            dyads.rate_through(self.own[0], a, self.w[0], self.a.far_local),
            dyads.rate_through(self.own[1], b, self.w[1], self.b.far_local),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        near_a, near_b = self.a.near, self.b.near
        a = dyads.point_acceleration(poses[near_a], rates[near_a], accelerations[near_a], self.a.near_local)
        b = dyads.point_acceleration(poses[near_b], rates[near_b], accelerations[near_b], self.b.near_local)
        one, two = self.w[0] * self.w[0], self.w[1] * self.w[1]
        g = (b[0] - a[0] + one * self.r[0] - two * self.q[0], b[1] - a[1] + one * self.r[1] - two * self.q[1])
        first, second = dyads.dot(g, self.q) * self.scale, dyads.dot(g, self.r) * self.scale
        return (
            dyads.acceleration_through(self.own[0], a, self.w[0], first, self.a.far_local),
            dyads.acceleration_through(self.own[1], b, self.w[1], second, self.b.far_local),
        )


class ArmAndSlider:
    """RRP: the first link turns about a placed pin, the second slides along a line of a placed body."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.rail = _turning(dyad.first_joint), _sliding(dyad.second_joint)
        inner = _turning(dyad.inner_joint)
        self.first_arm = _difference(inner.far_local, self.a.far_local)
        self.length = _length(self.first_arm)
        self.inner = inner.near_local
        self.base = _on_rail(self.rail, self.inner)

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        host = poses[self.rail.near]
        a = dyads.point(poses[self.a.near], self.a.near_local)
        self.e = dyads.arm((0.0, 0.0, host[2], host[3]), self.rail.along)
        self.r, self.radicand = dyads.circle_and_line(
            a, dyads.point(host, self.base), self.e, self.length, self.dyad.sign
        )
        self.c = (a[0] + self.r[0], a[1] + self.r[1])
        one = dyads.pose_through(a, _direction(self.r, self.length, self.first_arm), self.a.far_local)
        two = dyads.pose_through(self.c, dyads.turned(host, self.rail.turn), self.inner)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        near, host = self.a.near, self.rail.near
        a = dyads.point_rate(poses[near], rates[near], self.a.near_local)
        carried = dyads.carried_rate(poses[host], rates[host], self.c)
        apart = dyads.minus(carried, a)
        self.scale = 1.0 / dyads.dot(self.r, self.e)
        self.w = dyads.cross(self.e, apart) * self.scale
        self.slide = -dyads.dot(apart, self.e) + self.w * dyads.cross(self.r, self.e)
        c = (carried[0] + self.slide * self.e[0], carried[1] + self.slide * self.e[1])
        return (
            dyads.rate_through(self.own[0], a, self.w, self.a.far_local),
            dyads.rate_through(self.own[1], c, rates[host][2], self.inner),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        near, host = self.a.near, self.rail.near
        a = dyads.point_acceleration(poses[near], rates[near], accelerations[near], self.a.near_local)
        carried = dyads.carried_acceleration(poses[host], rates[host], accelerations[host], self.c)
        coriolis = 2.0 * rates[host][2] * self.slide
        square = self.w * self.w
        apart = (
            carried[0] - a[0] + square * self.r[0] - coriolis * self.e[1],
            carried[1] - a[1] + square * self.r[1] + coriolis * self.e[0],
        )
        turn = dyads.cross(self.e, apart) * self.scale
        slide = -dyads.dot(apart, self.e) + turn * dyads.cross(self.r, self.e)
        c = (
            carried[0] - coriolis * self.e[1] + slide * self.e[0],
            carried[1] + coriolis * self.e[0] + slide * self.e[1],
        )
        return (
            dyads.acceleration_through(self.own[0], a, self.w, turn, self.a.far_local),
            dyads.acceleration_through(self.own[1], c, rates[host][2], accelerations[host][2], self.inner),
        )


class SwingingSlide:
    """RPR: both links turn about placed pins and slide along each other."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.b = _turning(dyad.first_joint), _turning(dyad.second_joint)
        self.rail = _sliding(dyad.inner_joint)
        start = _difference(_on_rail(self.rail, self.a.far_local), self.b.far_local)
        self.offset = float(dyads.cross(self.rail.along, start))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        a = dyads.point(poses[self.a.near], self.a.near_local)
        b = dyads.point(poses[self.b.near], self.b.near_local)
        self.d = dyads.minus(a, b)
        self.e, self.along, self.radicand = dyads.line_through(self.d, self.offset, self.dyad.sign)
        two = dyads.pose_through(b, _direction(self.e, 1.0, self.rail.along), self.b.far_local)
        one = dyads.pose_through(a, dyads.turned(two, self.rail.turn), self.a.far_local)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        a = dyads.point_rate(poses[self.a.near], rates[self.a.near], self.a.near_local)
        b = dyads.point_rate(poses[self.b.near], rates[self.b.near], self.b.near_local)
        apart = dyads.minus(a, b)
        self.scale = 1.0 / self.along
        self.w = dyads.cross(self.e, apart) * self.scale
        self.slide = dyads.dot(apart, self.e) + self.w * self.offset
        return (
            dyads.rate_through(self.own[0], a, self.w, self.a.far_local),
            dyads.rate_through(self.own[1], b, self.w, self.b.far_local),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        near_a, near_b = self.a.near, self.b.near
        a = dyads.point_acceleration(poses[near_a], rates[near_a], accelerations[near_a], self.a.near_local)
        b = dyads.point_acceleration(poses[near_b], rates[near_b], accelerations[near_b], self.b.near_local)
        apart = dyads.minus(a, b)
        turn = (dyads.cross(self.e, apart) + self.w * (self.w * self.offset - 2.0 * self.slide)) * self.scale
        return (
            dyads.acceleration_through(self.own[0], a, self.w, turn, self.a.far_local),
            dyads.acceleration_through(self.own[1], b, self.w, turn, self.b.far_local),
        )


class PinnedOnSlider:
    """RPP: the second link slides on a placed body, the first on the second and turns with it about a placed pin."""

    radicand: ClassVar[Any] = None

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.rail = _turning(dyad.first_joint), _sliding(dyad.second_joint)
        self.inner = _sliding(dyad.inner_joint)
        self.start = _on_rail(self.rail, _on_rail(self.inner, self.a.far_local))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        host = poses[self.rail.near]
        a = dyads.point(poses[self.a.near], self.a.near_local)
        turn = dyads.turned(host, self.rail.turn)
        self.e = dyads.arm((0.0, 0.0, host[2], host[3]), self.rail.along)
        self.f = dyads.arm((0.0, 0.0, *turn), self.inner.along)
        gap = dyads.minus(a, dyads.point(host, self.start))
        slide, _ = dyads.two_lines(gap, self.e, (-self.f[0], -self.f[1]))
        home = dyads.point(host, self.rail.origin)
        self.at = (home[0] + slide * self.e[0], home[1] + slide * self.e[1])
        self.pin = a
        two = (*self.at, *turn)
        one = dyads.pose_through(a, dyads.turned(two, self.inner.turn), self.a.far_local)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        near, host = self.a.near, self.rail.near
        a = dyads.point_rate(poses[near], rates[near], self.a.near_local)
        # The pin moves as the point of the host under it does, plus the two slides.
        gap = dyads.minus(a, dyads.carried_rate(poses[host], rates[host], self.pin))
        self.slides = dyads.two_lines(gap, self.e, (-self.f[0], -self.f[1]))
        carried = dyads.carried_rate(poses[host], rates[host], self.at)
        slide, w = self.slides[0], rates[host][2]
        two = (carried[0] + slide * self.e[0], carried[1] + slide * self.e[1], w)
        return dyads.rate_through(self.own[0], a, w, self.a.far_local), two

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        near, host = self.a.near, self.rail.near
        w, turn = rates[host][2], accelerations[host][2]
        a = dyads.point_acceleration(poses[near], rates[near], accelerations[near], self.a.near_local)
        under = dyads.carried_acceleration(poses[host], rates[host], accelerations[host], self.pin)
        one, two = self.slides
        along = (one * self.e[0] + two * self.f[0], one * self.e[1] + two * self.f[1])
        gap = (a[0] - under[0] + 2.0 * w * along[1], a[1] - under[1] - 2.0 * w * along[0])
        slide, _ = dyads.two_lines(gap, self.e, (-self.f[0], -self.f[1]))
        home = dyads.carried_acceleration(poses[host], rates[host], accelerations[host], self.at)
        second = (
            home[0] + slide * self.e[0] - 2.0 * w * one * self.e[1],
            home[1] + slide * self.e[1] + 2.0 * w * one * self.e[0],
            turn,
        )
        return dyads.acceleration_through(self.own[0], a, w, turn, self.a.far_local), second


class TwoSliders:
    """PRP: each link slides on a placed body; they share the inner pin."""

    radicand: ClassVar[Any] = None

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.rails = (_sliding(dyad.first_joint), _sliding(dyad.second_joint))
        inner = _turning(dyad.inner_joint)
        self.locals = (inner.far_local, inner.near_local)
        self.bases = tuple(_on_rail(rail, local) for rail, local in zip(self.rails, self.locals, strict=True))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        hosts = [poses[rail.near] for rail in self.rails]
        self.e, self.f = (
            dyads.arm((0.0, 0.0, host[2], host[3]), rail.along) for host, rail in zip(hosts, self.rails, strict=True)
        )
        one, two = (dyads.point(host, base) for host, base in zip(hosts, self.bases, strict=True))
        slide, _ = dyads.two_lines(dyads.minus(two, one), self.e, self.f)
        self.c = (one[0] + slide * self.e[0], one[1] + slide * self.e[1])
        first, second = (
            dyads.pose_through(self.c, dyads.turned(host, rail.turn), local)
            for host, rail, local in zip(hosts, self.rails, self.locals, strict=True)
        )
        self.own = (first, second)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        one, two = (rail.near for rail in self.rails)
        a = dyads.carried_rate(poses[one], rates[one], self.c)
        b = dyads.carried_rate(poses[two], rates[two], self.c)
        self.slides = dyads.two_lines(dyads.minus(b, a), self.e, self.f)
        c = (a[0] + self.slides[0] * self.e[0], a[1] + self.slides[0] * self.e[1])
        return (
            dyads.rate_through(self.own[0], c, rates[one][2], self.locals[0]),
            dyads.rate_through(self.own[1], c, rates[two][2], self.locals[1]),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        ends = []
        for rail, direction, slide in zip(self.rails, (self.e, self.f), self.slides, strict=True):
            near = rail.near
            carried = dyads.carried_acceleration(poses[near], rates[near], accelerations[near], self.c)
            coriolis = 2.0 * rates[near][2] * slide
            ends.append((carried[0] - coriolis * direction[1], carried[1] + coriolis * direction[0]))
        slide, _ = dyads.two_lines(dyads.minus(ends[1], ends[0]), self.e, self.f)
        c = (ends[0][0] + slide * self.e[0], ends[0][1] + slide * self.e[1])
        one, two = (rail.near for rail in self.rails)
        return (
            dyads.acceleration_through(self.own[0], c, rates[one][2], accelerations[one][2], self.locals[0]),
            dyads.acceleration_through(self.own[1], c, rates[two][2], accelerations[two][2], self.locals[1]),
        )


def _on_rail(rail: Sliding, local: Vector) -> Vector:
    """A point of the sliding body, in the frame it slides on, at zero travel."""
    c, s = rail.turn
    x, y = rail.origin
    return (x + c * local[0] - s * local[1], y + s * local[0] + c * local[1])


SOLVERS: Mapping[str, Any] = {
    "RRR": TwoTurningArms,
    "RRP": ArmAndSlider,
    "RPR": SwingingSlide,
    "RPP": PinnedOnSlider,
    "PRP": TwoSliders,
}


def group(dyad: Dyad) -> Group:
    """The solver of a dyad."""
    solver: Group = SOLVERS[dyad.kind](dyad)
    return solver
