"""Forces, power and energy of a scene's loads along an observed motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Vector
from comparisons.observation.body_states import Pair, States
from comparisons.observation.observed_motion import ObservedMotion
from engines.scene import Channel, PointSpring, Scene

Array = NDArray[np.float64]


def potential_energy(motion: ObservedMotion, time: Array) -> Array:
    """Energy of gravity and springs, J, datum at the ground's origin."""
    gravity = np.asarray(motion.scene.gravity)
    places = motion.on_clock(Channel.POSITION, time)[:, :, :2]
    energy: Array = -np.einsum("nbk,k,b->n", places, gravity, motion.masses[:, 0])
    for spring in motion.scene.springs:
        first = motion.point(spring.first, spring.first_anchor, time)
        span = first - motion.point(spring.second, spring.second_anchor, time)
        energy += 0.5 * spring.stiffness * (np.hypot(*span.T) - spring.length) ** 2
    return energy


def other_power(motion: ObservedMotion, time: Array) -> Array:
    """Power of forces at points, torques on links and dampers, W (dampers take power: it is negative)."""
    scene = motion.scene
    if not (scene.forces or scene.torques or scene.dampers or any(spring.damping for spring in scene.springs)):
        return np.zeros(len(time))
    position, velocity = motion.on_clock(Channel.POSITION, time), motion.on_clock(Channel.VELOCITY, time)
    states = States({body.name: n for n, body in enumerate(scene.bodies)}, 1.0, position, velocity)
    return np.asarray(np.einsum("nbk,nbk->n", _other_wrenches(scene, states), velocity))


def dissipation(motion: ObservedMotion, time: Array) -> Array:
    """Power that dampers and dashpots take, W; never negative."""
    damped = replace(motion, scene=replace(motion.scene, forces=(), torques=()))
    return np.maximum(-other_power(damped, time), 0.0)


def wrenches(scene: Scene, states: States) -> Array:
    """All loads on every body, (instants, bodies, 3): force, N, and moment about the mass centre, N m."""
    result = _other_wrenches(scene, states)
    for number, body in enumerate(scene.bodies):
        result[:, number, 0] += body.mass * scene.gravity[0]
        result[:, number, 1] += body.mass * scene.gravity[1]
    for spring in scene.springs:
        x, y, length = _span(spring, states)
        _pull(result, states, spring, spring.stiffness * (length - spring.length), (x / length, y / length))
    return result


def _other_wrenches(scene: Scene, states: States) -> Array:
    """Those that have no potential: forces at points, torques on links, dashpots and dampers."""
    result = np.zeros_like(states.position)
    if scene.forces or scene.torques:
        angle = states.angle(scene.crank)
        for force in scene.forces:
            x, y = force.force(angle)
            _push(result, states, force.body, force.anchor, (x, y))
        for torque in scene.torques:
            result[:, states.numbers[torque.body], 2] += torque.torque(angle)[0]
    for damper in scene.dampers:
        moment = damper.coefficient * (states.angle(damper.first, 1) - states.angle(damper.second, 1))
        for body, sign in ((damper.first, -1.0), (damper.second, 1.0)):
            if body != GROUND:
                result[:, states.numbers[body], 2] += sign * moment
    for spring in scene.springs:
        if spring.damping:
            x, y, length = _span(spring, states)
            along = (x / length, y / length)
            ends = (spring.first, spring.first_anchor), (spring.second, spring.second_anchor)
            rate = states.gap(*ends, 1)
            stretching = states.size * (rate[0] * along[0] + rate[1] * along[1])
            _pull(result, states, spring, spring.damping * np.asarray(stretching), along)
    return result


def _span(spring: PointSpring, states: States) -> tuple[Array, Array, Array]:
    """From the second end to the first, and how far that is, m."""
    gap = states.gap((spring.first, spring.first_anchor), (spring.second, spring.second_anchor))
    x, y = states.size * np.asarray(gap[0]), states.size * np.asarray(gap[1])
    return x, y, np.hypot(x, y)


def _pull(result: Array, states: States, spring: PointSpring, tension: Array, along: tuple[Array, Array]) -> None:
    """Pull both ends of a spring together."""
    _push(result, states, spring.first, spring.first_anchor, (-tension * along[0], -tension * along[1]))
    _push(result, states, spring.second, spring.second_anchor, (tension * along[0], tension * along[1]))


def _push(result: Array, states: States, body: str, anchor: Vector, force: Pair) -> None:
    """Add a force at a point of a body."""
    if body == GROUND:
        return
    x, y = states.arm(body, anchor)
    number = states.numbers[body]
    result[:, number, 0] += force[0]
    result[:, number, 1] += force[1]
    result[:, number, 2] += states.size * (x * force[1] - y * force[0])
