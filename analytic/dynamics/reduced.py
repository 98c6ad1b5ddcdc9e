"""Reduced dynamics: the linkage as a variable inertia and a torque at the crank (articles 000, 001 and 003).

The units are those of a turning crank; a driver that is pushed has its own (``analytic.signals.unit_of``).

Article 003, eqs (1)-(5) define Jeq; article 000 the equation of motion Jeq φ̈ + ½ Jeq' φ̇² + b φ̇ = Q + M1. Primes
are d/dφ, exact.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import Link, LinkTorque, PointForce, Spring
from analytic.dynamics.link_loads import TINY
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Scalar, is_zero
from analytic.kinematics.structure import Prismatic
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]


def link_inertia(sweep: Sweep, link: str) -> Array:
    """Reduced moment of inertia of one link, m |S'|² + J θ'², kg m²."""
    return np.broadcast_to(np.asarray(_link_inertia(sweep, link), dtype=float), sweep.angle.shape)


def _link_inertia(sweep: Sweep, link: str) -> Scalar:
    """A link's reduced inertia, kg m², a plain number where it is constant; of a pushed slider its mass, kg."""
    body = sweep.linkage.links[link]
    pivot = sweep.structure.pivot
    if pivot is not None and link == pivot.far:  # slides on the ground or turns about a fixed point: a constant
        if isinstance(pivot, Prismatic):
            return body.mass
        x, y = frames.minus(body.centre, pivot.far_local)
        return body.mass * (x * x + y * y) + _own_inertia(body)
    return _weighted_products(sweep, link, 1)


def _weighted_products(sweep: Sweep, link: str, order: int) -> Scalar:
    """A link's part of ½ Jeq', m S'·S'' + J θ' θ'', kg m²/rad, and with order 1 of Jeq; zero factors are left out."""
    body = sweep.linkage.links[link]
    inertia = _own_inertia(body)
    moved = 0.0 if is_zero(body.mass) else body.mass * frames.dot(sweep.centre(link, 1), sweep.centre(link, order))
    if is_zero(inertia):
        return moved
    second = (sweep.rates if order == 1 else sweep.accelerations)(link)[2]
    turned = inertia * (sweep.rates(link)[2] * second)
    return turned if is_zero(moved) else moved + turned


def _own_inertia(body: Link) -> Scalar:
    return 0.0 if body.inertia is None else body.inertia


def reduced_inertia(sweep: Sweep, links: Iterable[str] | None = None) -> Array:
    """Jeq, kg m²: the sum over all links, or over those named."""
    names = list(sweep.linkage.links) if links is None else list(links)
    total = np.zeros(sweep.angle.shape)
    for name in names:
        total += _link_inertia(sweep, name)
    return total


def group_inertia(sweep: Sweep) -> dict[str, Array]:
    """Jeq of the crank and of every Assur group, by the group's name."""
    linkage = sweep.linkage
    parts = {f"{linkage.crank} (class I)": link_inertia(sweep, linkage.crank)} if linkage.crank else {}
    for group in sweep.structure.groups:
        parts[group.name] = reduced_inertia(sweep, [name for name in group.links if name in linkage.links])
    return parts


def half_inertia_derivative(sweep: Sweep) -> Array:
    """½ Jeq' = Σ m S'·S'' + J θ' θ'', kg m²/rad: the dot product, not the product of the moduli."""
    total = np.zeros(sweep.angle.shape)
    for name in sweep.linkage.links:
        if name != sweep.linkage.crank:  # its part of Jeq is a constant
            total += _weighted_products(sweep, name, 2)
    return total


def gravity_force(sweep: Sweep) -> Array:
    """Generalised force of gravity, Σ m g·S', N m; exactly zero without a gravity vector."""
    gravity = sweep.linkage.gravity
    total = np.zeros(sweep.angle.shape)
    if frames.is_origin(gravity):
        return total
    for name, body in sweep.linkage.links.items():
        if not is_zero(body.mass):
            total += body.mass * _product_with_constant(gravity, sweep.centre(name, 1))
    return total


def _product_with_constant(constant: Pair, vector: Pair) -> Scalar:
    """Scalar product with a constant vector, without work for its zero components."""
    x, y = constant
    return y * vector[1] if is_zero(x) else x * vector[0] + y * vector[1]


