"""Power and energy of a scene's loads along an observed motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from comparisons.motion import ObservedMotion
from engines.contract import Channel, PointSpring

Array = NDArray[np.float64]


def potential_energy(motion: ObservedMotion, time: Array) -> Array:
    """Energy of gravity and springs, J, datum at the ground's origin."""
    gravity = np.asarray(motion.scene.gravity)
    places = motion.on_clock(Channel.POSITION, time)[:, :, :2]
    energy: Array = -np.einsum("nbk,k,b->n", places, gravity, motion.masses[:, 0])
    for spring in motion.scene.springs:
        span = _span(motion, spring, time)
        energy += 0.5 * spring.stiffness * (np.hypot(*span.T) - spring.length) ** 2
    return energy


def other_power(motion: ObservedMotion, time: Array) -> Array:
    """Power of forces at points, torques on links and dampers, W (dampers take power: it is negative)."""
    power = np.zeros(len(time))
    scene = motion.scene
    if scene.forces or scene.torques:
        angle = motion.crank(Channel.POSITION, time)
        for force in scene.forces:
            power += np.einsum("kn,nk->n", force.force(angle), motion.point_velocity(force.body, force.anchor, time))
        for torque in scene.torques:
            power += torque.torque(angle)[0] * motion.turn_rate(torque.body, time)
    for damper in scene.dampers:
        difference = motion.turn_rate(damper.first, time) - motion.turn_rate(damper.second, time)
        power -= damper.coefficient * difference**2
    for spring in scene.springs:
        if spring.damping:
            power -= spring.damping * _stretch_rate(motion, spring, time) ** 2
    return power


def conservative_power(motion: ObservedMotion, time: Array) -> Array:
    """Power of gravity and springs, W."""
    velocity = motion.on_clock(Channel.VELOCITY, time)[:, :, :2]
    power: Array = np.einsum("nbk,k,b->n", velocity, np.asarray(motion.scene.gravity), motion.masses[:, 0])
    for spring in motion.scene.springs:
        span = _span(motion, spring, time)
        power -= spring.stiffness * (np.hypot(*span.T) - spring.length) * _stretch_rate(motion, spring, time)
    return power


def _span(motion: ObservedMotion, spring: PointSpring, time: Array) -> Array:
    first = motion.point(spring.first, spring.first_anchor, time)
    return first - motion.point(spring.second, spring.second_anchor, time)


def _stretch_rate(motion: ObservedMotion, spring: PointSpring, time: Array) -> Array:
    span = _span(motion, spring, time)
    first = motion.point_velocity(spring.first, spring.first_anchor, time)
    rate = first - motion.point_velocity(spring.second, spring.second_anchor, time)
    return np.asarray(np.einsum("nk,nk->n", span, rate) / np.hypot(*span.T))
