"""Loads on the links besides joint forces: weights, inertia forces, forces and torques, springs, dashpots and dampers.

By d'Alembert's principle a link's inertia force −m S̈ at its mass centre and inertia torque −J θ̈ are loads like any
other: with them, all forces and moments on a link balance. What acts between two bodies is two loads. Joint forces and
the generalised force both come from these.

Functions of a sweep raise AssemblyError where the linkage cannot be assembled or moved, unless it collects ``faults``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.description.linkage import GROUND, Link, LinkTorque, PointForce, Spring, TorsionSpring, Vector
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

    def times(self, factor: Scalar) -> Load:
        """The load with force and torque times a factor."""
        force = None if self.force is None else (factor * self.force[0], factor * self.force[1])
        return Load(self.body, self.at, force, None if self.torque is None else factor * self.torque)

    def power(self, sweep: Sweep) -> Scalar:
        """The load's power at unit speed of the driver, N m of a crank, N of a driver that is pushed.

        None for a load with neither force nor torque.
        """
        turned = None if self.torque is None else self.torque * sweep.rates(self.body)[2]
        if self.force is None:
            return turned
        moved = frames.dot(self.force, sweep.local_point(self.body, self.at, 1))
        return moved if turned is None else moved + turned


Between = tuple[Load, Load]  # on two bodies, each the reverse of the other
Elastic = Spring | TorsionSpring


def all_loads(sweep: Sweep, speed: Scalar, acceleration: Scalar) -> Iterator[Load]:
    """Yield every load while the crank turns at ``speed`` (rad/s) with ``acceleration`` (rad/s²), joint friction apart.

    Both are signed, of the sweep's shape or scalar.
    """
    yield from external_loads(sweep, speed, acceleration)
    for load in sweep.linkage.applied:
        if load.reaction is not None:
            yield from applied_loads(sweep, load, speed)
    for _, both in elastic_loads(sweep):
        yield from both
    if np.any(speed):
        for both in drags(sweep):
            yield from (load.times(speed) for load in both)


def external_loads(sweep: Sweep, speed: Scalar, acceleration: Scalar) -> Iterator[Load]:
    """Yield loads without a reaction on the linkage: weights, inertia forces, forces at points, torques on links.

    The crank's speed, rad/s, and acceleration, rad/s², are signed, of the sweep's shape or scalar.
    """
    for link in sweep.linkage.links.values():
        yield _mass_load(sweep, link, speed, acceleration)
    for load in sweep.linkage.applied:
        if load.reaction is None:
            yield from applied_loads(sweep, load, speed)


def _mass_load(sweep: Sweep, link: Link, speed: Scalar, acceleration: Scalar) -> Load:
    """Weight and inertia: m (g − S̈), N, at the mass centre and −J θ̈, N m; at rest the weight alone.

    The crank's speed, rad/s, and acceleration, rad/s², are signed, of the sweep's shape or scalar.
    """
    x, y = sweep.linkage.gravity
    if not (np.any(speed) or np.any(acceleration)):
        return Load(link.name, link.centre, (link.mass * x, link.mass * y))
    first, second = (sweep.centre(link.name, order) for order in (1, 2))
    square = speed * speed
    moves = [square * two + acceleration * once for once, two in zip(first, second, strict=True)]
    force = (link.mass * (x - moves[0]), link.mass * (y - moves[1]))
    if link.inertia is None:
        return Load(link.name, link.centre, force)
    turn = square * sweep.accelerations(link.name)[2] + acceleration * sweep.rates(link.name)[2]
    return Load(link.name, link.centre, force, -link.inertia * turn)


def applied_loads(sweep: Sweep, load: PointForce | LinkTorque, speed: Scalar) -> Iterator[Load]:
    """Yield a force or a torque on its link, and its reverse on the body that takes the reaction, at the same place.

    ``speed`` is that of the driver: a load of one direction acts by its sign, at rest as if φ grew. Without a reaction
    there is one load.
    """
    linkage = sweep.linkage
    if isinstance(load, LinkTorque):
        torque = sweep.load(load.torque, speed)[0]
        yield Load(load.link, linkage.links[load.link].centre, None, torque)
        if load.reaction is not None:
            yield Load(load.reaction, (0.0, 0.0), None, -torque)
        return
    x, y = sweep.load(load.force, speed)
    if load.frame != GROUND:
        x, y = frames.arm(sweep.poses(load.frame), (x, y))
    local = linkage.local(load.point, load.link)
    yield Load(load.link, local, (x, y))
    if load.reaction is not None:
        arm = frames.minus(sweep.local_point(load.link, local), sweep.local_point(load.reaction, (0.0, 0.0)))
        yield Load(load.reaction, (0.0, 0.0), (-x, -y), -frames.cross(arm, (x, y)))


def elastic_loads(sweep: Sweep) -> Iterator[tuple[Elastic, Between]]:
    """Yield each spring and torsion spring with its pair of loads, without that of its dashpot."""
    for spring in sweep.linkage.springs:
        span = _span(sweep, spring)
        yield spring, _pull(sweep, spring, spring.stiffness * (1.0 - spring.length * _inverse_length(span)))
    for coil in sweep.linkage.torsion_springs:
        yield coil, _opposite_torques(coil.links, coil.stiffness * sweep.turned_from(coil.links, coil.angle))


def stored_energy(sweep: Sweep) -> Scalar:
    """Energy of all springs, J."""
    energy: Scalar = 0.0
    for spring in sweep.linkage.springs:
        energy = energy + 0.5 * spring.stiffness * (np.hypot(*_span(sweep, spring)) - spring.length) ** 2
    for coil in sweep.linkage.torsion_springs:
        energy = energy + 0.5 * coil.stiffness * sweep.turned_from(coil.links, coil.angle) ** 2
    return energy


def drags(sweep: Sweep) -> Iterator[Between]:
    """Yield for each dashpot and damper its pair of loads at unit speed of the driver, N and N m."""
    for spring in sweep.linkage.springs:
        if not frames.is_zero(spring.damping):
            span = _span(sweep, spring)
            over_length = _inverse_length(span)
            rate = frames.dot(span, _span(sweep, spring, 1)) * over_length
            yield _pull(sweep, spring, spring.damping * rate * over_length)
    for damper in sweep.linkage.dampers:
        first, second = (sweep.rates(name)[2] for name in damper.links)
        yield _opposite_torques(damper.links, damper.coefficient * (first - second))


def _span(sweep: Sweep, spring: Spring, order: int = 0) -> Pair:
    """The vector from a spring's second end to its first, m, ground frame, or its derivative of an order over φ."""
    ends = zip(spring.points, spring.links, strict=True)
    return frames.minus(*(sweep.local_point(body, sweep.linkage.local(point, body), order) for point, body in ends))


def _inverse_length(span: Pair) -> Scalar:
    """Reciprocal of the length of a vector, 1/m; zero for a length of zero."""
    square = frames.dot(span, span)
    return (square > 0.0) / np.sqrt(np.maximum(square, TINY))


def _pull(sweep: Sweep, spring: Spring, per_length: Scalar) -> Between:
    """The pair of loads of a pull along the line between a spring's ends: ``per_length``, N/m, times its length."""
    (first, second), span = spring.links, _span(sweep, spring)
    near, far = (sweep.linkage.local(point, body) for point, body in zip(spring.points, spring.links, strict=True))
    force = (per_length * span[0], per_length * span[1])
    return Load(first, near, (-force[0], -force[1])), Load(second, far, force)


def _opposite_torques(links: tuple[str, str], torque: Scalar) -> Between:
    """The loads of a torque, N m, against the rotation of the first of two bodies, and its reverse on the second."""
    return Load(links[0], (0.0, 0.0), None, -torque), Load(links[1], (0.0, 0.0), None, torque)
