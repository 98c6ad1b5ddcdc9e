"""Reading a motion back: energies, gaps and powers from the raw history, never from an engine's own word for them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Vector
from comparisons.observation.interpolation import resample
from engines.contract import History, Signal
from engines.scene import Channel, Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ObservedMotion:
    """The history of one run beside the scene that made it; arrays are (samples, ...) on the clock asked for."""

    scene: Scene
    history: History

    @cached_property
    def _index(self) -> dict[str, int]:
        return {body.name: number for number, body in enumerate(self.scene.bodies)}

    @cached_property
    def masses(self) -> Array:
        """(bodies, 3): mass, mass and inertia, the weights of (x, y, θ)."""
        return np.array([(body.mass, body.mass, body.inertia or 0.0) for body in self.scene.bodies])

    def signal(self, channel: Channel) -> Signal:
        """A channel's signal; the channel has to be among those asked for."""
        signal = getattr(self.history, channel.value)
        assert isinstance(signal, Signal), f"channel {channel} was not recorded"
        return signal

    def on_clock(self, channel: Channel, time: Array) -> Array:
        """A channel's values at other times, interpolated to sixth order between its samples."""
        return resample(self.signal(channel), time)

    def crank(self, channel: Channel, time: Array) -> Array:
        """Crank angle, speed or acceleration by the engine's own account."""
        signal = self.signal(channel)
        column = Signal(signal.time, signal.values[:, self._index[self.scene.crank], 2])
        return resample(column, time)

    def kinetic_energy(self) -> Signal:
        """T = Σ ½ m v² + ½ J ω², J, on the velocity's clock."""
        velocity = self.signal(Channel.VELOCITY)
        return Signal(velocity.time, 0.5 * np.einsum("nbk,bk->n", velocity.values**2, self.masses))

    def kinetic_power(self, time: Array) -> Array:
        """dT/dt = Σ m v·a + J ω α, W."""
        velocity, acceleration = self.on_clock(Channel.VELOCITY, time), self.on_clock(Channel.ACCELERATION, time)
        return np.asarray(np.einsum("nbk,bk->n", velocity * acceleration, self.masses))

    def arm(self, body: str, anchor: Vector, time: Array) -> tuple[Array, Array]:
        """Vector from the mass centre to an anchor, ground frame."""
        angle = self.on_clock(Channel.POSITION, time)[:, self._index[body], 2]
        c, s = np.cos(angle), np.sin(angle)
        return c * anchor[0] - s * anchor[1], s * anchor[0] + c * anchor[1]

    def point(self, body: str, anchor: Vector, time: Array) -> Array:
        """Position of an anchor, (n, 2), m."""
        if body == GROUND:
            return np.broadcast_to(np.asarray(anchor), (len(time), 2))
        place = self.on_clock(Channel.POSITION, time)[:, self._index[body], :2]
        if anchor == (0.0, 0.0):
            return place
        return place + np.stack(self.arm(body, anchor, time), axis=-1)

    def point_velocity(self, body: str, anchor: Vector, time: Array) -> Array:
        """Velocity of an anchor, (n, 2), m/s."""
        if body == GROUND:
            return np.zeros((len(time), 2))
        rate = self.on_clock(Channel.VELOCITY, time)[:, self._index[body]]
        if anchor == (0.0, 0.0):
            return rate[:, :2]
        x, y = self.arm(body, anchor, time)
        return rate[:, :2] + rate[:, 2:] * np.stack([-y, x], axis=-1)

    def point_acceleration(self, body: str, anchor: Vector, time: Array) -> Array:
        """Acceleration of an anchor, (n, 2), m/s²."""
        second = self.on_clock(Channel.ACCELERATION, time)[:, self._index[body]]
        if anchor == (0.0, 0.0):
            return second[:, :2]
        turn = self.on_clock(Channel.VELOCITY, time)[:, self._index[body], 2:]
        x, y = self.arm(body, anchor, time)
        across, along = np.stack([-y, x], axis=-1), np.stack([x, y], axis=-1)
        return second[:, :2] + second[:, 2:] * across - turn**2 * along

    def angle(self, body: str, time: Array) -> Array:
        """Angle of a body, rad; 0 for the ground."""
        if body == GROUND:
            return np.zeros(len(time))
        return self.on_clock(Channel.POSITION, time)[:, self._index[body], 2]

    def turn_rate(self, body: str, time: Array) -> Array:
        """Angular velocity of a body, rad/s; 0 for the ground."""
        if body == GROUND:
            return np.zeros(len(time))
        return self.on_clock(Channel.VELOCITY, time)[:, self._index[body], 2]
