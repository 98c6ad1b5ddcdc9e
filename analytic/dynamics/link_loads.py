"""Loads on the links besides joint forces: weights, inertia forces, applied forces and torques, springs, dampers.

By d'Alembert's principle a link's inertia force −m S̈ at its mass centre and inertia torque −J θ̈ are loads like any
other: with them, all forces and moments on a link balance.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.description.linkage import Link, RotaryDamper, Spring, Vector
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Scalar
from analytic.kinematics.sweep import Sweep

TINY: Final = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Load:
    """A force, N, ground frame, at a point given in the frame of ``body``, and a torque, N m; None stands for zero.

    The ``body`` may be the ground.
    """

    body: str
    at: Vector
    force: Pair | None = None
    torque: Scalar | None = None


class LoadedSweep:
    """The loads on the links of a sweep while the crank turns at ``speed`` (rad/s) with ``acceleration`` (rad/s²).

    Both are signed, of the sweep's shape or scalar. No second derivative is computed for a crank at rest without
    acceleration.
    """

    def __init__(self, sweep: Sweep, speed: Scalar, acceleration: Scalar) -> None:
        self.sweep = sweep
        self.linkage = sweep.linkage
        self.speed, self.acceleration, self.square = speed, acceleration, speed * speed
        self.turns = bool(np.any(self.speed))
        self.is_static = not (self.turns or np.any(self.acceleration))

    def from_outside(self) -> Iterator[Load]:
        """Weights, inertia forces, forces at points and torques on links: loads without a reaction on the linkage."""
        yield from (self._of_mass(link) for link in self.linkage.links.values())
        for force in self.linkage.forces:
            x, y = force.force(self.sweep.places)
            yield Load(force.link, self.linkage.local(force.point, force.link), (x, y))
        for torque in self.linkage.torques:
            yield Load(torque.link, self.linkage.links[torque.link].centre, None, torque.torque(self.sweep.places)[0])

    def between_bodies(self) -> Iterator[Load]:
        """Springs, dashpots and dampers, which push two bodies, or a link and the ground, apart: two loads each."""
        for spring in self.linkage.springs:
            yield from self._of_spring(spring)
        if self.turns:
            for damper in self.linkage.dampers:
                yield from self._of_damper(damper)

    def _of_mass(self, link: Link) -> Load:
        """Weight and inertia: m (g − S̈) at the mass centre and −J θ̈."""
        x, y = self.linkage.gravity
        if self.is_static:
            return Load(link.name, link.centre, (link.mass * x, link.mass * y))
        first, second = (self.sweep.centre(link.name, order) for order in (1, 2))
        moves = [self.square * two + self.acceleration * squared for squared, two in zip(first, second, strict=True)]
        force = (link.mass * (x - moves[0]), link.mass * (y - moves[1]))
        if link.inertia is None:
            return Load(link.name, link.centre, force)
        turn = self.square * self.sweep.accelerations(link.name)[2]
        turn = turn + self.acceleration * self.sweep.rates(link.name)[2]
        return Load(link.name, link.centre, force, -link.inertia * turn)

    def _of_spring(self, spring: Spring) -> tuple[Load, Load]:
        """A pull along the line between the ends; ends that meet have no such line and pull only by their stretch."""
        (first, two), (near_end, far_end) = spring.links, self._ends(spring)
        span = frames.minus(*(self.sweep.local_point(body, at) for body, at in ((first, near_end), (two, far_end))))
        over_length = _over_length(span)
        per_length = spring.stiffness * (1.0 - spring.length * over_length)
        if self.turns and not frames.is_zero(spring.damping):
            rate = frames.minus(
                *(self.sweep.local_point(body, at, 1) for body, at in ((first, near_end), (two, far_end)))
            )
            per_length = per_length + spring.damping * self.speed * frames.dot(span, rate) * over_length * over_length
        force = (per_length * span[0], per_length * span[1])
        return Load(first, near_end, (-force[0], -force[1])), Load(two, far_end, force)

    def _ends(self, spring: Spring) -> tuple[Vector, Vector]:
        near_end, far_end = (self.linkage.local(p, body) for p, body in zip(spring.points, spring.links, strict=True))
        return near_end, far_end

    def _of_damper(self, damper: RotaryDamper) -> tuple[Load, Load]:
        first, second = (self.sweep.rates(name)[2] for name in damper.links)
        torque = damper.coefficient * self.speed * (first - second)
        return Load(damper.links[0], (0.0, 0.0), None, -torque), Load(damper.links[1], (0.0, 0.0), None, torque)


def _over_length(span: Pair) -> Scalar:
    """Reciprocal of a length; zero for a length of zero."""
    square = frames.dot(span, span)
    return (square > 0.0) / np.sqrt(np.maximum(square, TINY))


def resultant(sweep: Sweep, loads: Iterable[Load], about: Vector) -> tuple[Scalar, Scalar, Scalar]:
    """Sum of loads on any bodies: force, N, and moment about a point of the ground, N m."""
    x: Scalar = 0.0
    y: Scalar = 0.0
    moment: Scalar = 0.0
    for load in loads:
        if load.torque is not None:
            moment = moment + load.torque
        if load.force is not None:
            arm = frames.minus(sweep.local_point(load.body, load.at), about)
            x, y, moment = x + load.force[0], y + load.force[1], moment + frames.cross(arm, load.force)
    return x, y, moment
