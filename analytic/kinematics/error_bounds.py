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
from analytic.kinematics.frames import arm
from analytic.kinematics.structure import Dyad, Prismatic, Revolute
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]
ORDERS: Final = 3
SHIFTS: Final = [0, 1, 3, 4]  # columns of (x, y, θ) of a dyad's two links
TURNS: Final = [2, 5]

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
        self.sweep = sweep
        self.shape = np.shape(np.atleast_1d(sweep.angle).ravel())
        still = np.zeros((ORDERS, *self.shape))
        self.errors: dict[str, BodyError] = {GROUND: BodyError(still, still)}
        self.motions: dict[str, BodyMotion] = {}
        self._place_crank()
        with np.errstate(invalid="ignore"):  # 0·∞ behind a dyad whose bound is infinite
            for dyad in sweep.structure.dyads:
                self._place(dyad)

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

    def _place(self, dyad: Dyad) -> None:
        """Bounds for the dyad's two links, order by order."""
        inverse = np.abs(np.linalg.inv(self._jacobian(dyad)))
        found = np.zeros((ORDERS, *self.shape, 6))
        for order in range(ORDERS):
            residual = self._residuals(dyad, order)
            found[order] = np.einsum("nij,nj->ni", inverse, residual)
            if order == 0:
                distances = np.ravel([(1.0, 1.0 if isinstance(joint, Revolute) else 0.0) for joint in dyad.joints])
                found[0] = _curved(inverse, found[0], self._reach(dyad), distances)
            found[order][np.isnan(found[order])] = np.inf
            for name, at in zip(dyad.links, (0, 3), strict=True):
                origin = np.hypot(found[..., at], found[..., at + 1])
                self.errors[name] = BodyError(origin, found[..., at + 2])

    def _reach(self, dyad: Dyad) -> Array:
        """Largest distance in the dyad by which an angle's error is carried, m."""
        reaches = [np.zeros(self.shape)]
        for joint in dyad.joints:
            if isinstance(joint, Revolute):
                reaches.append(np.full(self.shape, max(np.hypot(*joint.near_local), np.hypot(*joint.far_local))))
            else:
                reaches.append(self._apart(joint.near, joint.far))
        return np.asarray(np.max(reaches, axis=0))

    def _apart(self, near: str, far: str) -> Array:
        (x, y, *_), (u, v, *_) = self.motion(near).pose, self.motion(far).pose
        return np.hypot(u - x, v - y)

    def _jacobian(self, dyad: Dyad) -> Array:
        """Derivatives of the six joint equations by (x, y, θ) of the first and of the second link; (n, 6, 6)."""
        jacobian = np.zeros((*self.shape, 6, 6))
        columns = {dyad.first: 0, dyad.second: 3}
        for number, joint in enumerate(dyad.joints):
            top, side = 2 * number, 2 * number + 1
            for body, sign in ((joint.near, -1.0), (joint.far, 1.0)):
                if body not in columns:
                    continue
                at = columns[body]
                if isinstance(joint, Revolute):
                    x, y = arm(self.motion(body).pose, joint.near_local if body == joint.near else joint.far_local)
                    jacobian[:, top, at] = jacobian[:, side, at + 1] = sign
                    jacobian[:, top, at + 2], jacobian[:, side, at + 2] = -sign * y, sign * x
                else:
                    near, far = self.motion(joint.near).pose, self.motion(joint.far).pose
                    x, y = arm(near, joint.along)
                    jacobian[:, top, at], jacobian[:, top, at + 1] = -sign * y, sign * x
                    jacobian[:, side, at + 2] = sign
                    if body == joint.near:
                        jacobian[:, top, at + 2] = -(x * (far[0] - near[0]) + y * (far[1] - near[1]))
        return jacobian

    def _residuals(self, dyad: Dyad, order: int) -> Array:
        """What each of the six joint equations of an order may be out by; (n, 6)."""
        rows: list[Array] = []
        for joint in dyad.joints:
            if isinstance(joint, Revolute):
                total = np.zeros(self.shape)
                for body, local in ((joint.near, joint.near_local), (joint.far, joint.far_local)):
                    reach, known = float(np.hypot(*local)), body not in dyad.links
                    total = total + ROUNDINGS * self._terms(body, reach, order)
                    total = total + self._inherited(body, reach, order, top=known)
                rows += [total, total]
            else:
                rows += self._sliding_residuals(dyad, joint.near, joint.far, float(np.hypot(*joint.origin)), order)
        return np.stack(rows, axis=-1)

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

    def _sliding_residuals(self, dyad: Dyad, near: str, far: str, start: float, order: int) -> list[Array]:
        """The same for a P joint: across its line, and of the angle between the two bodies."""
        host, rider = self.motion(near), self.motion(far)
        w, a = host.turn
        apart = self._apart(near, far)
        slide = self._travel(near, far)
        side = ROUNDINGS * (np.ones(self.shape), w, a)[order]
        extra = (start + 0.0 * w, w * apart, (a + w * w) * apart + 2.0 * w * slide[0])[order]
        across = ROUNDINGS * (host.origin[order] + rider.origin[order] + extra)
        for body in (near, far):
            if body not in dyad.links:
                across = across + self.errors[body].origin[order]
                side = side + self.errors[body].turn[order]
        if near not in dyad.links:
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

    ``linear`` (n, 6) is the bound without it, ``distances`` (6,) marks those equations among the six.
    """
    turn = np.max(linear[:, TURNS], axis=1)
    bend = (reach * turn + np.max(linear[:, SHIFTS], axis=1)) * turn
    more = np.einsum("nij,nj->ni", inverse, bend[:, None] * distances)
    small = [np.max(more[:, part], axis=1) <= 0.5 * np.max(linear[:, part], axis=1) for part in (SHIFTS, TURNS)]
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
