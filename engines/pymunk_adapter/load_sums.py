"""All loads of a scene as forces and torques on the parts of its layout, along a recorded motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Vector
from engines.pymunk_adapter.layout import STILL, Layout
from engines.pymunk_adapter.reactions import across, turned
from engines.pymunk_adapter.space import carried_anchor, part_number
from engines.scene import PointSpring, Scene

Array = NDArray[np.float64]


def loads_on_parts(scene: Scene, layout: Layout, state: Array, velocity: Array) -> Array:
    """Forces and torques of all loads on the parts, (n, parts, 3), at given positions and velocities of the parts."""
    sums = _Sums(scene, layout, state, velocity)
    angle = state[:, layout.crank, 2]
    for force in scene.forces:
        sums.add_force(force.body, force.anchor, force.force(angle).T)
    for torque in scene.torques:
        sums.add_torque(torque.body, torque.torque(angle)[0])
    for damper in scene.dampers:
        moment = damper.coefficient * (sums.turn_rate(damper.second) - sums.turn_rate(damper.first))
        sums.add_torque(damper.first, moment)
        sums.add_torque(damper.second, -moment)
    for spring in scene.springs:
        sums.add_spring(spring)
    return sums.total


class _Sums:
    """Sums of loads on parts, starting with their weight; bodies are addressed by the scene's names."""

    def __init__(self, scene: Scene, layout: Layout, state: Array, velocity: Array) -> None:
        self.scene, self.layout, self.state, self.velocity = scene, layout, state, velocity
        self.total = np.zeros_like(state)
        self.total[:, :, :2] = np.array([part.mass for part in layout.parts])[:, None] * np.asarray(scene.gravity)

    def turn_rate(self, body: str) -> Array:
        number = part_number(self.scene, body)
        return np.zeros(len(self.state)) if number == STILL else self.velocity[:, number, 2]

    def add_torque(self, body: str, torque: Array) -> None:
        number = part_number(self.scene, body)
        if number != STILL:
            self.total[:, number, 2] += torque

    def add_force(self, body: str, anchor: Vector, force: Array) -> None:
        number = part_number(self.scene, body)
        if number != STILL:
            arm = self._arm(number, anchor)
            self.total[:, number, :2] += force
            self.total[:, number, 2] += np.sum(across(arm) * force, axis=-1)

    def add_spring(self, spring: PointSpring) -> None:
        first, first_rate = self._end(spring.first, spring.first_anchor)
        second, second_rate = self._end(spring.second, spring.second_anchor)
        length = np.linalg.norm(second - first, axis=-1, keepdims=True)
        way = (second - first) / length
        speed = np.sum(way * (second_rate - first_rate), axis=-1, keepdims=True)
        pull = way * (spring.stiffness * (length - spring.length) + spring.damping * speed)
        self.add_force(spring.first, spring.first_anchor, pull)
        self.add_force(spring.second, spring.second_anchor, -pull)

    def _arm(self, number: int, anchor: Vector) -> Array:
        return turned(carried_anchor(self.layout, number, anchor), self.state[:, number, 2])

    def _end(self, body: str, anchor: Vector) -> tuple[Array, Array]:
        """Position and velocity of a spring's end, (n, 2)."""
        number = part_number(self.scene, body)
        if number == STILL:
            return np.broadcast_to(np.asarray(anchor), (len(self.state), 2)), np.zeros((len(self.state), 2))
        arm = self._arm(number, anchor)
        velocity = self.velocity[:, number]
        return self.state[:, number, :2] + arm, velocity[:, :2] + velocity[:, 2:] * across(arm)
