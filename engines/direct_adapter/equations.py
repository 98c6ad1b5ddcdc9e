"""The joints of a scene as constraint equations in body coordinates: residual, Jacobian and acceleration terms.

Every body has the coordinates x, y of its mass centre and, where it can turn, its angle θ. A pin holds two points
together, a slot or slider keeps a point on a line of its host, a slider keeps its angle against the host as well, and
the drive sets the crank's angle: as many equations Φ(q, φ) = 0 as coordinates q, so that motion and forces follow from
one square matrix G = ∂Φ/∂q per instant:

    G q' = e,    G q̈ = γ(q, q̇) + e ε,    Gᵀ λ = M q̈ − F

with e the crank's row and λ the joint forces and, in the crank's row, the drive torque. (E. J. Haug, Computer Aided
Kinematics and Dynamics of Mechanical Systems, 1989, chapters 3 and 7, gives the method.)

Lengths are counted in ``unit``, a power of two near the longest arm, which brings the entries of G near 1 without
rounding anything. Arrays are (instants, ...); the ground is the last body. Nothing depends on the floating type, which
is that of the pose.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Vector
from engines.scene import Scene

Reals = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Pose:
    """All bodies at n instants: ``place`` (n, bodies, 2) in units; ``angle``, ``cosine``, ``sine`` (n, bodies).

    Cosine and sine are carried beside the angle, as an angle of many turns is too coarse for them.
    """

    place: Reals
    angle: Reals
    cosine: Reals
    sine: Reals

    def moved(self, step: Reals) -> Pose:
        """The pose after a small step (n, bodies, 3) in x, y and θ."""
        turn = step[..., 2]
        c, s = np.cos(turn), np.sin(turn)
        return Pose(
            self.place + step[..., :2],
            self.angle + turn,
            self.cosine * c - self.sine * s,
            self.sine * c + self.cosine * s,
        )

    def turned(self, vectors: Reals, bodies: NDArray[np.intp]) -> Reals:
        """Vectors (j, 2) of the frames of ``bodies`` (j,), in the ground frame: (n, j, 2)."""
        c, s = self.cosine[:, bodies], self.sine[:, bodies]
        x, y = vectors[:, 0], vectors[:, 1]
        result = np.empty((*c.shape, 2), dtype=c.dtype)
        result[..., 0] = c * x - s * y
        result[..., 1] = s * x + c * y
        return result


@dataclass(frozen=True)
class Arms:
    """Vectors of the joints at n instants, (n, ·, 2): from mass centres to anchors, between anchors, along lines."""

    body: Reals
    host: Reals
    gap: Reals
    along: Reals


def across(vectors: Reals) -> Reals:
    """Vectors turned by a right angle, counter-clockwise."""
    result = np.empty_like(vectors)  # np.stack would cost a single instant several times as much
    np.negative(vectors[..., 1], out=result[..., 0])
    result[..., 1] = vectors[..., 0]
    return result


def dot(one: Reals, other: Reals) -> Reals:
    """Scalar product along the last axis."""
    return one[..., 0] * other[..., 0] + one[..., 1] * other[..., 1]


class Equations:
    """The constraint equations of a scene; rows are pins in x, pins in y, lines, angles, crank.

    ``solves`` counts the linear systems solved so far, one for every right-hand side of every instant.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.index = {**{body.name: number for number, body in enumerate(scene.bodies)}, GROUND: len(scene.bodies)}
        self.pins, self.lines = len(scene.pins), len(scene.guided)
        self.joints = (*(pin.name for pin in scene.pins), *(line.name for line in scene.guided))
        self.body = self._numbers([*(pin.first for pin in scene.pins), *(line.body for line in scene.guided)])
        self.host = self._numbers([*(pin.second for pin in scene.pins), *(line.host for line in scene.guided)])
        body_anchor = _table([*(pin.first_anchor for pin in scene.pins), *(line.anchor for line in scene.guided)])
        host_anchor = _table([*(pin.second_anchor for pin in scene.pins), *(line.through for line in scene.guided)])
        self.unit = _power_of_two(np.concatenate([body_anchor, host_anchor]))
        self.body_anchor, self.host_anchor = body_anchor / self.unit, host_anchor / self.unit
        self.along = _table([line.along for line in scene.guided])
        self._count_coordinates()
        self._count_rows()
        self._template = self._constant_entries()
        self.solves = 0

    def _numbers(self, names: list[str]) -> NDArray[np.intp]:
        return np.array([self.index[name] for name in names], dtype=np.intp)

    def _count_coordinates(self) -> None:
        """``free`` lists the coordinates as places in the flat (bodies, 3); ``column`` is its inverse, -1 if fixed."""
        can_turn = [body.inertia is not None for body in self.scene.bodies]
        free = np.array([(True, True, turns) for turns in can_turn] + [(False, False, False)])
        self.free = np.flatnonzero(free)
        self.size = len(self.free)
        self.column = np.full(free.shape, self.size, dtype=np.intp)  # a spare last column takes what is fixed
        self.column[free] = np.arange(self.size)
        self.mass = np.array([(b.mass, b.mass, b.inertia or 0.0) for b in self.scene.bodies] + [(0.0, 0.0, 0.0)])

    def _count_rows(self) -> None:
        sliders = [s for s in self.scene.sliders if self._turns(s.body) or self._turns(s.host)]
        self.turn_body = self._numbers([slider.body for slider in sliders])
        self.turn_host = self._numbers([slider.host for slider in sliders])
        angle = {**{body.name: body.angle for body in self.scene.bodies}, GROUND: 0.0}
        held = np.array([angle[slider.body] - angle[slider.host] for slider in sliders])
        self.turn_cosine, self.turn_sine = np.cos(held), np.sin(held)
        starts = np.cumsum([0, self.pins, self.pins, self.lines, len(sliders)])
        self.x_rows, self.y_rows, self.line_rows, self.turn_rows = (
            np.arange(start, end) for start, end in itertools.pairwise(starts)
        )
        self.crank_row = int(starts[-1])
        self.rows = self.crank_row + 1
        self.crank = self.index[self.scene.crank]
        self.crank_column = int(self.column[self.crank, 2])

    def _turns(self, name: str) -> bool:
        return bool(self.column[self.index[name], 2] != self.size)

    def _constant_entries(self) -> Reals:
        entries = np.zeros((self.rows, self.size + 1))
        pins = slice(0, self.pins)
        for rows, part in ((self.x_rows, 0), (self.y_rows, 1)):
            entries[rows, self.column[self.body[pins], part]] = 1.0
            entries[rows, self.column[self.host[pins], part]] = -1.0
        entries[self.turn_rows, self.column[self.turn_body, 2]] = 1.0
        entries[self.turn_rows, self.column[self.turn_host, 2]] = -1.0
        entries[self.crank_row, self.column[self.crank, 2]] = 1.0
        return entries

    def arms(self, pose: Pose) -> Arms:
        """The joints' vectors in the ground frame."""
        body, host = pose.turned(self.body_anchor, self.body), pose.turned(self.host_anchor, self.host)
        gap = (pose.place[:, self.body] - pose.place[:, self.host]) + (body - host)
        return Arms(body, host, gap, pose.turned(self.along, self.host[self.pins :]))

    def residual(self, pose: Pose, arms: Arms) -> Reals:
        """Φ (n, rows); the crank's row is 0, as poses are made with the crank where the drive has it."""
        result = np.zeros((len(pose.place), self.rows), dtype=pose.place.dtype)
        result[:, self.x_rows], result[:, self.y_rows] = arms.gap[:, : self.pins, 0], arms.gap[:, : self.pins, 1]
        result[:, self.line_rows] = dot(across(arms.along), arms.gap[:, self.pins :])
        if len(self.turn_rows):
            one, other = self.turn_body, self.turn_host
            c = pose.cosine[:, one] * pose.cosine[:, other] + pose.sine[:, one] * pose.sine[:, other]
            s = pose.sine[:, one] * pose.cosine[:, other] - pose.cosine[:, one] * pose.sine[:, other]
            result[:, self.turn_rows] = s * self.turn_cosine - c * self.turn_sine
        return result

    def jacobian(self, arms: Arms) -> Reals:
        """G (n, rows, coordinates)."""
        entries = np.empty((len(arms.gap), *self._template.shape), dtype=arms.gap.dtype)
        entries[:] = self._template
        pins, lines = slice(0, self.pins), slice(self.pins, None)
        turn = self.column[:, 2]
        body, host = across(arms.body), across(arms.host)
        for part, rows in ((0, self.x_rows), (1, self.y_rows)):
            entries[:, rows, turn[self.body[pins]]] = body[:, pins, part]
            entries[:, rows, turn[self.host[pins]]] = -host[:, pins, part]
        normal = across(arms.along)
        for part in (0, 1):
            entries[:, self.line_rows, self.column[self.body[lines], part]] = normal[..., part]
            entries[:, self.line_rows, self.column[self.host[lines], part]] = -normal[..., part]
        entries[:, self.line_rows, turn[self.body[lines]]] = dot(normal, body[:, lines])
        # The line turns with its host: its normal's own rate is -θ' along.
        entries[:, self.line_rows, turn[self.host[lines]]] = -dot(normal, host[:, lines]) - dot(
            arms.along, arms.gap[:, lines]
        )
        return entries[:, :, : self.size]

    def bend(self, arms: Arms, rate: Reals) -> Reals:
        """γ (n, rows), the part of G q̈ that the rates (n, bodies, 3) alone determine, without the crank's ε."""
        one, other = rate[:, self.body], rate[:, self.host]
        first, second = one[..., 2:], other[..., 2:]
        inward = first * first * arms.body - second * second * arms.host
        result = np.zeros((len(rate), self.rows), dtype=rate.dtype)
        result[:, self.x_rows], result[:, self.y_rows] = inward[:, : self.pins, 0], inward[:, : self.pins, 1]
        gap_rate = one[..., :2] - other[..., :2] + first * across(arms.body) - second * across(arms.host)
        lines = slice(self.pins, None)
        coriolis = 2.0 * second[:, lines, 0] * dot(arms.along, gap_rate[:, lines])
        result[:, self.line_rows] = dot(across(arms.along), inward[:, lines]) + coriolis
        return result

    def crank_unit(self, count: int) -> Reals:
        """The vector e for each instant, (count, rows): 1 in the crank's row."""
        result = np.zeros((count, self.rows))
        result[:, self.crank_row] = 1.0
        return result

    def spread(self, coordinates: Reals) -> Reals:
        """Coordinates (n, k) as (n, bodies, 3), 0 where fixed."""
        result = np.zeros((len(coordinates), len(self.column) * 3), dtype=coordinates.dtype)
        result[:, self.free] = coordinates
        return result.reshape(len(coordinates), -1, 3)

    def gather(self, bodies: Reals) -> Reals:
        """Entries (n, bodies, 3) of the free coordinates, (n, k)."""
        return bodies.reshape(len(bodies), -1)[:, self.free]

    def start(self) -> Pose:
        """The scene's start state, one instant."""
        bodies = self.scene.bodies
        place = np.array([[*(body.position for body in bodies), (0.0, 0.0)]]) / self.unit
        angle = np.array([[*(body.angle for body in bodies), 0.0]])
        return Pose(place, angle, np.cos(angle), np.sin(angle))


def _table(pairs: list[Vector]) -> Reals:
    return np.array(pairs, dtype=float).reshape(-1, 2)


def _power_of_two(anchors: Reals) -> float:
    longest = float(np.max(np.hypot(anchors[:, 0], anchors[:, 1]), initial=0.0))
    return 2.0 ** round(math.log2(longest)) if longest > 0.0 and math.isfinite(longest) else 1.0