def load_force(sweep: Sweep) -> Array:
    """Generalised force of the forces at points, torques on links and springs, N m."""
    total = np.zeros(sweep.angle.shape)
    for _, part in load_forces(sweep):
        total += part
    return total


def load_forces(sweep: Sweep) -> Iterator[tuple[PointForce | LinkTorque | Spring, Array]]:
    """Each force, torque and spring with its generalised force, N m."""
    linkage = sweep.linkage
    for force in linkage.forces:
        fx, fy = force.force(sweep.places)
        vx, vy = sweep.local_point(force.link, linkage.local(force.point, force.link), 1)
        yield force, fx * vx + fy * vy
    for torque in linkage.torques:
        yield torque, torque.torque(sweep.places)[0] * sweep.rates(torque.link)[2]
    for number, spring in enumerate(linkage.springs):
        length, rate = spring_length(sweep, number)
        yield spring, -(spring.stiffness * (length - spring.length) * rate)


def generalised_force(sweep: Sweep) -> Array:
    """Q, N m: gravity and every load that does not depend on speed."""
    linkage = sweep.linkage
    loaded = linkage.forces or linkage.torques or linkage.springs
    return gravity_force(sweep) + load_force(sweep) if loaded else gravity_force(sweep)


def spring_length(sweep: Sweep, number: int) -> tuple[Array, Array]:
    """Length of a spring, m, and its derivative over φ; the derivative is zero where its ends meet."""
    spring = sweep.linkage.springs[number]
    ends = [(body, sweep.linkage.local(point, body)) for point, body in zip(spring.points, spring.links, strict=True)]
    (b1, p1), (b2, p2) = ends
    span = frames.minus(sweep.local_point(b1, p1), sweep.local_point(b2, p2))
    rate = frames.minus(sweep.local_point(b1, p1, 1), sweep.local_point(b2, p2, 1))
    length = np.sqrt(frames.dot(span, span))
    return length, frames.dot(span, rate) * frames.inverse(np.maximum(length, TINY))


def damping_coefficient(sweep: Sweep) -> Array:
    """Damping b reduced to the crank, N m s: the drag torque is b φ̇; constant if the only damper sits on the crank."""
    linkage = sweep.linkage
    total = np.zeros(sweep.angle.shape)
    for damper in linkage.dampers:
        first, second = (sweep.rates(name)[2] for name in damper.links)
        total += damper.coefficient * (first - second) ** 2
    for number, spring in enumerate(linkage.springs):
        if not is_zero(spring.damping):
            total += spring.damping * spring_length(sweep, number)[1] ** 2
    return total


def kinetic_energy(sweep: Sweep, speed: ArrayLike) -> Array:
    """Teq = ½ Jeq ω², J."""
    return np.asarray(0.5 * reduced_inertia(sweep) * np.square(speed))


def potential_energy(sweep: Sweep) -> Array:
    """Energy of gravity and of the springs, J; its datum is the ground frame's origin."""
    linkage = sweep.linkage
    total = np.zeros(sweep.angle.shape)
    if linkage.gravity != (0.0, 0.0):
        for name, body in linkage.links.items():
            if body.mass:
                total -= body.mass * _product_with_constant(linkage.gravity, sweep.centre(name))
    for number, spring in enumerate(linkage.springs):
        total += 0.5 * spring.stiffness * (spring_length(sweep, number)[0] - spring.length) ** 2
    return total


def drive_torque(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> Array:
    """Mkr = Jeq ε + ½ Jeq' ω² + b ω − Q, N m: the torque of the drive.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank, signed, of the sweep's shape or scalar.
    """
    speed, acceleration = np.asarray(speed, dtype=float), np.asarray(acceleration, dtype=float)
    inertia = reduced_inertia(sweep) if np.any(acceleration) else np.zeros(sweep.angle.shape)
    return balance(sweep, inertia, speed, acceleration)


def balance(sweep: Sweep, inertia: Array, speed: Array, acceleration: Array) -> Array:
    """Mkr as by ``drive_torque``, N m, with Jeq, kg m², given; a crank at rest needs no second derivative."""
    turns = bool(np.any(speed))
    torque = inertia * acceleration
    if turns:
        torque += half_inertia_derivative(sweep) * (speed * speed)
    torque -= generalised_force(sweep)
    linkage = sweep.linkage
    if turns and (linkage.dampers or not all(is_zero(spring.damping) for spring in linkage.springs)):
        torque += damping_coefficient(sweep) * speed
    return torque
