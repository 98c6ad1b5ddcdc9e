"""Reading a motion back: energies, points and powers from the history, never from an engine's own word for them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import DriverKind, Vector
from comparisons.observation.interpolation import resample_piecewise
from engines.contract import History, Origin, Signal, weakest
from engines.mechanics.driver import driven
from engines.mechanics.joints import JointEquations, applied_loads, potential_energy, without_potential
from engines.mechanics.states import (
    Pose,
    body_masses,
    body_numbers,
    point_acceleration,
    point_velocity,
    pose_of,
    with_ground,
)
from engines.scene import Channel, Free, Scene

Array = NDArray[np.float64]

DENSE = 48  # samples of a turn that can be read between


@dataclass(frozen=True)
class ObservedMotion:
    """The history of one run beside the scene that made it; arrays are (samples, ...) on the given clock.

    Bodies are in the scene's order, the ground behind them.
    """

    scene: Scene
    history: History

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The place of every body, by name."""
        return body_numbers(self.scene)

    @cached_property
    def masses(self) -> Array:
        """(bodies, 3): mass, mass and inertia, the weights of (x, y, θ)."""
        return np.asarray(body_masses(self.scene), dtype=float)

    def signal(self, channel: Channel) -> Signal:
        """A channel's signal; the channel has to be among those recorded. A free crank's torque is given."""
        if channel is Channel.TORQUE and isinstance(self.scene.drive, Free):
            time = self.signal(Channel.ACCELERATION).time
            return Signal(time, self.scene.drive.torque_at(time))
        signal = getattr(self.history, channel.value)
        assert isinstance(signal, Signal), f"channel {channel} was not recorded"
        return signal

    def has(self, channel: Channel) -> bool:
        """Whether a channel was recorded; a free crank's torque is given."""
        if channel is Channel.JOINT_FORCE:
            return bool(self.history.joint_force)
        if channel is Channel.TORQUE and isinstance(self.scene.drive, Free):
            return self.has(Channel.ACCELERATION)
        return getattr(self.history, channel.value) is not None

    def origin(self, channels: Iterable[Channel]) -> Origin:
        """The weakest origin of these channels."""
        signals = [s for c in channels for s in (self.history.joint_force.values() if c is Channel.JOINT_FORCE
                   else (self.signal(c),))]  # fmt: skip
        return weakest(signal.origin for signal in signals)

    @cached_property
    def is_linear(self) -> bool:
        """Whether the driver is pushed along a line."""
        return self.scene.driver_kind is not DriverKind.CRANK

    @cached_property
    def last_turn(self) -> slice | None:
        """The position's samples of the crank's last full turn in one direction.

        None without one, or with fewer than DENSE samples, between which interpolation would add an error that is not
        the engine's.
        """
        if self.is_linear:
            return None
        angle = self.crank(Channel.POSITION, self.signal(Channel.POSITION).time)
        inside = np.flatnonzero(np.abs(angle - angle[-1]) >= FULL_TURN)
        if not len(inside):
            return None
        turn = slice(int(inside[-1]), len(angle))
        ways = np.diff(angle[turn])
        return turn if len(ways) >= DENSE and (np.all(ways > 0.0) or np.all(ways < 0.0)) else None

    def on_clock(self, channel: Channel, time: Array) -> Array:
        """A channel's values at other times, interpolated to sixth order between its samples."""
        return resample_piecewise(self.signal(channel), time, self._jumps)

    @property
    def _jumps(self) -> tuple[float, ...]:
        """Where the prescribed acceleration jumps, s."""
        drive = self.scene.drive
        return () if isinstance(drive, Free) else drive.motion.jumps

    def bodies(self, channel: Channel, time: Array) -> Array:
        """Position, velocity or acceleration of every body, (n, bodies, 3)."""
        return np.asarray(with_ground(self.on_clock(channel, time)), dtype=float)

    def pose(self, time: Array) -> Pose:
        """Poses of all bodies and the ground at times (n,), s."""
        return pose_of(self.bodies(Channel.POSITION, time))

    def crank(self, channel: Channel, time: Array) -> Array:
        """φ, rad or m, or its speed or acceleration, by the engine's own account."""
        signal = self.signal(channel)
        if self.is_linear:
            levels = (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION)
            order = levels.index(channel)
            motion = (self.bodies(level, time) for level in levels[: order + 1])
            return np.asarray(driven(self.scene, *motion)[order], dtype=float)
        column = Signal(signal.time, signal.values[:, self.numbers[self.scene.crank], 2])
        return resample_piecewise(column, time, self._jumps)

    def kinetic_energy(self, time: Array) -> Array:
        """T = Σ ½ m v² + ½ J ω², J."""
        velocity = self.bodies(Channel.VELOCITY, time)
        return np.asarray(0.5 * np.einsum("nbk,bk->n", velocity**2, self.masses))

    def potential_energy(self, time: Array) -> Array:
        """Energy of gravity and springs, J; that of gravity is 0 at the ground's origin."""
        return np.asarray(potential_energy(self.scene, self.pose(time)), dtype=float)

    def load_power(self, time: Array) -> Array:
        """Power of forces at points, torques on links, dampers and dashpots, W: of the loads without a potential."""
        return self._power(without_potential(self.scene), time)

    def dissipation(self, time: Array) -> Array:
        """Power that dampers and dashpots take, W; never negative."""
        damped = replace(without_potential(self.scene), forces=(), torques=())
        return np.maximum(-self._power(damped, time), 0.0)

    def _power(self, scene: Scene, time: Array) -> Array:
        """Power (n,), W, of the loads of a scene."""
        if not (scene.forces or scene.torques or scene.dampers or scene.springs):
            return np.zeros(len(time))
        rate = self.bodies(Channel.VELOCITY, time)
        return np.asarray(np.einsum("nbk,nbk->n", applied_loads(scene, self.pose(time), rate), rate))

    def joint_gaps(self, time: Array) -> dict[str, Array]:
        """How far every joint is open, m: pins apart, sliders and slot pins off their line."""
        equations, pose = JointEquations(self.scene, unit=1.0), self.pose(time)
        openings = equations.openings(equations.residual(pose, equations.arms(pose)))
        return {name: np.asarray(openings[:, number]) for number, name in enumerate(equations.joints)}

    def point(self, body: str, anchor: Vector, time: Array, order: int = 0) -> Array:
        """A point fixed in a body, (n, 2), m; its velocity (``order`` 1) or acceleration (2)."""
        number, pose = self.numbers[body], self.pose(time)
        if order == 0:
            return np.asarray(pose.point(number, anchor))
        arm, rate = pose.arm(number, anchor), self.bodies(Channel.VELOCITY, time)[:, number]
        if order == 1:
            return np.asarray(point_velocity(arm, rate))
        return np.asarray(point_acceleration(arm, rate, self.bodies(Channel.ACCELERATION, time)[:, number]))
