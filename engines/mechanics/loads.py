"""The loads of a scene on its bodies, at n instants at once: gravity, applied forces and torques, springs, dampers.

Everything is SI; poses are in metres.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from engines.mechanics.driver import Driver
from engines.mechanics.states import Pose, Reals, across, body_masses, body_numbers, dot, point_velocity
from engines.scene import PointSpring, Scene


def applied_loads(scene: Scene, pose: Pose, rate: Reals) -> Reals:
    """Force, N, and moment about the mass centre, N m, on every body, (n, bodies, 3), for rates (n, bodies, 3)."""
    numbers = body_numbers(scene)
    loads = np.zeros_like(rate)
    loads[..., :2] = body_masses(scene)[:, :2] * np.asarray(scene.gravity)
    crank_angle = np.asarray(Driver(scene).value(pose), dtype=float)
    for applied in scene.forces:
        body = numbers[applied.body]
        _add_force(loads, body, pose.arm(body, applied.anchor), applied.force(crank_angle).T)
    for torque in scene.torques:
        loads[:, numbers[torque.body], 2] += torque.torque(crank_angle)[0]
    for damper in scene.dampers:
        first, second = numbers[damper.first], numbers[damper.second]
        drag = damper.coefficient * (rate[:, first, 2] - rate[:, second, 2])
        loads[:, first, 2] -= drag
        loads[:, second, 2] += drag
    for spring in scene.springs:
        _add_spring(loads, numbers, spring, pose, rate)
    return loads


def potential_energy(scene: Scene, pose: Pose) -> Reals:
    """Energy of gravity and springs, J, (n,); that of gravity is 0 at the ground's origin."""
    numbers, masses = body_numbers(scene), body_masses(scene)
    energy: Reals = -np.einsum("nbk,k,b->n", pose.place, np.asarray(scene.gravity), masses[:, 0])
    for spring in scene.springs:
        first = pose.point(numbers[spring.first], spring.first_anchor)
        span = first - pose.point(numbers[spring.second], spring.second_anchor)
        energy += 0.5 * spring.stiffness * (np.sqrt(dot(span, span)) - spring.length) ** 2
    return energy


def without_potential(scene: Scene) -> Scene:
    """The scene without the loads that have a potential energy: what is left does work or takes it."""
    springs = tuple(replace(spring, stiffness=0.0) for spring in scene.springs if spring.damping)
    return replace(scene, gravity=(0.0, 0.0), springs=springs)


def _add_force(loads: Reals, body: int, arm: Reals, force: Reals) -> None:
    loads[:, body, :2] += force
    loads[:, body, 2] += dot(across(arm), force)


def _add_spring(loads: Reals, numbers: dict[str, int], spring: PointSpring, pose: Pose, rate: Reals) -> None:
    """A spring's and dashpot's pull on both of its ends."""
    first, second = numbers[spring.first], numbers[spring.second]
    first_arm, second_arm = pose.arm(first, spring.first_anchor), pose.arm(second, spring.second_anchor)
    span = pose.place[:, first] + first_arm - (pose.place[:, second] + second_arm)
    span_rate = point_velocity(first_arm, rate[:, first]) - point_velocity(second_arm, rate[:, second])
    length = np.sqrt(dot(span, span))
    # Ends that meet have no direction to pull in; without a free length there is no pull either.
    direction = span / np.where(length > 0.0, length, 1.0)[:, None]
    tension = spring.stiffness * (length - spring.length) + spring.damping * dot(direction, span_rate)
    pull = -tension[:, None] * direction
    _add_force(loads, first, first_arm, pull)
    _add_force(loads, second, second_arm, -pull)
