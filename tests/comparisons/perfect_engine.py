"""A history taken from the closed form itself: what a perfect engine would return, for tests of the judge."""

from __future__ import annotations

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import joint_forces
from analytic.kinematics.mechanism import Mechanism
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.start_state import scene, start_state
from engines.contract import History, Signal
from engines.scene import Channel, Prescribed


def perfect_motion(
    mechanism: Mechanism, motion: CrankMotion, samples: int = 1401, shift: float = 0.0
) -> ObservedMotion:
    """The true motion; ``shift`` moves the velocity's clock against the others, as a leapfrog engine does."""
    time = np.linspace(0.0, motion.duration, samples)
    later = np.clip(time[:-1] + shift * (time[1] - time[0]), 0.0, motion.duration)
    model = scene(mechanism, Prescribed(motion), frozenset(Channel))
    states = [_states(mechanism, motion, clock) for clock in (time, later if shift else time)]
    torque = reduced.drive_torque(mechanism.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time))
    forces = joint_forces(mechanism.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time))
    history = History(
        position=Signal(time, states[0][0]),
        velocity=Signal(later if shift else time, states[1][1]),
        acceleration=Signal(time, states[0][2]),
        torque=Signal(time, torque),
        joint_force={name: Signal(time, force.T) for name, force in forces.items()},
    )
    return ObservedMotion(model, history)


def _states(mechanism: Mechanism, motion: CrankMotion, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and acceleration arrays (n, bodies, 3), bodies sorted by name as in a scene."""
    rows = []
    for t in time:
        sweep = mechanism.sweep(np.asarray(motion.angle(t)))
        state = start_state(sweep, float(motion.speed(t)), float(motion.acceleration(t)))
        rows.append(
            [
                [
                    (*s.position, s.angle),
                    (*s.velocity, s.angular_velocity),
                    (*s.acceleration, s.angular_acceleration),
                ]
                for s in state.values()
            ]
        )
    table = np.array(rows)
    position, velocity, acceleration = table[:, :, 0], table[:, :, 1], table[:, :, 2]
    position[:, :, 2] = np.unwrap(position[:, :, 2], axis=0)
    return position, velocity, acceleration
