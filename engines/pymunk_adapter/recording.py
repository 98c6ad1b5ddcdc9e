"""What is looked at during a pass, and how it becomes the history of the scene's own bodies.

A pass takes ``ratio`` steps (an odd number) from sample to sample, so that passes of different ratio share both the
sample times and the middles between them. After a step pymunk holds positions of tₙ and velocities of tₙ + h/2: the
velocity signal therefore lives on the middles, and the acceleration at a sample is (v⁺ − v⁻)/h across it.

pymunk tells the magnitude of a constraint's impulse, not its direction. The vectors follow from what the solver did to
the bodies: over one step every part obeys m (v⁺ − v⁻)/h = load + Σ joint forces, with the joints' directions at the
positions of that instant, and a linkage whose crank is driven has exactly as many unknown forces as equations. The
solution is the impulses that the solver applied, to rounding.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines.contract import History, Signal
from engines.mechanics.joints import Arms
from engines.mechanics.loads import applied_loads
from engines.mechanics.states import Pose, across, body_masses, pose_of, with_ground
from engines.pymunk_adapter.layout import PartLayout
from engines.scene import Channel

Array = NDArray[np.float64]

# Samples at which joints and crank are watched even where no position is asked for.
WATCHED = 64


# Samples whose joint forces are solved for at once: the equations of a sample take a hundred times their room.
BLOCK = 10_000


@dataclass(frozen=True)
class Clock:
    """Samples ``start + k·step``, k = 0, 1, …, and the middles between them, ``ratio`` engine steps apart."""

    start: float
    step: float
    sample_count: int
    middle_count: int
    ratio: int

    @property
    def fine(self) -> float:
        """The engine's step, s."""
        return self.step / self.ratio

    @property
    def samples(self) -> NDArray[np.intp]:
        """Numbers of the engine's steps that end at a sample."""
        return np.arange(self.sample_count) * self.ratio

    @property
    def middles(self) -> NDArray[np.intp]:
        """Numbers of the engine's steps after which it holds the velocity of the middle between two samples."""
        return np.arange(self.middle_count) * self.ratio + (self.ratio - 1) // 2

    def sample_times(self) -> Array:
        """Times of the samples, s."""
        return self.start + self.step * np.arange(self.sample_count, dtype=np.float64)

    def middle_times(self) -> Array:
        """Times of the middles, s."""
        return self.start + self.step * (np.arange(self.middle_count, dtype=np.float64) + 0.5)


