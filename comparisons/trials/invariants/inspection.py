"""One observed motion and what its joints' equations say of it: corrections, assembly modes, forces, sharp passages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import takewhile

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.description.law import FULL_TURN
from analytic.numerics.arrays import Array, Booleans
from comparisons.trials.invariants.corrections import LEVELS, AssurGroups, Findings, findings
from comparisons.trials.judging.signal_errors import FAINT_FORCE
from comparisons.trials.observed_motion import POINTS, ObservedMotion, resample_piecewise
from engines.contract import Signal
from engines.mechanics.joints import JointEquations, scene_size
from engines.mechanics.states import driven, start_coordinate, start_motion
from engines.scene import Channel, Prescribed

# A determinant that changes by this share of itself from sample to sample leaves a peak between them unseen; so many
# samples on either side are as uncertain.
SHARP, REACH = 0.3, 2.0
BESIDE_ANGLE, BESIDE_SAMPLES = 0.05, 5.0  # rad of a change point, and samples of it
# A curve over a change point: its degree, how far it goes to either side, in widths of what it bridges, and what it
# may miss of the samples it goes through, over their peak.
DEGREE, FAR, MISSED = 8, 4.0, 1e-4
MOST_RELAXATION = 0.3  # relaxation times between samples
STANDSTILL = 1e-12  # of the peak kinetic energy: below it there is no reliable rate of damping
COARSE_ANGLE = 0.5  # rad of crank between samples: a dozen of a turn show its energy, not the work done between them
LEAST_DETERMINANT = 1e-12  # a determinant below it has no sign
TINY = float(np.finfo(float).tiny)
MOST_LENGTH_RATIO = 4.0  # times as long as its neighbour a piece of a law may be


@dataclass(frozen=True)
class Inspection:
    """One observed motion with its joints' equations evaluated once on each clock of its channels."""

    motion: ObservedMotion
    changes: Mapping[frozenset[str], tuple[float, ...]] = field(default_factory=dict)  # by group, rad

    @cached_property
    def groups(self) -> AssurGroups:
        """The scene's Assur groups; lengths in their equations are over the scene's size."""
        return AssurGroups(JointEquations(self.motion.scene, scene_size(self.motion.scene)))

    @cached_property
    def start(self) -> tuple[float, float, float]:
        """φ, rad or m, its speed and its acceleration in the start state."""
        scene = self.motion.scene
        angle, speed, acceleration = (float(value[0]) for value in driven(scene, *start_motion(scene)))
        return angle, speed, acceleration

    @cached_property
    def radian(self) -> float:
        """What counts as a radian of φ: 1 rad or, for a linear drive, the scene's size, m."""
        return scene_size(self.motion.scene) if self.motion.is_linear else 1.0

    @cached_property
    def _findings(self) -> dict[bytes, Findings]:
        """The findings by the bytes of each clock, up to the highest derivative that has this clock."""
        recorded = list(takewhile(self.motion.has, LEVELS))
        clocks = {(time := self.motion.signal(c).time).tobytes(): (time, order) for order, c in enumerate(recorded)}
        return {key: findings(self.motion, self.groups, *clock) for key, clock in clocks.items()}

    def on(self, channel: Channel) -> Findings:
        """The findings at a channel's sample times; raises KeyError for a channel on a clock that no level has."""
        return self._findings[self.motion.signal(channel).time.tobytes()]

    def corrections(self) -> dict[str, Signal]:
        """The largest correction of any body, by level, that fits it to the joints and a prescribed crank, over time.

        Displacements over the scene's size, turns in rad; of velocities and accelerations over their peak in the run.
        """
        result = {}
        for order, channel in enumerate(LEVELS):
            outcome = self.on(channel)
            scale = float(np.max(outcome.moving[:, order])) if order else 1.0
            result[channel.value] = Signal(outcome.time, outcome.lacking[:, order] / (scale or 1.0))
        return result

    def assembly_mode(self) -> Signal:
        """How deep any group is in the wrong assembly mode, over its largest determinant, at the positions' times."""
        result = self.on(Channel.POSITION)
        depth = np.maximum(-result.determinants * self._start_modes() * self._mode_signs(result.time), 0.0)
        return Signal(result.time, np.max(depth / np.max(np.abs(result.determinants), axis=0), axis=1))

    def _start_modes(self) -> Array:
        """Sign of every group's determinant in the start state; of one that starts at a change point, soon after."""
        equations = self.groups.equations
        first = self.groups.determinants(equations.jacobian(equations.arms(equations.start())))
        seen = np.concatenate([first, self.on(Channel.POSITION).determinants])
        values = np.argmax(np.abs(seen) > LEAST_DETERMINANT, axis=0)
        return np.asarray(np.sign(np.take_along_axis(seen, values[None], axis=0)[0]))

    @cached_property
    def _group_changes(self) -> list[tuple[int, float]]:
        """The change points of all groups: the group's number among the determinants, and φ, rad."""
        names = list(self.groups.equations.index)
        return [
            (number, change)
            for number, bodies in enumerate(self.groups.members, start=1)
            for change in self.changes.get(frozenset(bodies) & frozenset(names), ())
        ]

    def _mode_signs(self, time: Array) -> Array:
        """-1 where a group has passed an odd number of its change points since the start, else 1; (n, groups)."""
        angle = self.motion.crank(Channel.POSITION, time)
        start = start_coordinate(self.motion.scene) if self.changes else 0.0
        result = np.ones((len(time), 1 + len(self.groups.blocks)))
        for number, change in self._group_changes:
            turned = np.floor((angle - change) / FULL_TURN) - np.floor((start - change) / FULL_TURN)
            result[:, number] *= np.where(turned % 2 == 0, 1.0, -1.0)
        return result

    def beside_changes(self, time: Array) -> Booleans:
        """Where a group is at its change point or a few samples from it, (n, groups): it moves on smoothly there.

        The determinant is small there, and corrections, which are divided by it, are mere rounding.
        """
        angle = self.motion.crank(Channel.POSITION, time)
        reach = (
            np.maximum(BESIDE_ANGLE, BESIDE_SAMPLES * np.abs(np.gradient(angle))) if len(angle) > 1 else BESIDE_ANGLE
        )
        result = np.zeros((len(time), 1 + len(self.groups.blocks)), dtype=bool)
        for number, change in self._group_changes:
            away = np.abs((angle - change + 0.5 * FULL_TURN) % FULL_TURN - 0.5 * FULL_TURN)
            result[:, number] |= away <= reach
        return result

    def bridge_changes(self, signal: Signal, jumps: tuple[float, ...]) -> Signal:
        """A signal (n,) that has beside change points the values of a smooth curve through its samples around them.

        They are nan where there are too few samples around, a jump of the acceleration, or no such curve.
        """
        beside, values = np.asarray(self.beside_changes(signal.time).any(axis=1)), signal.values.copy()
        edges = np.flatnonzero(np.diff(np.concatenate([[False], beside, [False]]).astype(int)))
        for first, behind in edges.reshape(-1, 2):
            values[first:behind] = _bridge(signal, beside, slice(first, behind), jumps)
        return Signal(signal.time, values)

    def torque_required(self) -> Signal:
        """Drive torque, N m, or force, N, by the power that the motion and its loads take, on the acceleration's clock.

        By virtual power, so that it is defined at standstill too; of a prescribed crank for the acceleration it ought
        to have. Times outside those of the claimed torque, against which it is held, are left out.
        """
        result, clock = self.on(Channel.ACCELERATION), self.motion.signal(Channel.TORQUE).time
        within = (result.time >= clock[0]) & (result.time <= clock[-1])
        return Signal(result.time[within], result.torque[within])

    def force_balance(self) -> Signal:
        """The largest difference of any joint's force from what balances the bodies, over its peak, over time."""
        result, claimed = self.on(Channel.ACCELERATION), self.motion.history.joint_force
        joints = [*self.motion.scene.pins, *self.motion.scene.guided]
        clocks = [claimed[joint.name].time for joint in joints]
        within = result.time >= max(clock[0] for clock in clocks)
        within &= result.time <= min(clock[-1] for clock in clocks)
        time = result.time[within]
        peaks = np.nanmax(np.hypot(result.forces[..., 0], result.forces[..., 1]), axis=0, initial=0.0)
        scales = np.maximum(peaks, FAINT_FORCE * np.max(peaks)) + TINY
        worst = np.zeros(len(time))
        for number, joint in enumerate(joints):
            force = resample_piecewise(claimed[joint.name], time, self.motion.jumps)
            difference = force - result.forces[within, number]
            worst = np.maximum(worst, np.hypot(*difference.T) / scales[number])
        return Signal(time, worst)

    def unresolved_intervals(self, time: Array) -> Booleans:
        """Which intervals of a clock, (n - 1,), the motion changes in faster than its samples can show.

        Beside a dead position a group's determinant changes by much of itself from sample to sample; a piece of the
        prescribed motion may be over within a few samples; a turn may have no more than a few; and dampers may take a
        good part of a speed between two.
        """
        result = np.abs(np.diff(self.motion.crank(Channel.POSITION, time))) > COARSE_ANGLE * self.radian
        result |= np.diff(time) * self.relaxation_rate(time)[1:] > MOST_RELAXATION
        for start, end in self._undersampled_intervals(time):
            result |= (time[:-1] <= end) & (time[1:] >= start)
        return np.asarray(result)

    def relaxation_rate(self, time: Array) -> Array:
        """Rate, 1/s, (n,), at which dampers take an error of the speed: half their power over kinetic energy."""
        power = self.motion.dissipation(time)
        if not power.any():
            return power
        kinetic = self.motion.kinetic_energy(time)
        moving = kinetic > STANDSTILL * np.max(kinetic)
        if not moving.any():  # nothing has a mass, nor then a speed to lose
            return np.zeros(len(time))
        return np.asarray(np.interp(time, time[moving], 0.5 * power[moving] / kinetic[moving]))

    def _undersampled_intervals(self, time: Array) -> Iterator[tuple[float, float]]:
        """Yield start and end, s, of intervals with too few samples.

        Near dead positions a determinant changes too much from one sample to the next; pieces of the prescribed motion
        may have too few instants of ``time``.
        """
        result = self.on(Channel.POSITION)
        size = np.abs(result.determinants)
        sharp = np.abs(np.diff(result.determinants, axis=0)) > SHARP * np.minimum(size[1:], size[:-1])
        sharp &= ~self.beside_changes(result.time)[1:]
        for step in np.flatnonzero(sharp.any(axis=1)):
            reach = REACH * (result.time[step + 1] - result.time[step])
            yield result.time[step] - reach, result.time[step + 1] + reach
        drive = self.motion.scene.drive
        for start, end in _stretches(drive.motion) if isinstance(drive, Prescribed) else ():
            if np.count_nonzero((time >= start) & (time <= end)) < 2 * POINTS:
                yield start, end


