"""The joints of a group as equations between poses, with two derivatives over φ and their Jacobian.

A pin holds two points together, a slide keeps a frame on a line and its angle, a cylinder's length is φ. The unknowns
are x, y and θ of the group's links. All three orders have one Jacobian, Φ_q: with the unknowns of an order set to zero
an equation of that order has the terms already known, so Φ_q q' = −Φ' and Φ_q q'' = −Φ''.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Pose, Rate, Scalar
from analytic.kinematics.structure import DrivenDistance, GroupJoint, Revolute
from analytic.numerics.arrays import Array

Motion = tuple[Pose, Rate, Rate]
Motions = Mapping[str, Motion]


def residuals(joints: Sequence[GroupJoint], motions: Motions, order: int, coordinate: Scalar) -> list[Scalar]:
    """The equations of joints, derived ``order`` times over φ, 0 where they are met: row by row, in the joints' order.

    ``order`` is 0, 1 or 2, ``coordinate`` is φ, rad or m, ``motions`` has pose, rate and acceleration by body. Lengths
    are in m, angles by their sine, or for an order above 0 that derivative of the angle itself, each at n values of φ.
    """
    rows: list[Scalar] = []
    for joint in joints:
        near, far = motions[joint.near], motions[joint.far]
        if isinstance(joint, Revolute):
            rows += frames.minus(
                point_derivative(far, joint.far_local, order), point_derivative(near, joint.near_local, order)
            )
        elif isinstance(joint, DrivenDistance):
            rows.append(_length_equation(joint, near, far, order, coordinate))
        else:
            offsets = [
                frames.minus(point_derivative(far, (0.0, 0.0), k), point_derivative(near, joint.origin, k))
                for k in range(order + 1)
            ]
            lines = _direction_derivatives(near, joint.along, order)
            across = [frames.cross(lines[k], offsets[order - k]) for k in range(order + 1)]
            rows.append(sum(across) if order < 2 else across[0] + 2.0 * across[1] + across[2])
            rows.append(_angle_equation(near, far, joint.turn, order))
    return rows


def point_derivative(motion: Motion, local: Pair, order: int) -> Pair:
    """A point of a body, ``local`` in its frame, m, in the ground frame, or its derivative of order 1 or 2 over φ.

    ``motion`` is the pose, and up to that order the rate and the acceleration.
    """
    if order == 0:
        return frames.point(motion[0], local)
    if order == 1:
        return frames.point_rate(motion[0], motion[1], local)
    return frames.point_acceleration(motion[0], motion[1], motion[2], local)


def _span_derivatives(far: Motion, far_point: Pair, near: Motion, near_point: Pair, order: int) -> list[Pair]:
    """The vector from the near body's point to the far body's, m, and its derivatives over φ up to ``order``.

    The points are in the frames of their bodies, the vectors in the ground's.
    """
    return [
        frames.minus(point_derivative(far, far_point, k), point_derivative(near, near_point, k))
        for k in range(order + 1)
    ]


def _direction_derivatives(near: Motion, along: Pair, order: int) -> list[Pair]:
    """A direction ``along``, fixed in a body, in the ground frame, then its derivatives over φ up to ``order``.

    ``near`` is the body's motion.
    """
    e = frames.arm(near[0], along)
    lines = [e]
    if order:
        w = near[1][2]
        lines.append((-w * e[1], w * e[0]))
    if order > 1:
        a = near[2][2]
        lines.append((-a * e[1] - w * w * e[0], a * e[0] - w * w * e[1]))
    return lines


def _angle_equation(near: Motion, far: Motion, turn: Pair, order: int) -> Scalar:
    """The sine of the far frame's angle less the near one's and ``turn`` (cos, sin).

    Of an order above 0, that derivative over φ of the difference of both angles, not of the sine.
    """
    if order:
        return far[order][2] - near[order][2]
    c, s = frames.turned(near[0], turn)
    return far[0][3] * c - far[0][2] * s


def _length_equation(joint: DrivenDistance, near: Motion, far: Motion, order: int, coordinate: Scalar) -> Scalar:
    """Distance of the cylinder's ends less φ, its length, m, or its derivative of order 1 or 2 over φ.

    ``coordinate`` is φ.
    """
    spans = _span_derivatives(far, joint.far_local, near, joint.near_local, order)
    length = np.sqrt(frames.dot(spans[0], spans[0]))
    if order == 0:
        return length - coordinate
    u = (spans[0][0] / length, spans[0][1] / length)
    if order == 1:
        return frames.dot(u, spans[1]) - 1.0
    return frames.dot(u, spans[2]) + frames.cross(u, spans[1]) ** 2 / length


def jacobian(joints: Sequence[GroupJoint], links: Sequence[str], poses: Mapping[str, Pose], count: int) -> Array:
    """Derivatives of the joints' equations by x, y and θ of the links, (count, equations, 3 · links), at ``count`` φ.

    ``poses`` has those of all bodies on the joints by name.
    """
    sizes = [1 if isinstance(joint, DrivenDistance) else 2 for joint in joints]
    entries = np.zeros((count, sum(sizes), 3 * len(links)))
    columns = {name: 3 * number for number, name in enumerate(links)}
    top = 0
    for joint, size in zip(joints, sizes, strict=True):
        for body, sign in ((joint.near, -1.0), (joint.far, 1.0)):
            if body in columns:
                _enter_jacobian(
                    entries[:, top : top + size, columns[body] : columns[body] + 3], joint, body, sign, poses
                )
        top += size
    return entries


def _enter_jacobian(block: Array, joint: GroupJoint, body: str, sign: float, poses: Mapping[str, Pose]) -> None:
    """Enter a joint's derivatives by x, y and θ of one of its bodies into ``block`` (n, equations, 3), in place.

    ``sign`` is 1 for the far body, else −1; ``poses`` has both bodies' by name.
    """
    if isinstance(joint, Revolute):
        x, y = frames.arm(poses[body], joint.near_local if body == joint.near else joint.far_local)
        block[:, 0, 0] = block[:, 1, 1] = sign
        block[:, 0, 2], block[:, 1, 2] = -sign * y, sign * x
        return
    near, far = poses[joint.near], poses[joint.far]
    if isinstance(joint, DrivenDistance):
        span = frames.minus(frames.point(far, joint.far_local), frames.point(near, joint.near_local))
        length = np.sqrt(frames.dot(span, span))
        u = (span[0] / length, span[1] / length)
        arm = frames.arm(poses[body], joint.near_local if body == joint.near else joint.far_local)
        block[:, 0, 0], block[:, 0, 1], block[:, 0, 2] = sign * u[0], sign * u[1], sign * frames.cross(arm, u)
        return
    x, y = frames.arm(near, joint.along)
    block[:, 0, 0], block[:, 0, 1], block[:, 1, 2] = -sign * y, sign * x, sign
    if body == joint.near:
        block[:, 0, 2] = -(x * (far[0] - near[0]) + y * (far[1] - near[1]))


def poses_of(coordinates: Array) -> list[Pose]:
    """Poses of links from x, y, θ (n, links, 3)."""
    x, y, angle = np.moveaxis(coordinates, -1, 0)
    return [(x[:, k], y[:, k], np.cos(angle[:, k]), np.sin(angle[:, k])) for k in range(coordinates.shape[1])]


def rates_of(coordinates: Array) -> list[Rate]:
    """Rates of links from x', y', θ' (n, links, 3)."""
    return [(row[:, 0], row[:, 1], row[:, 2]) for row in np.moveaxis(coordinates, 1, 0)]