def looks(clock: Clock, channels: frozenset[Channel]) -> NDArray[np.intp]:
    """Numbers of the engine's steps after which it has to be looked at, increasing."""
    samples = clock.samples
    wanted = [samples[:: max(1, len(samples) // WATCHED)], samples[-1:]]
    if channels & {Channel.POSITION, Channel.TORQUE}:
        wanted.append(samples)
    if channels & {Channel.ACCELERATION, Channel.JOINT_FORCE}:
        wanted += [samples, samples - 1]
    if Channel.VELOCITY in channels:
        wanted.append(clock.middles)
    return np.unique(np.concatenate(wanted))


def marks(steps: NDArray[np.intp], count: int) -> list[int]:
    """1 for each of ``count`` steps whose number is among ``steps``, else 0."""
    result = np.zeros(count, dtype=np.intp)
    result[steps] = 1
    return [int(mark) for mark in result]


@dataclass(frozen=True)
class Recording:
    """All looks of a pass at one interval.

    ``steps`` (n,) are the engine's steps they followed, ``seen`` (n, parts, 2, 3) the parts' positions and rates,
    ``torque`` (n,) the drive's.
    """

    clock: Clock
    steps: NDArray[np.intp]
    seen: Array
    torque: Array

    def _at(self, steps: NDArray[np.intp]) -> Array:
        return self.seen[np.searchsorted(self.steps, steps)]

    @property
    def times(self) -> Array:
        """Times of the looks, s."""
        return self.clock.start + self.clock.fine * self.steps.astype(np.float64)

    @property
    def state(self) -> Array:
        """Positions of the parts, (n, parts, 3): x, y, θ."""
        return self.seen[:, :, 0]

    def instant(self, sample: int) -> Array:
        """Positions, rates and accelerations of the parts at a sample that was looked at both sides, (3, parts, 3)."""
        step = self.clock.samples[sample]
        before, after = self._at(np.array([step - 1, step]))
        return np.array(
            [after[:, 0], 0.5 * (before[:, 1] + after[:, 1]), (after[:, 1] - before[:, 1]) / self.clock.fine]
        )

    def history(self, channels: frozenset[Channel], layout: PartLayout) -> History:
        """The channels asked for, for the bodies of the scene that was cut."""
        samples, times = self.clock.samples, self.clock.sample_times()
        position = velocity = acceleration = torque = None
        forces: Mapping[str, Signal] = {}
        if Channel.POSITION in channels:
            position = Signal(times, _carried_position(layout, self._at(samples)[:, :, 0]))
        if Channel.VELOCITY in channels:
            seen = self._at(self.clock.middles)
            ahead = 0.5 * self.clock.fine
            velocity = Signal(self.clock.middle_times(), _carried_velocity(layout, *_split(seen), ahead))
        if channels & {Channel.ACCELERATION, Channel.JOINT_FORCE}:
            before, after = self._at(samples - 1)[:, :, 1], self._at(samples)
            if Channel.ACCELERATION in channels:
                acceleration = Signal(times, self._acceleration(layout, before, after))
            if Channel.JOINT_FORCE in channels:
                state, rates = _split(after)
                middle, change = 0.5 * (before + rates), (rates - before) / self.clock.fine
                reactions = joint_forces(layout, state, middle, change)
                forces = {name: Signal(times, values) for name, values in reactions.items()}
        if Channel.TORQUE in channels:
            torque = Signal(times, self.torque[np.searchsorted(self.steps, samples)])
        return History(position, velocity, acceleration, torque, forces)

    def _acceleration(self, layout: PartLayout, before: Array, after: Array) -> Array:
        state, rates = _split(after)
        half = 0.5 * self.clock.fine
        late = _carried_velocity(layout, state, rates, half)
        return (late - _carried_velocity(layout, state, before, -half)) / self.clock.fine


def _split(seen: Array) -> tuple[Array, Array]:
    return seen[:, :, 0], seen[:, :, 1]


def _arms(layout: PartLayout, angle: Array) -> Array:
    """From the carriers' centres to the bodies' mass centres, (n, bodies, 2), at the carriers' angles (n, bodies)."""
    offsets = -np.array([part.offset for part in layout.parts[: layout.carried]])
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * offsets[:, 0] - s * offsets[:, 1], s * offsets[:, 0] + c * offsets[:, 1]], axis=-1)


def _carried_position(layout: PartLayout, state: Array) -> Array:
    result = state[:, : layout.carried].copy()
    result[..., :2] += _arms(layout, result[..., 2])
    return result


def _carried_velocity(layout: PartLayout, state: Array, rates: Array, ahead: float) -> Array:
    """Velocities of the mass centres ``ahead`` seconds from the positions of ``state``, (n, bodies, 3)."""
    result = rates[:, : layout.carried].copy()
    turn_rate = result[..., 2]
    result[..., :2] += turn_rate[..., None] * across(_arms(layout, state[:, : layout.carried, 2] + ahead * turn_rate))
    return result


def gaps(layout: PartLayout, state: Array) -> Array:
    """How far each joint between parts is open, m, (n, joints). ``state`` is (n, parts, 3): x, y, θ."""
    pose, arms = posed(layout, state)
    equations = layout.equations
    return np.asarray(equations.openings(equations.residual(pose, arms)) * equations.unit)


def joint_forces(layout: PartLayout, state: Array, rate: Array, acceleration: Array) -> dict[str, Array]:
    """Force of every joint of the scene on its first body, N, ground frame, (n, 2) by name.

    ``acceleration`` (n, parts, 3) is (v⁺ − v⁻)/h at the instants of ``state``, ``rate`` the velocities there. Under a
    free drive the drive's row comes out as zero.
    """
    blocks = [
        _joint_forces(layout, *(values[start : start + BLOCK] for values in (state, rate, acceleration)))
        for start in range(0, max(1, len(state)), BLOCK)
    ]
    forces, names = np.concatenate(blocks), layout.equations.joints
    return {name: forces[:, number] for number, name in enumerate(names) if name not in layout.inner}


def _joint_forces(layout: PartLayout, state: Array, rate: Array, acceleration: Array) -> Array:
    """The same as one array, (n, joints, 2)."""
    equations = layout.equations
    _, arms = posed(layout, state)
    loads = applied_loads(layout.scene, pose_of(with_ground(state)), with_ground(rate))
    left = equations.generalised(body_masses(layout.scene) * with_ground(acceleration) - loads)
    multipliers = np.linalg.solve(np.swapaxes(equations.jacobian(arms), 1, 2), left[..., None])[..., 0]
    return np.asarray(equations.joint_forces(arms, multipliers))


def posed(layout: PartLayout, state: Array) -> tuple[Pose, Arms]:
    """The parts in the equations' unit, and the joints' vectors."""
    equations = layout.equations
    pose = pose_of(with_ground(state) / equations.metres)
    return pose, equations.arms(pose)