def _bridge(signal: Signal, beside: Booleans, gap: slice, jumps: tuple[float, ...]) -> Array:
    """Values for a ``gap`` of a signal, by a polynomial through the samples around that are not ``beside``.

    Nan without one. There is none over a jump, or where it misses the samples.
    """
    time, width = signal.time, signal.time[gap.stop - 1] - signal.time[gap.start]
    low, high = time[gap.start] - FAR * width, time[gap.stop - 1] + FAR * width
    around = (time >= low) & (time <= high) & ~beside
    sides = np.count_nonzero(around[: gap.start]), np.count_nonzero(around[gap.stop :])
    nowhere = np.full(gap.stop - gap.start, np.nan)
    if min(sides) < DEGREE or any(low <= jump <= high for jump in jumps):
        return nowhere
    curve = np.polynomial.Chebyshev.fit(time[around], signal.values[around], DEGREE, domain=(low, high))
    missed = np.max(np.abs(curve(time[around]) - signal.values[around]))
    return np.asarray(curve(time[gap])) if missed <= MISSED * np.nanmax(np.abs(signal.values)) else nowhere


def _stretches(motion: CrankMotion) -> Iterator[tuple[float, float]]:
    """Yield start and end, s, of each smooth stretch of a motion; pieces of similar length without a jump are joined.

    A law or a spline is made of many such, and samples tell it from all of them.
    """
    first, *others = motion.segments
    start, end, length = first.start, first.end, first.end - first.start
    for segment in others:
        before, length = length, segment.end - segment.start
        if segment.start in motion.jumps or max(before, length) > MOST_LENGTH_RATIO * min(before, length):
            yield start, end
            start = segment.start
        end = segment.end
    yield start, end
