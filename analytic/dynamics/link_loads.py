"""Loads on the links besides joint forces: weights, inertia forces, applied forces and torques, springs, dampers.

By d'Alembert's principle a link's inertia force −m S̈ at its mass centre and inertia torque −J θ̈ are loads like any
other: with them, all forces and moments on a link balance.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.description.linkage import GROUND, Link, RotaryDamper, Spring, Vector
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Scalar
from analytic.kinematics.structure import AnyGroup, DrivenDistance, GroupJoint, Revolute, Structure
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

    def external_loads(self) -> Iterator[Load]:
        """Weights, inertia forces, forces at points and torques on links: loads without a reaction on the linkage."""
        yield from (self._mass_load(link) for link in self.linkage.links.values())
        for force in self.linkage.forces:
            x, y = force.force(self.sweep.places)
            yield Load(force.link, self.linkage.local(force.point, force.link), (x, y))
        for torque in self.linkage.torques:
            yield Load(torque.link, self.linkage.links[torque.link].centre, None, torque.torque(self.sweep.places)[0])

    def internal_loads(self) -> Iterator[Load]:
        """Springs, dashpots and dampers, which push two bodies, or a link and the ground, apart: two loads each."""
        for spring in self.linkage.springs:
            yield from self._spring_loads(spring)
        if self.turns:
            for damper in self.linkage.dampers:
                yield from self._damper_loads(damper)

    def _mass_load(self, link: Link) -> Load:
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

    def _spring_loads(self, spring: Spring) -> tuple[Load, Load]:
        """A pull along the line between the ends; ends that meet have no such line and pull only by their stretch."""
        (first, two), (near_end, far_end) = spring.links, self._spring_ends(spring)
        span = frames.minus(*(self.sweep.local_point(body, at) for body, at in ((first, near_end), (two, far_end))))
        over_length = _inverse_length(span)
        per_length = spring.stiffness * (1.0 - spring.length * over_length)
        if self.turns and not frames.is_zero(spring.damping):
            rate = frames.minus(
                *(self.sweep.local_point(body, at, 1) for body, at in ((first, near_end), (two, far_end)))
            )
            per_length = per_length + spring.damping * self.speed * frames.dot(span, rate) * over_length * over_length
        force = (per_length * span[0], per_length * span[1])
        return Load(first, near_end, (-force[0], -force[1])), Load(two, far_end, force)

    def _spring_ends(self, spring: Spring) -> tuple[Vector, Vector]:
        near_end, far_end = (self.linkage.local(p, body) for p, body in zip(spring.points, spring.links, strict=True))
        return near_end, far_end

    def _damper_loads(self, damper: RotaryDamper) -> tuple[Load, Load]:
        first, second = (self.sweep.rates(name)[2] for name in damper.links)
        torque = damper.coefficient * self.speed * (first - second)
        return Load(damper.links[0], (0.0, 0.0), None, -torque), Load(damper.links[1], (0.0, 0.0), None, torque)


def _inverse_length(span: Pair) -> Scalar:
    """Reciprocal of the length of a vector, 1/m; zero for a length of zero."""
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


# Balance of a force analysis: the wrench that every link still needs from its joints, and the joints' wrenches.
#
# A *wrench* is (force x, force y, N, moment, N m). A link *needs* the wrench that its joints together must exert on
# it, about the link's reference point, which is a pin of its group wherever it has one.

Wrench = tuple[Scalar, Scalar, Scalar]


class LinkBalance:
    """The links at their poses under their loads, before any joint force is known.

    ``needs`` holds, by body, the wrench about its reference point that joints not yet entered must exert. ``at_pins``
    has the force of a pin on each of its bodies, by point and body; ``on_sliders`` that of the guide on each slider,
    those in slots included.
    """

    def __init__(self, loaded: LoadedSweep) -> None:
        sweep, structure = loaded.sweep, loaded.sweep.structure
        self.structure = structure
        self.drive: Scalar = 0.0  # force of a cylinder
        for group in structure.groups:
            sweep.rates(group.first)  # refuses dead positions, in which the joints cannot hold the links
        self.poses = {body: sweep.poses(body) for body in (GROUND, *structure.bodies)}
        self.reference_points = reference_points(structure)
        self.needs: dict[str, Wrench] = dict.fromkeys(self.poses, (0.0, 0.0, 0.0))
        self.at_pins: dict[tuple[str, str], Pair] = {}
        self.on_sliders: dict[str, Pair] = {}
        for load in (*loaded.external_loads(), *loaded.internal_loads()):
            if load.force is not None:
                self._add_load(load.body, load.force, self.arm(load.body, load.at))
            if load.torque is not None:
                self._add_load(load.body, (0.0, 0.0), (0.0, 0.0), load.torque)

    def enter_outer_wrench(self, joint: GroupJoint, wrench: Wrench) -> None:
        """Enter the wrench of an outer joint of a group on its far link; its reverse is a load on the near link."""
        self.enter_wrench(joint, wrench)
        x, y, moment = wrench
        arm = self.arm(joint.near, joint.near_local) if isinstance(joint, Revolute) else self.gap(joint.near, joint.far)
        self._add_load(joint.near, (-x, -y), arm, -moment)

    def enter_wrench(self, joint: GroupJoint, wrench: Wrench) -> None:
        """Enter the wrench of a joint on its far body, and the reverse on the near body."""
        if isinstance(joint, DrivenDistance):
            self.drive = frames.dot(self.direction(joint), (wrench[0], wrench[1]))
        elif isinstance(joint, Revolute):
            self._add_pin_force(joint.point, joint.far, (wrench[0], wrench[1]))
            self._add_pin_force(joint.point, joint.near, (-wrench[0], -wrench[1]))
        else:
            x, y, _ = wrench
            self.on_sliders[joint.slider] = (x, y) if joint.far == joint.slider else (-x, -y)

    def _add_load(self, body: str, force: Pair, arm: Pair, torque: Scalar = 0.0) -> None:
        """Enter a load on a body, its force at an arm from the reference point; loads on the ground are not entered."""
        if body != GROUND:
            x, y, moment = self.needs[body]
            self.needs[body] = (x - force[0], y - force[1], moment - frames.cross(arm, force) - torque)

    def _add_pin_force(self, point: str, body: str, force: Pair) -> None:
        """Add to the force of a pin on a body, which several groups may share."""
        x, y = self.at_pins.get((point, body), (0.0, 0.0))
        self.at_pins[point, body] = (x + force[0], y + force[1])

    def arm(self, body: str, to: Vector) -> Pair:
        """Vector, m, from the reference point of a body to another point of it, ground frame."""
        reference = self.reference_points[body]
        return frames.arm(self.poses[body], (to[0] - reference[0], to[1] - reference[1]))

    def direction(self, cylinder: DrivenDistance) -> Pair:
        """The unit vector along a cylinder, from its near end to its far end."""
        near, far = (self.poses[cylinder.near], self.poses[cylinder.far])
        x, y = frames.minus(frames.point(far, cylinder.far_local), frames.point(near, cylinder.near_local))
        length = np.hypot(x, y)
        return (x / length, y / length)

    def place(self, body: str) -> Pair:
        """Position of the reference point of a body, m, ground frame."""
        return frames.point(self.poses[body], self.reference_points[body])

    def gap(self, start: str, end: str) -> Pair:
        """Vector, m, from the reference point of one body to that of another."""
        return frames.minus(self.place(end), self.place(start))


def reference_points(structure: Structure) -> dict[str, Vector]:
    """The reference point of every body, in its own frame: its outer pin, else its inner pin, else its mass centre.

    With moments taken about pins, lengths are differences of points of one link, however far its frame's origin lies.
    """
    pivot = structure.pivot
    reference = {GROUND: (0.0, 0.0)}
    if pivot is not None:
        reference[pivot.far] = pivot.far_local if isinstance(pivot, Revolute) else structure.bodies[pivot.far].centre
    for group in structure.groups:
        reference.update({body: _pin_of_link(group, body) or structure.bodies[body].centre for body in group.links})
    return reference


def _pin_of_link(group: AnyGroup, body: str) -> Vector | None:
    """A pin of a link, in its frame, to a placed body if there is one; None where the link has slides alone."""
    pins = [joint for joint in group.joints if isinstance(joint, Revolute) and body in (joint.near, joint.far)]
    pins.sort(key=lambda joint: joint.near in group.links)
    return next((joint.far_local if body == joint.far else joint.near_local for joint in pins), None)
