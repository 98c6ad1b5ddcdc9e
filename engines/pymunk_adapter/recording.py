"""What is looked at during a part of a run, and how it becomes the history of the scene's own bodies.

From sample to sample there are ``ratio`` steps, an odd number, so that passes of different ratio share the samples as
well as the middles between them. After a step pymunk holds positions of tₙ and velocities of tₙ + h/2: velocities
therefore live on the middles, and the acceleration at a sample is (v⁺ − v⁻)/h across it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from engines.contract import History, Origin, Signal
from engines.mechanics.states import across
from engines.pymunk_adapter.layout import PartLayout
from engines.pymunk_adapter.stepping import LOADS, LOOK
from engines.scene import Channel
from engines.stepping.intervals import Interval

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]


@dataclass(frozen=True)
class Clock:
    """The instants of a part of a run that are looked at; numbers count the engine's steps since the part's start.

    ``last``: no other part follows, whose start would be this one's end. ``lead`` counts samples.
    """

    part: Interval
    ratio: int
    last: bool
    centred: bool
    lead: int

    @property
    def fine(self) -> float:
        """The engine's step, s."""
        return self.part.step / self.ratio

    @property
    def steps(self) -> int:
        """Number of the engine's steps."""
        return self.part.samples * self.ratio

    @property
    def samples(self) -> Numbers:
        """Steps after which positions are read; a newcomer reads none before the first."""
        return np.arange(0 if self.centred else 1, self.part.samples + (self.last or not self.centred)) * self.ratio

    @property
    def middles(self) -> Numbers:
        """Steps after which velocities are read; those of the first step are given."""
        if not self.centred:
            return self.samples
        return np.arange(1 if self.part.start == 0.0 else 0, self.part.samples) * self.ratio + (self.ratio - 1) // 2

    @property
    def loaded(self) -> Numbers:
        """Steps after which forces and accelerations are read: not at a start or a jump, nor for ``lead`` more.

        The first impulses answer to the velocities that were given, or to those before the jump.
        """
        return self.samples[self.lead if self.centred else 0 :]

    def marks(self, channels: frozenset[Channel]) -> NDArray[np.uint8]:
        """What is read after each step for some channels, the part's start first."""
        result = np.zeros(self.steps + 1, dtype=np.uint8)
        seen = {
            Channel.POSITION: self.samples,
            Channel.VELOCITY: self.middles,
            Channel.ACCELERATION: np.concatenate([self.loaded - 1, self.loaded]),
        }
        for channel, steps in seen.items():
            if channel in channels:
                result[steps] = LOOK
        if channels & {Channel.TORQUE, Channel.JOINT_FORCE}:
            result[self.loaded] |= LOADS
        return result

    def times(self, steps: Numbers, ahead: float | Array = 0.0) -> Array:
        """Times of the states after steps, s; ``ahead`` by a share of a step."""
        return np.asarray(self.part.start + self.fine * (steps + ahead))


@dataclass(frozen=True)
class Recording:
    """All that was read in a part of a run for some channels.

    ``seen`` (looks, parts, 2, 3) are the parts' positions and rates, ``torque`` (loads,) is the drive's, ``forces``
    (loads,) are magnitudes by joint of the scene.
    """

    clock: Clock
    layout: PartLayout
    channels: frozenset[Channel]
    seen: Array
    torque: Array
    forces: Mapping[str, Array]

    def history(self) -> History:
        """The requested history, for the bodies of the original scene."""
        clock, asked = self.clock, self.channels
        half, loaded = 0.5 if clock.centred else 0.0, clock.times(clock.loaded)
        position = velocity = acceleration = None
        if Channel.POSITION in asked:
            position = Signal(clock.times(clock.samples), carried_position(self.layout, self._at(clock.samples)[0]))
        if Channel.VELOCITY in asked:
            rates = carried_velocity(self.layout, *self._at(clock.middles), half * clock.fine)
            velocity = Signal(clock.times(clock.middles, half), rates)
        if Channel.ACCELERATION in asked:
            state, late = self._at(clock.loaded)
            early = self._at(clock.loaded - 1)[1]
            change = carried_velocity(self.layout, state, late, half * clock.fine)
            change -= carried_velocity(self.layout, state, early, -half * clock.fine)
            acceleration = Signal(loaded, change / clock.fine)
        origin = Origin.PARTLY if self.layout.flywheel else Origin.READ
        torque = Signal(loaded, self.torque, origin) if Channel.TORQUE in asked else None
        forces = {name: Signal(loaded, values) for name, values in self.forces.items()}
        return History(position, velocity, acceleration, torque, forces)

    @cached_property
    def _looked(self) -> Numbers:
        return np.flatnonzero(self.clock.marks(self.channels) & LOOK)

    def _at(self, steps: Numbers) -> tuple[Array, Array]:
        """Positions and rates of the parts after steps."""
        seen = self.seen[np.searchsorted(self._looked, steps)]
        return seen[:, :, 0], seen[:, :, 1]


def _arms(layout: PartLayout, angle: Array) -> Array:
    """From the carriers' centres to the bodies' mass centres, (n, bodies, 2), at the carriers' angles (n, bodies)."""
    offsets = -np.array([part.offset for part in layout.parts[: layout.carried]])
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * offsets[:, 0] - s * offsets[:, 1], s * offsets[:, 0] + c * offsets[:, 1]], axis=-1)


def carried_position(layout: PartLayout, state: Array) -> Array:
    """Positions of the mass centres, (n, bodies, 3), from those of all parts."""
    result = state[:, : layout.carried].copy()
    result[..., :2] += _arms(layout, result[..., 2])
    return result


def carried_velocity(layout: PartLayout, state: Array, rates: Array, ahead: float) -> Array:
    """Velocities of the mass centres ``ahead`` seconds from the positions of ``state``, (n, bodies, 3)."""
    result = rates[:, : layout.carried].copy()
    turn_rate = result[..., 2]
    result[..., :2] += turn_rate[..., None] * across(_arms(layout, state[:, : layout.carried, 2] + ahead * turn_rate))
    return result
