"""The dyads with one assembly mode, whose closure is linear: RPP and PRP.

e and f are the directions of the two lines; the determinant e × f vanishes where they are parallel. See
``closure.Group`` for the steps they share.
"""

from __future__ import annotations

import numpy as np

from analytic.kinematics import frames
from analytic.kinematics.dyad_solver import LEAST_SINE, At, Poses, Rates, on_rail, sliding, turning
from analytic.kinematics.frames import Pair, Pose, Rate, Scalar
from analytic.kinematics.structure import Dyad


class CrossingLines:
    """What RPP and PRP share: two lines, t e − u f = gap."""

    dyad: Dyad
    determinant: Scalar
    scale: Scalar
    e: Pair
    f: Pair

    def cross_lines(self, e: Pair, f: Pair) -> None:
        """Take the directions of the two lines."""
        self.e, self.f = e, f
        self.determinant = np.asarray(frames.cross(e, f))
        crossing = self.determinant != 0.0
        self.scale = np.divide(1.0, self.determinant, out=np.zeros_like(self.determinant), where=crossing)

    def slides(self, gap: Pair) -> tuple[Scalar, Scalar]:
        """Solve t e − u f = gap for (t, u): travels, or their derivatives."""
        return frames.cross(gap, self.f) * self.scale, frames.cross(gap, self.e) * self.scale

    def meets(self) -> bool:
        """The lines are not parallel."""
        return not np.any(self.dead())

    def missing(self) -> tuple[Scalar, Scalar]:
        """No length is missing, but parallel lines do not cross."""
        return np.where(self.dead(), -1.0, 1.0), 1.0

    def shortfall(self, at: At) -> str:
        """The lines are parallel."""
        return (
            f"the guides of '{self.dyad.first}' and '{self.dyad.second}' are parallel, so nothing holds the two in "
            "place; turn one of the guides"
        )

    def dead(self) -> Scalar:
        """Where the lines are parallel."""
        return abs(self.determinant) <= LEAST_SINE


class PinnedOnSlider(CrossingLines):
    """RPP: the second link slides on a placed body, the first on the second and turns with it about a placed pin."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.a, self.rail = turning(dyad.first_joint), sliding(dyad.second_joint)
        self.inner = sliding(dyad.inner_joint)
        self.start = on_rail(self.rail, on_rail(self.inner, self.a.far_local))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        """The pin A lies on the second link's line: A = start + t e + u f."""
        host = poses[self.rail.near]
        a = frames.point(poses[self.a.near], self.a.near_local)
        turn = frames.turned(host, self.rail.turn)
        f = frames.arm((0.0, 0.0, *turn), self.inner.along)
        self.cross_lines(frames.arm((0.0, 0.0, host[2], host[3]), self.rail.along), (-f[0], -f[1]))
        slide, _ = self.slides(frames.minus(a, frames.point(host, self.start)))
        home = frames.point(host, self.rail.origin)
        self.at = frames.ahead(home, slide, self.e)
        self.pin = a
        two = (*self.at, *turn)
        one = frames.pose_through(a, frames.turned(two, self.inner.turn), self.a.far_local)
        self.own = (one, two)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        """The pin moves as the point of the host under it does, plus the two slides."""
        near, host = self.a.near, self.rail.near
        a = frames.point_rate(poses[near], rates[near], self.a.near_local)
        self.travel = self.slides(frames.minus(a, frames.carried_rate(poses[host], rates[host], self.pin)))
        carried = frames.carried_rate(poses[host], rates[host], self.at)
        slide, w = self.travel[0], rates[host][2]
        two = (*frames.ahead(carried, slide, self.e), w)
        return frames.rate_through(self.own[0], a, w, self.a.far_local), two

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        """The same once more, with the Coriolis term of both slides on the turning host."""
        near, host = self.a.near, self.rail.near
        w, turn = rates[host][2], accelerations[host][2]
        a = frames.point_acceleration(poses[near], rates[near], accelerations[near], self.a.near_local)
        under = frames.carried_acceleration(poses[host], rates[host], accelerations[host], self.pin)
        one, two = self.travel
        along = (one * self.e[0] - two * self.f[0], one * self.e[1] - two * self.f[1])
        gap = (a[0] - under[0] + 2.0 * w * along[1], a[1] - under[1] - 2.0 * w * along[0])
        slide, _ = self.slides(gap)
        home = frames.carried_acceleration(poses[host], rates[host], accelerations[host], self.at)
        second = (
            home[0] + slide * self.e[0] - 2.0 * w * one * self.e[1],
            home[1] + slide * self.e[1] + 2.0 * w * one * self.e[0],
            turn,
        )
        return frames.acceleration_through(self.own[0], a, w, turn, self.a.far_local), second


class TwoSliders(CrossingLines):
    """PRP: each link slides on a placed body; they share the inner pin."""

    def __init__(self, dyad: Dyad) -> None:
        self.dyad = dyad
        self.rails = (sliding(dyad.first_joint), sliding(dyad.second_joint))
        inner = turning(dyad.inner_joint)
        self.locals = (inner.far_local, inner.near_local)
        self.bases = tuple(on_rail(rail, local) for rail, local in zip(self.rails, self.locals, strict=True))

    def poses(self, poses: Poses) -> tuple[Pose, Pose]:
        """The pin C lies where the two lines cross: C = one + t e = two + u f."""
        hosts = [poses[rail.near] for rail in self.rails]
        e, f = (
            frames.arm((0.0, 0.0, host[2], host[3]), rail.along) for host, rail in zip(hosts, self.rails, strict=True)
        )
        self.cross_lines(e, f)
        one, two = (frames.point(host, base) for host, base in zip(hosts, self.bases, strict=True))
        slide, _ = self.slides(frames.minus(two, one))
        self.c = frames.ahead(one, slide, self.e)
        first, second = (
            frames.pose_through(self.c, frames.turned(host, rail.turn), local)
            for host, rail, local in zip(hosts, self.rails, self.locals, strict=True)
        )
        self.own = (first, second)
        return self.own

    def rates(self, poses: Poses, rates: Rates) -> tuple[Rate, Rate]:
        """C moves as the point of each host under it does, plus that host's slide."""
        one, two = (rail.near for rail in self.rails)
        a = frames.carried_rate(poses[one], rates[one], self.c)
        b = frames.carried_rate(poses[two], rates[two], self.c)
        self.travel = self.slides(frames.minus(b, a))
        c = frames.ahead(a, self.travel[0], self.e)
        return (
            frames.rate_through(self.own[0], c, rates[one][2], self.locals[0]),
            frames.rate_through(self.own[1], c, rates[two][2], self.locals[1]),
        )

    def accelerations(self, poses: Poses, rates: Rates, accelerations: Rates) -> tuple[Rate, Rate]:
        """The same once more, with the Coriolis term of each slide on its host."""
        ends = []
        for rail, direction, slide in zip(self.rails, (self.e, self.f), self.travel, strict=True):
            near = rail.near
            carried = frames.carried_acceleration(poses[near], rates[near], accelerations[near], self.c)
            coriolis = 2.0 * rates[near][2] * slide
            ends.append((carried[0] - coriolis * direction[1], carried[1] + coriolis * direction[0]))
        slide, _ = self.slides(frames.minus(ends[1], ends[0]))
        c = frames.ahead(ends[0], slide, self.e)
        one, two = (rail.near for rail in self.rails)
        return (
            frames.acceleration_through(self.own[0], c, rates[one][2], accelerations[one][2], self.locals[0]),
            frames.acceleration_through(self.own[1], c, rates[two][2], accelerations[two][2], self.locals[1]),
        )
