"""Poses of all bodies of a scene at many instants, and the points fixed in them.

Arrays are (instants, bodies, 3) in x, y, angle; the last body is the ground, which rests at the origin. Nothing depends
on the floating type.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.scene import Scene

Reals = NDArray[np.floating[Any]]
Numbers = NDArray[np.intp]


@dataclass(frozen=True)
class Pose:
    """All bodies at n instants: ``place`` (n, bodies, 2); ``angle``, ``cosine``, ``sine`` (n, bodies).

    Cosine and sine are carried beside the angle, as an angle of many turns is too coarse for them.
    """

    place: Reals
    angle: Reals
    cosine: Reals
    sine: Reals

    def moved(self, step: Reals) -> Pose:
        """The pose after a small step, (n, bodies, 3), of x, y and angle, as a new one."""
        turn = step[..., 2]
        c, s = np.cos(turn), np.sin(turn)
        return Pose(
            self.place + step[..., :2],
            self.angle + turn,
            self.cosine * c - self.sine * s,
            self.sine * c + self.cosine * s,
        )

    def scaled(self, factor: float) -> Pose:
        """A copy of the pose with its lengths times a factor, for another unit."""
        return Pose(self.place * factor, self.angle, self.cosine, self.sine)

    def coordinates(self) -> Reals:
        """x, y and angle of every body, (n, bodies, 3)."""
        return np.concatenate([self.place, self.angle[..., None]], axis=-1)

    def turned(self, vectors: Reals, bodies: Numbers) -> Reals:
        """Vectors (j, 2) of the frames of ``bodies`` (j,), in the ground frame: (n, j, 2)."""
        c, s = self.cosine[:, bodies], self.sine[:, bodies]
        x, y = vectors[:, 0], vectors[:, 1]
        result = np.empty((*c.shape, 2), dtype=c.dtype)
        result[..., 0] = c * x - s * y
        result[..., 1] = s * x + c * y
        return result

    def arm(self, body: int, anchor: Vector) -> Reals:
        """The vector, ground frame, (n, 2), from a body's mass centre to a point, ``anchor``, of its frame.

        ``body`` is its number; lengths are in the anchor's unit.
        """
        return self.turned(np.array([anchor]), np.array([body]))[:, 0]

    def point(self, body: int, anchor: Vector) -> Reals:
        """The position, ground frame, (n, 2), of a point, ``anchor``, of the frame of a body, by its number.

        The anchor is in the pose's unit of length.
        """
        return self.place[:, body] + self.arm(body, anchor)


def pose_of(coordinates: Reals) -> Pose:
    """The pose of coordinates x, y, angle, (n, bodies, 3), the ground among the bodies; it holds views of them."""
    angle = coordinates[..., 2]
    return Pose(coordinates[..., :2], angle, np.cos(angle), np.sin(angle))


def with_ground(values: Reals) -> Reals:
    """Values (n, bodies, 3) of the moving bodies, and zeros for the ground behind them."""
    return np.concatenate([values, np.zeros_like(values[:, :1])], axis=1)


def start_motion(scene: Scene) -> tuple[Reals, Reals, Reals]:
    """Position, velocity and acceleration of the start state, SI, one instant: each (1, bodies, 3), the ground last."""
    rows = [
        [(*b.position, b.angle) for b in scene.bodies],
        [(*b.velocity, b.angular_velocity) for b in scene.bodies],
        [(*b.acceleration, b.angular_acceleration) for b in scene.bodies],
    ]
    position, velocity, acceleration = (with_ground(np.array([row], dtype=float)) for row in rows)
    return position, velocity, acceleration


def body_numbers(scene: Scene) -> dict[str, int]:
    """The index of every body in the arrays, by its name; the ground's is the last."""
    return {name: number for number, name in enumerate([*(body.name for body in scene.bodies), GROUND])}


def body_masses(scene: Scene) -> Reals:
    """Mass, mass and moment of inertia, the weights of x, y and angle, (bodies, 3); 0 for the ground and where None."""
    return np.array([(b.mass, b.mass, b.inertia or 0.0) for b in scene.bodies] + [(0.0, 0.0, 0.0)])


def across(vectors: Reals) -> Reals:
    """Vectors, (..., 2), turned by a right angle, counter-clockwise."""
    result = np.empty_like(vectors)  # np.stack would cost a single instant several times as much
    np.negative(vectors[..., 1], out=result[..., 0])
    result[..., 1] = vectors[..., 0]
    return result


def dot(first: Reals, second: Reals) -> Reals:
    """Scalar product of plane vectors (..., 2) along the last axis, (...)."""
    return first[..., 0] * second[..., 0] + first[..., 1] * second[..., 1]


def point_velocity(arm: Reals, rate: Reals) -> Reals:
    """Velocity of a point fixed in a body, (n, 2), from its arm (n, 2) and the body's rates (n, 3)."""
    return rate[:, :2] + rate[:, 2:] * across(arm)


