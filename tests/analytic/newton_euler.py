"""Newton's and Euler's laws for every body of an engines' scene at its start: what is left over of forces and moments.

Nothing here knows of dyads, nor where the closed form takes moments: bodies, joints and loads come from the scene.
"""

from collections import defaultdict
from collections.abc import Mapping

import numpy as np

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.linkage import GROUND
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from engines.scene import Prescribed, Scene


def scene_at(mechanism: Mechanism, angle: float, speed: float, acceleration: float) -> Scene:
    """The scene whose start state is the crank at an angle with a speed and an acceleration."""
    motion = CrankMotion("test", (Segment(0.0, 1.0, (angle, speed, 0.5 * acceleration)),))
    return scene(mechanism, Prescribed(motion), frozenset())


class Balance:
    """Sums of forces and of moments about the ground's origin on each body, [x, y, moment]; the ground's too."""

    def __init__(self, model: Scene) -> None:
        self.scene = model
        self.bodies = {body.name: body for body in model.bodies}
        self.sums: dict[str, np.ndarray] = defaultdict(lambda: np.zeros(3))

    def place(self, body: str, anchor: tuple[float, float]) -> np.ndarray:
        if body == GROUND:
            return np.array(anchor)
        c, s = np.cos(self.bodies[body].angle), np.sin(self.bodies[body].angle)
        x, y = anchor
        return self.bodies[body].position + np.array([c * x - s * y, s * x + c * y])

    def push(self, body: str, place: np.ndarray, force: np.ndarray, other: str | None = None) -> None:
        """Put a force on a body at a place, and its reverse on another body."""
        wrench = np.array([*force, place[0] * force[1] - place[1] * force[0]])
        self.sums[body] += wrench
        if other is not None:
            self.sums[other] -= wrench

    def twist(self, body: str, moment: float, other: str | None = None) -> None:
        """Put a torque on a body, and its reverse on another."""
        self.sums[body][2] += moment
        if other is not None:
            self.sums[other][2] -= moment

    def joints(self, forces: Mapping[str, np.ndarray], moments: Mapping[str, float], torque: float) -> None:
        """Enter joint forces, guides' moments on sliders and the drive's torque; every name has to be known."""
        model = self.scene
        unused = set(forces) - {joint.name for joint in (*model.pins, *model.sliders, *model.slots)}
        assert not unused, unused
        for pin in model.pins:
            self.push(pin.first, self.place(pin.first, pin.first_anchor), forces[pin.name], pin.second)
        for line in (*model.sliders, *model.slots):
            self.push(line.body, self.place(line.body, line.anchor), forces[line.name], line.host)
        for slider in model.sliders:
            self.twist(slider.body, moments[slider.name], slider.host)
        self.twist(model.crank, torque, GROUND)

    def loads(self) -> None:
        """Enter weights, forces, torques, springs and dampers."""
        model = self.scene
        for body in model.bodies:
            self.push(body.name, np.array(body.position), body.mass * np.array(model.gravity))
        for force in model.forces:
            self.push(force.body, self.place(force.body, force.anchor), force.force(model.crank_angle))
        for torque in model.torques:
            self.twist(torque.body, float(torque.torque(model.crank_angle)[0]))
        for spring in model.springs:
            here, there = self.place(spring.first, spring.first_anchor), self.place(spring.second, spring.second_anchor)
            span = here - there
            length = np.hypot(*span)
            rate = self.velocity(spring.first, here) - self.velocity(spring.second, there)
            pull = spring.stiffness * (length - spring.length) + spring.damping * (span @ rate) / length
            self.push(spring.first, here, -pull * span / length, spring.second)
        for damper in model.dampers:
            slip = self.turn_rate(damper.first) - self.turn_rate(damper.second)
            self.twist(damper.first, -damper.coefficient * slip, damper.second)

    def turn_rate(self, body: str) -> float:
        return 0.0 if body == GROUND else self.bodies[body].angular_velocity

    def velocity(self, body: str, place: np.ndarray) -> np.ndarray:
        if body == GROUND:
            return np.zeros(2)
        arm = place - self.bodies[body].position
        return self.bodies[body].velocity + self.bodies[body].angular_velocity * np.array([-arm[1], arm[0]])

    def left_over(self) -> dict[str, np.ndarray]:
        """Sums less m S̈ and J θ̈, the moment about the mass centre: zero on every body if the joint forces are right."""
        result = {}
        for name, body in self.bodies.items():
            x, y, moment = self.sums[name]
            moment -= body.position[0] * y - body.position[1] * x
            needed = (*(body.mass * np.array(body.acceleration)), (body.inertia or 0.0) * body.angular_acceleration)
            result[name] = np.array([x, y, moment]) - needed
        return result
