"""How far the closed form can be from the exact solution of the linkage it is given: a bound by perturbation theory.

The computed poses, rates and accelerations of a dyad fulfil its joint equations (and these once and twice
differentiated) up to a few roundings of the terms in them, and up to what the placed bodies and the lower orders err
by. All three systems have the Jacobian J of the joint equations, so |J⁻¹| times these residuals bounds the error, body
after body along the chain. |J⁻¹| grows as the reciprocal of the transmission angle's sine: near a dead position the
bound shows it, and it is infinite where the linearisation itself breaks down.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Vector
from analytic.kinematics.groups.equations import jacobian
from analytic.kinematics.structure import AnyGroup, DrivenDistance, Group, Prismatic, Revolute
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]
ORDERS: Final = 3
# Of each joint the equations for distances, whose curvature counts.
DISTANCES: Final = {Revolute: [1.0, 1.0], Prismatic: [1.0, 0.0], DrivenDistance: [1.0]}

# The residual of one joint equation over the sum of its terms: two roundings of half an eps each. Over random linkages
# the true error stays below a third of the bound that follows.
ROUNDINGS: Final = float(np.finfo(float).eps)


@dataclass(frozen=True)
class BodyMotion:
    """Magnitudes of a body's motion, all (n,): origin (m), turn (rad), each with its two derivatives over φ."""

    pose: tuple[Array, Array, Array, Array]
    origin: tuple[Array, Array, Array]
    turn: tuple[Array, Array]


@dataclass(frozen=True)
class BodyError:
    """Bounds on the error of a body's origin, m, and angle, rad, and of their two derivatives over φ; each (3, n)."""

    origin: Array
    turn: Array


