"""True motion and joint forces for tests of engines, from the closed form's states.

The forces come from every body's own equations of motion: one linear system per instant over all
bodies at once, which shares nothing with any engine.
"""

from __future__ import annotations

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.description.linkage import GROUND
from analytic.kinematics.mechanism import Mechanism
from engines.scene import Scene

Array = np.ndarray


def true_motion(mechanism: Mechanism, motion: CrankMotion, time: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration (n, bodies, 3), bodies sorted by name as in a scene."""
    sweep, speed, second = mechanism.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time)
    orders = []
    for order in range(3):
        angles = [sweep.angles, lambda n: sweep.rates(n)[2], lambda n: sweep.accelerations(n)[2]][order]
        rows = [(*sweep.centre(name, order), angles(name)) for name in mechanism.linkage.links]
        full = [[np.broadcast_to(part, time.shape) for part in row] for row in rows]
        orders.append(np.moveaxis(np.array(full, dtype=float), -1, 0))
    omega, epsilon = speed[:, None, None], second[:, None, None]
    return orders[0], orders[1] * omega, orders[2] * omega**2 + orders[1] * epsilon


def joint_forces(scene: Scene, position: Array, acceleration: Array) -> tuple[dict[str, Array], Array]:
    """Force on each joint's first body (n, 2) and the drive's torque (n,); gravity is the only load."""
    bodies = {body.name: number for number, body in enumerate(scene.bodies)}
    straight = {b.name for b in scene.bodies if b.inertia is None}
    straight |= {joint.body for joint in scene.sliders if joint.host == GROUND}
    samples = len(position)

    def arm(body: str, local: tuple[float, float]) -> Array:
        if body == GROUND:
            return np.broadcast_to(np.array(local), (samples, 2))
        c, s = np.cos(position[:, bodies[body], 2]), np.sin(position[:, bodies[body], 2])
        return np.stack([c * local[0] - s * local[1], s * local[0] + c * local[1]], axis=-1)

    def column(pairs: list[tuple[str, float]], force: Array, at: Array) -> Array:
        result = np.zeros((samples, 3 * len(bodies)))
        for body, sign in pairs:
            if body != GROUND:
                first = 3 * bodies[body]
                x, y = (at - position[:, bodies[body], :2]).T
                result[:, first : first + 2] += sign * force
                result[:, first + 2] += sign * (x * force[:, 1] - y * force[:, 0])
        return result

    unknown: list[tuple[str, Array, Array]] = []
    for joint in (*scene.pins, *scene.sliders, *scene.slots):
        first, anchor = (joint.first, joint.first_anchor) if hasattr(joint, "first") else (joint.body, joint.anchor)
        second = joint.second if hasattr(joint, "second") else joint.host
        at = arm(first, anchor) + (0.0 if first == GROUND else position[:, bodies[first], :2])
        if hasattr(joint, "along"):
            along = arm(second, joint.along)
            directions = [np.stack([-along[:, 1], along[:, 0]], axis=-1)]
        else:
            directions = [np.tile(unit, (samples, 1)) for unit in np.eye(2)]
        unknown += [(joint.name, d, column([(first, 1.0), (second, -1.0)], d, at)) for d in directions]
        if joint in scene.sliders and second != GROUND:  # a prismatic joint also passes on a moment
            moment = np.zeros((samples, 3 * len(bodies)))
            moment[:, 3 * bodies[first] + 2], moment[:, 3 * bodies[second] + 2] = 1.0, -1.0
            unknown.append((joint.name, np.zeros((samples, 2)), moment))
    drive = np.zeros((samples, 3 * len(bodies)))
    drive[:, 3 * bodies[scene.crank] + 2] = 1.0
    weights = np.array([(b.mass, b.mass, b.inertia or 0.0) for b in scene.bodies])
    wanted = ((acceleration - np.array([*scene.gravity, 0.0])) * weights).reshape(samples, -1)
    rows = [3 * n + k for name, n in bodies.items() for k in range(3) if k < 2 or name not in straight]
    matrix = np.stack([*(part for _, _, part in unknown), drive], axis=-1)[:, rows]
    solved = np.linalg.solve(matrix, wanted[:, rows, None])[..., 0]
    forces: dict[str, Array] = {}
    for number, (name, direction, _) in enumerate(unknown):
        forces[name] = forces.get(name, 0.0) + solved[:, number, None] * direction
    return forces, solved[:, -1]