def _scales(joint: GroupJoint, unit: float) -> tuple[float, ...]:
    """Factors for a joint's equations, 1/unit for those of length, 1 for those of angle, so that both weigh alike.

    ``unit`` is a length, m.
    """
    if isinstance(joint, DrivenDistance):
        return (1.0 / unit,)
    return (1.0 / unit, 1.0 / unit) if isinstance(joint, Revolute) else (1.0 / unit, 1.0)


class GroupSystem:
    """The equations of a group beside the motions of the bodies it hangs on, at n values of φ.

    The unknowns have lengths in ``unit``, m, so that lengths and angles weigh alike.
    """

    def __init__(
        self, joints: Sequence[GroupJoint], links: Sequence[str], hosts: Motions, coordinate: Array, unit: float
    ) -> None:
        """Set up the equations of ``joints`` between ``links`` and ``hosts`` at φ (n,); ``unit``, m, scales lengths.

        ``links`` are names, ``hosts`` the motions of the bodies that they hang on by name, each number (n,).
        """
        self.joints, self.links, self.hosts, self.coordinate = joints, links, hosts, coordinate
        self.count = len(coordinate)
        self.columns = np.tile([unit, unit, 1.0], len(links))
        self.rows = np.array([scale for joint in joints for scale in _scales(joint, unit)])

    def motions(self, *orders: Array) -> dict[str, Motion]:
        """Motions of all bodies by name: the hosts', and the links' by coordinates and derivatives, (n, links, 3).

        ``orders`` are x, y and θ, m and rad, and as many of their derivatives over φ as are known; others are 0.
        """
        still = np.zeros((self.count, len(self.links), 3))
        rates = [rates_of(orders[k] if k < len(orders) else still) for k in (1, 2)]
        motion = zip(poses_of(orders[0]), *rates, strict=True)
        return {**self.hosts, **dict(zip(self.links, motion, strict=True))}

    def residual(self, motions: Motions, order: int) -> Array:
        """The equations of an order, 0, 1 or 2, (n, equations), lengths over the system's unit; 0 where met."""
        rows = residuals(self.joints, motions, order, self.coordinate)
        return np.asarray(np.stack([np.broadcast_to(row, (self.count,)) for row in rows], axis=1) * self.rows)

    def matrix(self, motions: Motions) -> Array:
        """The Jacobian in the system's unit, (n, equations, unknowns).

        ``motions`` has those of all bodies by name; their poses alone count.
        """
        poses = {body: motion[0] for body, motion in motions.items()}
        return np.asarray(jacobian(self.joints, self.links, poses, self.count) * self.rows[:, None] * self.columns)

    def step(self, matrix: Array, residual: Array) -> Array:
        """Newton's step of the unknowns, (n, links, 3), m and rad; nan where the matrix is singular.

        ``matrix`` and ``residual`` are in the system's unit.
        """
        solution = _solve_all(matrix, -residual) * self.columns
        return np.asarray(solution.reshape(self.count, -1, 3))

    def derivatives(self, coordinates: Array) -> tuple[Array, Array]:
        """First and second derivatives over φ of the links' coordinates (n, links, 3), each of that shape.

        They are nan where the Jacobian is singular.
        """
        matrix = self.matrix(self.motions(coordinates))
        first = self.step(matrix, self.residual(self.motions(coordinates), 1))
        return first, self.step(matrix, self.residual(self.motions(coordinates, first), 2))


def _solve_all(matrix: Array, right: Array) -> Array:
    """Solutions (n, k) of n linear systems, (n, k, k) and (n, k); nan for those whose matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0])
    except np.linalg.LinAlgError:
        return np.stack([_solve_single(entry, side) for entry, side in zip(matrix, right, strict=True)])


def _solve_single(matrix: Array, right: Array) -> Any:  # noqa: ANN401 - an array of the right side's shape
    """Solution (k,) of one linear system, (k, k) and (k,); nan if its matrix is singular."""
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.full(right.shape, np.nan)