class ErrorBounds:
    """Bounds for every body of a sweep at each of its crank angles."""

    def __init__(self, sweep: Sweep) -> None:
        angle = np.array(sweep.angle)
        for dyad in sweep.structure.dyads:
            if dyad.changes:
                dyad.changes.moved_out(angle)
        self.sweep = sweep = Sweep(sweep.linkage, sweep.structure, angle)
        self.shape = np.shape(np.atleast_1d(sweep.angle).ravel())
        still = np.zeros((ORDERS, *self.shape))
        self.errors: dict[str, BodyError] = {GROUND: BodyError(still, still)}
        self.motions: dict[str, BodyMotion] = {}
        self._place_crank()
        with np.errstate(invalid="ignore"):  # 0·∞ behind a dyad whose bound is infinite
            for group in sweep.structure.groups:
                self._place(group)

    def point(self, body: str, local: Vector, order: int = 0) -> Array:
        """Bound on the error of a point of a body, m, or of its derivative of order 1 or 2; one per crank angle."""
        reach = float(np.hypot(*local))
        with np.errstate(invalid="ignore"):
            bound = self._inherited(body, reach, order, top=True) + ROUNDINGS * self._terms(body, reach, order)
        return np.where(np.isnan(bound), np.inf, bound)

    def motion(self, body: str) -> BodyMotion:
        """Magnitudes of a body's motion."""
        if body not in self.motions:
            x, y, c, s = (self._full(part) for part in self.sweep.poses(body))
            first = [self._full(part) for part in self.sweep.rates(body)]
            second = [self._full(part) for part in self.sweep.accelerations(body)]
            self.motions[body] = BodyMotion(
                (x, y, c, s),
                (np.hypot(x, y), np.hypot(first[0], first[1]), np.hypot(second[0], second[1])),
                (np.abs(first[2]), np.abs(second[2])),
            )
        return self.motions[body]

    def _full(self, value: object) -> Array:
        whole = np.broadcast_to(np.asarray(value, dtype=float), self.sweep.angle.shape)
        return np.atleast_1d(whole).ravel()

    def _place_crank(self) -> None:
        pivot = self.sweep.structure.pivot
        if pivot is None:
            return
        if isinstance(pivot, Prismatic):
            travel = np.hypot(*pivot.origin) + np.abs(self._full(self.sweep.angle))
            origin = ROUNDINGS * np.stack([travel, np.ones(self.shape), np.zeros(self.shape)])
            turn = np.array([ROUNDINGS, 0.0, 0.0])[:, None] * np.ones(self.shape)
            self.errors[self.sweep.linkage.crank] = BodyError(origin, turn)
            return
        reach, out = float(np.hypot(*pivot.far_local)), float(np.hypot(*pivot.near_local))
        origin = np.array([reach + out, reach, reach])[:, None] * np.full(self.shape, ROUNDINGS)
        turn = np.array([1.0, 0.0, 0.0])[:, None] * np.full(self.shape, ROUNDINGS)
        self.errors[self.sweep.linkage.crank] = BodyError(origin, turn)

    def _place(self, group: AnyGroup) -> None:
        """Bounds for the group's links, order by order."""
        poses = {body: self.motion(body).pose for joint in group.joints for body in (joint.near, joint.far)}
        matrix = jacobian(group.joints, group.links, poses, self.shape[0])
        inverse = np.abs(np.linalg.inv(matrix))
        found = np.zeros((ORDERS, *self.shape, 3 * len(group.links)))
        for order in range(ORDERS):
            residual = self._residuals(group, order)
            if order and isinstance(group, Group):
                residual = residual + self._elimination(group, matrix, order)
            found[order] = np.einsum("nij,nj->ni", inverse, residual)
            if order == 0:
                distances = np.concatenate([DISTANCES[type(joint)] for joint in group.joints])
                found[0] = _curved(inverse, found[0], self._reach(group), distances)
            found[order][np.isnan(found[order])] = np.inf
            for number, name in enumerate(group.links):
                x, y, turn = (found[..., 3 * number + part] for part in range(3))
                self.errors[name] = BodyError(np.hypot(x, y), turn)

    def _elimination(self, group: Group, matrix: Array, order: int) -> Array:
        """What elimination with pivots leaves of the equations of an order, (n, equations): eps of the largest row.

        (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 9.3.)
        """
        unit = self.sweep.linkage.extent()
        lengths = np.concatenate([DISTANCES[type(joint)] for joint in group.joints]) > 0.0
        motions = [self._full(part) for body in group.links for part in self._derivative(body, order)]
        rows = np.einsum("nij,nj->ni", np.abs(matrix), np.abs(np.stack(motions, axis=-1)))
        scales = np.where(lengths, unit, 1.0)
        return np.asarray(ROUNDINGS * np.max(rows / scales, axis=1)[:, None] * scales)

    def _derivative(self, body: str, order: int) -> tuple[object, ...]:
        return self.sweep.rates(body) if order == 1 else self.sweep.accelerations(body)

    def _reach(self, group: AnyGroup) -> Array:
        """Largest distance in the group by which an angle's error is carried, m."""
        reaches = [np.zeros(self.shape)]
        for joint in group.joints:
            if isinstance(joint, Prismatic):
                reaches.append(self._apart(joint.near, joint.far))
            else:
                reaches.append(np.full(self.shape, max(np.hypot(*joint.near_local), np.hypot(*joint.far_local))))
        return np.asarray(np.max(reaches, axis=0))

    def _apart(self, near: str, far: str) -> Array:
        (x, y, *_), (u, v, *_) = self.motion(near).pose, self.motion(far).pose
        return np.hypot(u - x, v - y)

    def _residuals(self, group: AnyGroup, order: int) -> Array:
        """What each of the joint equations of an order may be out by; (n, equations)."""
        rows: list[Array] = []
        for joint in group.joints:
            if isinstance(joint, Prismatic):
                rows += self._sliding_residuals(group, joint.near, joint.far, float(np.hypot(*joint.origin)), order)
                continue
            total = np.zeros(self.shape)
            for body, local in ((joint.near, joint.near_local), (joint.far, joint.far_local)):
                reach, known = float(np.hypot(*local)), body not in group.links
                total = total + ROUNDINGS * self._terms(body, reach, order)
                total = total + self._inherited(body, reach, order, top=known)
            rows += [total, total] if isinstance(joint, Revolute) else [total + self._stretching_residual(joint, order)]
        return np.stack(rows, axis=-1)

    def _stretching_residual(self, joint: DrivenDistance, order: int) -> Array:
        """What the errors of a cylinder's direction add to the equation of its length."""
        if order == 0:
            return ROUNDINGS * np.abs(self._full(self.sweep.angle))
        ends = ((joint.near, joint.near_local), (joint.far, joint.far_local))
        moved = [
            np.hypot(*(self._full(b) - self._full(a) for a, b in zip(*pair, strict=True)))
            for pair in (tuple(self.sweep.local_point(body, at, k) for body, at in ends) for k in range(order + 1))
        ]
        lost = [sum(self.point(body, at, k) for body, at in ends) for k in range(order)]
        if order == 1:
            return np.asarray(moved[1] * lost[0] / moved[0])
        return np.asarray(
            (moved[2] * lost[0] + 2.0 * moved[1] * lost[1]) / moved[0] + 3.0 * (moved[1] / moved[0]) ** 2 * lost[0]
        )

    def _terms(self, body: str, reach: float, order: int) -> Array:
        """Magnitude of the terms that make up a point's position or derivative."""
        motion = self.motion(body)
        w, a = motion.turn
        return motion.origin[order] + (1.0, w, a + w * w)[order] * reach

    def _inherited(self, body: str, reach: float, order: int, *, top: bool) -> Array:
        """Error of a point's derivative that the body's errors bring; those of this very order only if ``top``."""
        w, a = self.motion(body).turn
        error = self.errors.get(body)
        total = np.zeros(self.shape)
        if error is None:
            return total
        if top:
            total = total + error.origin[order] + reach * error.turn[order]
        if order == 1:
            total = total + reach * w * error.turn[0]
        if order == 2:
            total = total + reach * (2.0 * w * error.turn[1] + (a + w * w) * error.turn[0])
        return total

    def _sliding_residuals(self, group: AnyGroup, near: str, far: str, start: float, order: int) -> list[Array]:
        """The same for a P joint: across its line, and of the angle between the two bodies."""
        host, rider = self.motion(near), self.motion(far)
        w, a = host.turn
        apart = self._apart(near, far)
        slide = self._travel(near, far)
        side = ROUNDINGS * (np.ones(self.shape), w, a)[order]
        extra = (start + 0.0 * w, w * apart, (a + w * w) * apart + 2.0 * w * slide[0])[order]
        across = ROUNDINGS * (host.origin[order] + rider.origin[order] + extra)
        for body in (near, far):
            if body not in group.links:
                across = across + self.errors[body].origin[order]
                side = side + self.errors[body].turn[order]
        if near not in group.links:
            across = across + apart * self.errors[near].turn[order]
        if order:
            across = across + self._sliding_inherited(near, far, order, slide)
        return [across, side]

    def _sliding_inherited(self, near: str, far: str, order: int, slide: tuple[Array, Array]) -> Array:
        """What the lower orders' errors of both bodies bring into the equation across the line."""
        one, two = self.errors[near], self.errors[far]
        w, a = self.motion(near).turn
        shift = one.origin + two.origin
        if order == 1:
            return np.asarray(slide[0] * one.turn[0] + w * shift[0])
        apart = self._apart(near, far)
        relative = shift[1] + w * shift[0] + apart * one.turn[1]
        turning = 2.0 * (w * apart + slide[0]) * one.turn[1] + slide[1] * one.turn[0]
        return np.asarray(turning + (a + w * w) * shift[0] + 2.0 * w * relative)

    def _travel(self, near: str, far: str) -> tuple[Array, Array]:
        """Magnitudes of the first and second derivative of the travel along a P joint's line, m."""
        (x, y, *_), (u, v, *_) = self.motion(near).pose, self.motion(far).pose
        dx, dy = u - x, v - y
        (p, q, w), (r, s, _) = (map(self._full, self.sweep.rates(name)) for name in (near, far))
        first = (r - p + w * dy, s - q - w * dx)
        (p, q, a), (r, s, _) = (map(self._full, self.sweep.accelerations(name)) for name in (near, far))
        second = (
            r - p + a * dy + w * w * dx + 2.0 * w * first[1],
            s - q - a * dx + w * w * dy - 2.0 * w * first[0],
        )
        return np.hypot(*first), np.hypot(*second)


