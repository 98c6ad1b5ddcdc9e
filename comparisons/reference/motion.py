"""Motions of the driver: what every motion offers, the zero of the output under it, the scene in its start state."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.dynamics.reduced import damping_coefficient, generalised_force, half_inertia_derivative, reduced_inertia
from analytic.kinematics.frames import Pair
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.motion.dead_centres import top_of_turn
from analytic.numerics.refine import highest
from engines.scene import Body, Channel, Drive, Prescribed, Scene
from engines.scene_builder import build_scene

Array = NDArray[np.float64]

INSTANTS: Final = 2001  # at which a motion is looked at as a whole


class Motion(Protocol):
    """A crank motion, prescribed or integrated."""

    @property
    def regime(self) -> str:
        """Name of the regime."""
        ...

    @property
    def duration(self) -> float:
        """Time at which it ends, s; it starts at 0."""
        ...

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        ...

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s."""
        ...

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        ...

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        ...

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s²."""
        ...


# The zero of S: the top dead centre, or the farthest point of a motion whose crank cannot turn fully.


def zero_of_output(mechanism: Mechanism, motion: Motion) -> float:
    """The output's coordinate at which S is 0, m.

    It is that of the top dead centre where the crank can turn fully, else of the farthest point the motion reaches,
    between instants too. Raises LinkproofError where the output of a full turn stands still along its direction.
    """
    top = top_of_turn(mechanism)
    return _farthest_reached(mechanism, motion) if top is None else top


def _farthest_reached(mechanism: Mechanism, motion: Motion) -> float:
    """The largest coordinate, m, of the output over a motion, between instants too."""
    time = np.linspace(0.0, motion.duration, INSTANTS)

    def coordinate(instants: Array) -> Array:
        return mechanism.sweep(motion.angle(instants)).output()[None]

    return float(highest(coordinate, time, coordinate(time))[0][0])


# The bridge from the closed form to the engines: a linkage's start state, and the scene it gives.


def start_state(sweep: Sweep, speed: float, acceleration: float) -> dict[str, Body]:
    """Every link as a body in its state at the sweep's single crank angle.

    The crank's speed ω is in rad/s, its acceleration ε in rad/s².
    """
    return {name: _body_state(sweep, name, speed, acceleration) for name in sweep.linkage.links}


def _body_state(sweep: Sweep, name: str, speed: float, acceleration: float) -> Body:
    """One link as a body in its state."""
    first, second = sweep.rates(name)[2], sweep.accelerations(name)[2]
    position, velocity, bend = (sweep.centre(name, order) for order in range(3))

    def moved(scale: float, vector: Pair, other: float = 0.0, also: Pair = (0.0, 0.0)) -> tuple[float, float]:
        return (float(scale * vector[0] + other * also[0]), float(scale * vector[1] + other * also[1]))

    link = sweep.linkage.links[name]
    return Body(
        name,
        link.mass,
        link.inertia,
        position=moved(1.0, position),
        angle=float(sweep.angles(name)),
        velocity=moved(speed, velocity),
        angular_velocity=float(speed * first),
        acceleration=moved(speed * speed, bend, acceleration, velocity),
        angular_acceleration=float(speed * speed * second + acceleration * first),
    )


def scene(
    mechanism: Mechanism, drive: Drive, channels: Iterable[Channel], *, start_angle: float = 0.0, speed: float = 0.0
) -> Scene:
    """The scene of a mechanism under a drive.

    Under a prescribed motion the start state is the motion's; a free one starts at ``start_angle`` (rad) with crank
    speed ``speed`` (rad/s), its accelerations taken from the equation of motion.
    """
    if isinstance(drive, Prescribed):
        motion = drive.motion
        sweep = mechanism.sweep(np.asarray(motion.angle(0.0)))
        state = start_state(sweep, float(motion.speed(0.0)), float(motion.acceleration(0.0)))
    else:
        sweep = mechanism.sweep(np.asarray(start_angle))
        moment = float(drive.torque_at(0.0)) + generalised_force(sweep) - damping_coefficient(sweep) * speed
        acceleration = (moment - half_inertia_derivative(sweep) * speed**2) / reduced_inertia(sweep)
        state = start_state(sweep, speed, float(acceleration))
    return build_scene(mechanism.linkage, state, drive, frozenset(channels))