def point_acceleration(arm: Reals, rate: Reals, second: Reals) -> Reals:
    """Acceleration of a point fixed in a body, (n, 2), ground frame, as ``arm`` (n, 2) from the mass centre is.

    ``rate`` and ``second`` (n, 3) are the first and second time derivatives of the body's pose.
    """
    return second[:, :2] + second[:, 2:] * across(arm) - rate[:, 2:] ** 2 * arm


# The driver's coordinate φ as a function of the bodies: a crank's angle, a slider's travel, a cylinder's length.
#
# A crank's angle is one of the bodies' coordinates. A slider of the ground, or a cylinder, is two points: φ is their
# span along the guide, or its length, so that with u the unit vector along it
#
#     φ' = u · s',    φ'' = u · s'' + (|s'|² − (u · s')²) / φ
#
# where the last term is a cylinder's only. The force that drives it acts along u on the first point, and its reverse on
# the second.


@dataclass(frozen=True)
class Span:
    """Between the two points of a linear driver, at n instants: arms from the mass centres to them, span, direction u.

    All are (n, 2); ``length`` (n,) is φ.
    """

    first: Reals
    second: Reals
    between: Reals
    along: Reals
    length: Reals


class Driver:
    """The driver of a scene, lengths counted in ``unit``; ``scale`` is what φ counts in: rad, or that unit in m."""

    def __init__(self, scene: Scene, unit: float = 1.0) -> None:
        """Find the bodies of a scene's driver; lengths count in ``unit``, m."""
        numbers = body_numbers(scene)
        self.kind = scene.driver_kind
        self.turns = self.kind is DriverKind.CRANK
        self.scale = 1.0 if self.turns else unit
        self.count = len(numbers)
        if self.turns:
            self.crank = numbers[scene.crank]
            return
        (first, here), (second, there) = scene.driver_ends
        self.crank = -1
        self.ends = np.array([numbers[first], numbers[second]], dtype=np.intp)
        self.anchors = np.array([here, there], dtype=float) / unit
        self.line = np.array(scene.driven_slider.along) if self.kind is DriverKind.SLIDER else None

    def span(self, pose: Pose) -> Span | None:
        """The two ends of a linear driver at a pose, in units, and the vector between them; None for a crank."""
        if self.turns:
            return None
        arms = pose.turned(self.anchors, self.ends)
        between = pose.place[:, self.ends[0]] - pose.place[:, self.ends[1]] + (arms[:, 0] - arms[:, 1])
        if self.line is None:
            length = np.sqrt(dot(between, between))
            return Span(arms[:, 0], arms[:, 1], between, between / length[:, None], length)
        along = np.broadcast_to(self.line.astype(between.dtype), between.shape)
        return Span(arms[:, 0], arms[:, 1], between, along, dot(along, between))

    def value(self, pose: Pose) -> Reals:
        """φ at a pose, (n,): a crank's angle, rad, or a linear driver's travel or length in units."""
        span = self.span(pose)
        return pose.angle[:, self.crank] if span is None else span.length

    def gradient(self, span: Span | None, count: int) -> Reals:
        """The gradient of φ over every body's x, y and angle, (n, bodies, 3), n being ``count``.

        ``span`` is the driver's at the pose, None for a crank.
        """
        result = np.zeros((count, self.count, 3), dtype=float if span is None else span.between.dtype)
        if span is None:
            result[:, self.crank, 2] = 1.0
            return result
        for body, arm, sign in zip(self.ends, (span.first, span.second), (1.0, -1.0), strict=True):
            result[:, body, :2] += sign * span.along
            result[:, body, 2] += sign * dot(span.along, across(arm))
        return result

    def bend(self, span: Span | None, rate: Reals) -> Reals:
        """The negative of the part of φ̈ that the bodies' rates (n, bodies, 3) alone cause, (n,); 0 for a crank."""
        if span is None:
            return np.zeros(len(rate), dtype=rate.dtype)
        first, second = rate[:, self.ends[0]], rate[:, self.ends[1]]
        first_spin, second_spin = first[:, 2:], second[:, 2:]
        inward = first_spin**2 * span.first - second_spin**2 * span.second
        result = dot(span.along, inward)
        if self.line is None:
            moved = first[:, :2] - second[:, :2] + first_spin * across(span.first) - second_spin * across(span.second)
            result = result - dot(across(span.along), moved) ** 2 / span.length
        return np.asarray(result)


def start_coordinate(scene: Scene) -> float:
    """φ at the start: the crank body's angle, unwrapped, rad, or the travel or length of a linear driver, m."""
    return float(driven(scene, start_motion(scene)[0])[0][0])


def driven(scene: Scene, position: Reals, *rates: Reals) -> tuple[Reals, ...]:
    """φ, rad or m, and its time derivatives, each (n,), from motions of the bodies, SI, each (n, bodies, 3).

    ``rates`` are none, the velocity, or the velocity and the acceleration.
    """
    driver, pose = Driver(scene), pose_of(position)
    span = driver.span(pose)
    gradient = driver.gradient(span, len(position))
    result = [driver.value(pose)]
    for order, rate in enumerate(rates, start=1):
        along = np.sum(gradient * rate, axis=(1, 2))
        result.append(along if order == 1 else along - driver.bend(span, rates[0]))
    return tuple(result)