def _curved(inverse: Array, linear: Array, reach: Array, distances: Array) -> Array:
    """The bound on the poses with the curvature of the equations for distances added; infinite where that is not small.

    ``linear`` (n, k) is the bound without it, ``distances`` (k,) marks those equations among all.
    """
    turns = np.arange(linear.shape[1]) % 3 == 2  # columns are x, y, θ of each link
    turn = np.max(linear[:, turns], axis=1)
    bend = (reach * turn + np.max(linear[:, ~turns], axis=1)) * turn
    more = np.einsum("nij,nj->ni", inverse, bend[:, None] * distances)
    shift = np.maximum(np.max(linear[:, ~turns], axis=1), reach * turn)  # a link that turns about its origin only
    small = [np.max(more[:, ~turns], axis=1) <= 0.5 * shift, np.max(more[:, turns], axis=1) <= 0.5 * turn]
    return np.where(np.all(small, axis=0)[:, None], linear + more, np.inf)


def relative_bounds(sweep: Sweep) -> tuple[float, float, float]:
    """Bounds for positions, first and second derivatives, each relative to its peak.

    The worst over all named points and mass centres of all links and over the sweep's crank angles, divided by the
    largest magnitude of the same.
    """
    bounds, linkage = ErrorBounds(sweep), sweep.linkage
    places = [(name, local) for name, link in linkage.links.items() for local in (*link.points.values(), link.centre)]
    found = []
    for order in range(ORDERS):
        error = max(float(np.max(bounds.point(name, local, order))) for name, local in places)
        peak = max(float(np.max(np.hypot(*sweep.local_point(name, local, order)))) for name, local in places)
        found.append(error / peak)
    return found[0], found[1], found[2]
