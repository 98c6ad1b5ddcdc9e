"""One observed motion and what its joints' equations say of it: corrections, assembly modes, forces, sharp passages.

Corrections make the motion fit its scene, with its Assur groups: an estimate of its error from itself.

With G = ∂Φ/∂q the residual r of the joints on position, velocity or acceleration level becomes, to first order, an
error of the state: G δ = −r. Near a dead position a joint that is open by little means a link that is off by much, and
δ says so, where the gap itself does not. Each level is taken at the corrected state of the one below it, since a
velocity may fit a wrong position. The forces that the corrected state requires follow from the transposed equations,
Gᵀ λ = M q̈ − Q (E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems, 1989, chapters 3 and 7).

The equations are those of ``engines.mechanics``, which ``direct`` solves too; nothing is shared with the closed form.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import takewhile
from typing import NamedTuple

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, Vector
from analytic.numerics.arrays import Array, Booleans
from comparisons.trials.judging.signal_errors import FAINT_FORCE
from comparisons.trials.observed_motion import POINTS, ObservedMotion, resample_piecewise
from engines.contract import Signal
from engines.mechanics.joints import Arms, JointEquations, applied_loads, scene_size
from engines.mechanics.states import Numbers, Pose, Reals, driven, pose_of, start_coordinate, start_motion
from engines.scene import LEVELS, Channel, Prescribed

EPS, TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)
BLOCK = 4096  # instants whose equations are in memory at a time


class AssurGroup(NamedTuple):
    """The bodies that a group of a linkage places, and the crank angles of its change points, rad in [0, 2π)."""

    bodies: tuple[str, ...]
    changes: tuple[float, ...] = ()


class AssurGroups:
    """The joints' equations in blocks, one for each Assur group: those that place its bodies on bodies placed before.

    ``blocks`` holds the rows and columns of each; rows come in pairs (2, k): the equation is the first one less the
    second, where ``equations.rows`` and more stand for none.
    """

    def __init__(self, equations: JointEquations, groups: Iterable[AssurGroup]) -> None:
        """Take the groups of the equations' linkage in an order in which they can be solved."""
        self.equations = equations
        self._pins = self._pin_points()
        self.blocks: list[tuple[Numbers, Numbers]] = []
        placed = {GROUND, equations.scene.crank} if equations.scene.crank else {GROUND}
        for bodies, _ in groups:
            rows = np.array(self._rows_of(bodies, placed), dtype=np.intp).T
            columns = equations.column[[equations.index[name] for name in bodies]]
            self.blocks.append((rows, np.asarray(columns[columns != equations.size])))
            placed |= {*bodies}

    def _rows_of(self, bodies: tuple[str, ...], placed: set[str]) -> list[tuple[int, int]]:
        """Rows of the joints between these bodies, and between them and ``placed`` bodies, as pairs of numbers.

        The equation is the first row less the second; of no second one the number is ``equations.rows``.
        """
        equations, none = self.equations, self.equations.rows
        rows = []
        for ends in self._pins:
            known = [pin for body, pin in ends if body in placed]
            new = [pin for body, pin in ends if body in bodies]
            seat, others = (known[0], new) if known else (new[0], new[1:]) if new else (none, [])
            for pin in others:
                for first in (equations.x_rows, equations.y_rows):
                    pair = sorted(int(first[number]) if number < none else none for number in (pin, seat))
                    rows.append((pair[0], pair[1]))
        known_bodies = {equations.index[name] for name in placed | {*bodies}}
        new_bodies = {equations.index[name] for name in bodies}
        for row, first_body, second_body in self._constraints():
            if {first_body, second_body} <= known_bodies and {first_body, second_body} & new_bodies:
                rows.append((int(row), none))
        return rows

    def _constraints(self) -> list[tuple[int, int, int]]:
        """Rows of guides, locked turns and a cylinder, each as (row, body, body), all numbers in ``equations``."""
        equations = self.equations
        constraints = [
            *zip(equations.line_rows, equations.body[equations.pins :], equations.host[equations.pins :], strict=True),
            *zip(equations.turn_rows, equations.turn_body, equations.turn_host, strict=True),
        ]
        if equations.scene.cylinder is not None:
            constraints.append((equations.crank_row, *equations.driver.ends))
        return constraints

    def _pin_points(self) -> list[list[tuple[str, int]]]:
        """For every place of pins its bodies, each with the number of its pin: any of them can be the others' seat.

        The body that has the place has the number ``equations.rows``.
        """
        points: dict[tuple[str, Vector], list[tuple[str, int]]] = {}
        for number, pin in enumerate(self.equations.scene.pins):
            seat = points.setdefault((pin.second, pin.second_anchor), [(pin.second, self.equations.rows)])
            seat.append((pin.first, number))
        return list(points.values())

    def determinants(self, jacobian: Reals) -> Reals:
        """Determinant of every group's equations over the product of its rows' lengths, (instants, 1 + groups).

        It has no unit. Its sign tells the two assembly modes of a group apart; it is 0 where they meet. The first
        column, the crank's, is 1. ``jacobian`` is (instants, equations, coordinates).
        """
        groups = [np.ones(len(jacobian))]
        for rows, columns in self.blocks:
            block = jacobian[:, rows[0][:, None], columns]
            seated = np.flatnonzero(rows[1] < self.equations.rows)
            block[:, seated] -= jacobian[:, rows[1][seated][:, None], columns]
            lengths = np.sqrt(np.einsum("nrc,nrc->nr", block, block))
            groups.append(np.linalg.det(block / lengths[:, :, None]))
        return np.stack(groups, axis=1)


@dataclass(frozen=True)
class Corrected:
    """An observed motion at the samples of one clock, and as it would fit its joints and drive.

    Lengths are in the equations' unit, orders count time derivatives, bodies are (instants, bodies, 3). What rests on
    G⁻¹ is not a number in a position that is dead to the last digit. What rests on a channel that was not recorded
    raises AssertionError.
    """

    motion: ObservedMotion
    groups: AssurGroups
    time: Array
    _corrections: dict[int, Array] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def equations(self) -> JointEquations:
        """The joints' equations of the scene."""
        return self.groups.equations

    def observed(self, order: int) -> Array:
        """Position, velocity or acceleration (order 0, 1, 2) of every body, (instants, bodies, 3), by the engine.

        It is in the equations' unit and rad, or these per s or s².
        """
        return np.asarray(self.motion.bodies(LEVELS[order], self.time) / self.equations.metres)

    def correction(self, order: int) -> Array:
        """The correction of position, velocity or acceleration (order 0, 1, 2), (instants, bodies, 3).

        It is in the equations' unit and rad, or these per s or s², nan in a dead position; each is computed once.
        """
        if order not in self._corrections:
            if order == 0:
                residual = self.equations.residual(*self._observed_pose)
                residual[:, self.equations.crank_row] = self.equations.driver.value(self._observed_pose[0])
            else:
                residual = self._rates(order)
            if order == 2:
                residual = residual - self.equations.bend(self._corrected_pose[1], self.corrected(1))
            self._corrections[order] = self._solve_correction(residual, order)
        return self._corrections[order]

    def corrected(self, order: int) -> Array:
        """Position, velocity or acceleration (order 0, 1, 2) that fits joints and drive, (instants, bodies, 3).

        It is in the equations' unit and rad, or these per s or s², nan in a dead position.
        """
        return self.observed(order) + self.correction(order)

    @cached_property
    def _observed_pose(self) -> tuple[Pose, Arms]:
        """The bodies as the engine has them, before the correction, and the vectors of their joints."""
        pose = pose_of(self.observed(0))
        return pose, self.equations.arms(pose)

    @cached_property
    def _corrected_pose(self) -> tuple[Pose, Arms]:
        """The bodies after the correction of their positions, and the vectors of their joints."""
        pose = pose_of(self.corrected(0))
        return pose, self.equations.arms(pose)

    def _rates(self, order: int) -> Reals:
        """The residual rates (instants, equations) of observed velocities, G q̇, or accelerations, G q̈."""
        jacobian = self.equations.jacobian(self._corrected_pose[1])
        return np.asarray(np.einsum("nrc,nc->nr", jacobian, self.equations.gather(self.observed(order))))

    def _solve_correction(self, residual: Reals, order: int) -> Array:
        """The coordinates, (instants, bodies, 3), that take a residual away, as of an order; ``residual`` is changed.

        ``residual`` is (instants, equations), of positions, velocities or accelerations for ``order`` 0, 1 or 2; the
        drive's target is taken from it in place. What slides without turning keeps its angle.
        """
        equations, bodies = self.equations, self.equations.scene.bodies
        residual[:, equations.crank_row] -= self.crank_target(order)
        lack = equations.spread(-np.einsum("ncr,nr->nc", self.inverse, residual))
        for number in {equations.index[s.body] for s in equations.scene.sliders}:
            if bodies[number].inertia is None:
                offset = bodies[number].angle if order == 0 else 0.0
                lack[:, number, 2] = offset - self.observed(order)[:, number, 2]
        return np.asarray(lack, dtype=float)

    def crank_target(self, order: int) -> Array:
        """φ, its speed or acceleration (order 0, 1, 2), that the drive prescribes, (instants,), in rad.

        Of a linear drive it is in the equations' unit. Of a released driver it is the driver's own, as observed.
        """
        drive = self.equations.scene.drive
        scale = self.equations.driver.scale
        if isinstance(drive, Prescribed):
            return (drive.motion.angle, drive.motion.speed, drive.motion.acceleration)[order](self.time) / scale
        if order == 0:
            return np.asarray(self.equations.driver.value(self._observed_pose[0]), dtype=float)
        bend = (
            self.equations.bend(self._corrected_pose[1], self.corrected(1))[:, self.equations.crank_row]
            if order > 1
            else 0
        )
        return np.asarray(self._rates(order)[:, self.equations.crank_row] - bend, dtype=float)

    @cached_property
    def jacobian(self) -> Array:
        """The Jacobian G at the observed poses, (instants, equations, coordinates)."""
        return np.asarray(self.equations.jacobian(self._observed_pose[1]), dtype=float)

    @cached_property
    def determinants(self) -> Array:
        """Determinants of every group's equations, (instants, 1 + groups); see ``AssurGroups.determinants``."""
        return np.asarray(self.groups.determinants(self.jacobian), dtype=float)

    @cached_property
    def inverse(self) -> Array:
        """The inverse of the Jacobian, G⁻¹, (instants, coordinates, equations); nan in a dead position."""
        regular = np.all(np.abs(self.determinants) > EPS, axis=1)
        result = np.full(self.jacobian.shape, np.nan)
        result[regular] = np.linalg.inv(self.jacobian[regular])
        return result

    @cached_property
    def reactions(self) -> Array:
        """Multipliers λ of the corrected state, N, (instants, equations), moments over the equations' unit.

        They are nan in a dead position.
        """
        equations = self.equations
        velocity, acceleration = (self.corrected(order) * equations.metres for order in (1, 2))
        loads = applied_loads(equations.scene, self._corrected_pose[0].scaled(equations.unit), velocity)
        needed = equations.generalised(equations.mass * acceleration - loads)
        return np.asarray(np.einsum("nc,ncr->nr", needed, self.inverse))

    @property
    def torque(self) -> Array:
        """Drive torque by the principle of virtual power, standstill included, (instants,), N m; or force, N."""
        equations = self.equations
        return np.asarray(self.reactions[:, equations.crank_row] * (equations.unit / equations.driver.scale))

    @property
    def forces(self) -> Array:
        """The force of every pin, then every guided point, on its first body, (instants, joints, 2), N."""
        return np.asarray(self.equations.joint_forces(self._corrected_pose[1], self.reactions))


@dataclass(frozen=True)
class Findings:
    """The findings of the joints' equations on a motion at the samples of one clock, up to an order.

    ``lacking`` and ``moving``, (n, orders), are the size of the largest correction of any body and of the largest
    motion of any: displacements over the scene's size, turns in rad. ``determinants`` is (n, 1 + groups). ``torque``
    (n,), N m, and ``forces`` (n, joints, 2), N, of the accelerations' clock are what the motion requires; else empty.
    """

    time: Array
    lacking: Array
    moving: Array
    determinants: Array
    torque: Array
    forces: Array


def findings(motion: ObservedMotion, groups: AssurGroups, time: Array, order: int) -> Findings:
    """The findings on a motion at the times (n,), s, up to an order, in blocks so that the memory stays small.

    ``order`` is 0 for positions alone, 1 with velocities, 2 with accelerations, torque and forces.
    """
    blocks = [
        _findings_of_block(Corrected(motion, groups, time[start : start + BLOCK]), order)
        for start in range(0, len(time), BLOCK)
    ]
    return Findings(time, *(np.concatenate(parts) for parts in zip(*blocks, strict=True)))


def _findings_of_block(state: Corrected, order: int) -> tuple[Array, ...]:
    """The fields of ``Findings`` after ``time``, in their order, for one block of instants."""
    lacking, moving = (
        np.stack([largest_displacement(states(k)) for k in range(order + 1)], axis=1)
        for states in (state.correction, state.observed)
    )
    required = (state.torque, state.forces) if order == len(LEVELS) - 1 else (np.zeros(0), np.zeros(0))
    return (lacking, moving, state.determinants, *required)


def largest_displacement(states: Array) -> Array:
    """Largest displacement or turn of any body at each instant, (instants,), of states (instants, bodies, 3)."""
    return np.asarray(np.max(np.maximum(np.hypot(states[..., 0], states[..., 1]), np.abs(states[..., 2])), axis=1))


# Errors of a damped motion: what damping forgets of them, and speeds that decay within a sample or less.

ERROR_SHARE = 0.25  # of the distance from every other sample: fourth order leaves a fifteenth, if it converges
MOST_DECAY = 0.5  # of a relaxation time: within so long a step the ends' slopes still improve a quadrature


def accumulate_errors(start: float, shares: Array, added: Array) -> Array:
    """An error whose steps leave ``shares`` of it and add more: y₀ = ``start``, yₙ₊₁ = shareₙ yₙ + addedₙ, (n + 1,).

    ``shares`` and ``added`` are (n,).
    """
    if np.all(shares == 1.0):
        return start + np.concatenate([[0.0], np.cumsum(added)])
    result, value = [start], start
    for share, more in zip(shares.tolist(), added.tolist(), strict=True):
        value = value * share + more
        result.append(value)
    return np.array(result)


def undissipated_error(gained: Array, rate: Array, time: Array) -> Array:
    """An energy error, J, less what dampers dissipate of it at a ``rate``, 1/s: h' = δE' − rate · h.

    ``gained``, ``rate`` and the result are (n,), at ``time``, s. More speed is damped more: a power D taken of the
    kinetic energy T takes D/T of any error in it.
    """
    decay = np.diff(time) * 0.5 * (rate[1:] + rate[:-1])
    spread = -np.expm1(-decay) / np.maximum(decay, TINY)
    return accumulate_errors(float(gained[0]), np.exp(-decay), np.diff(gained) * np.where(decay > 0.0, spread, 1.0))


def speed_errors(time: Array, speed: Array, acceleration: Array, rate: Array, start: float) -> Array:
    """|ω − what the claimed acceleration makes of it|, rad/s, (n,), beyond the error of coarse samples.

    ``speed``, ``acceleration`` and ``rate`` are (n,), at ``time``, s. ``rate`` is b/Jeq, 1/s, with which a speed
    relaxes; ``start`` is the first sample's own error, rad/s. Between samples the drive and loads, ε + rate · ω, are
    taken to be smooth, not ε itself, which may be over within a fraction of a step. 0 for too few samples.
    """
    errors = accumulate_errors(start, *_error_per_step(time, speed, acceleration, rate))
    if len(time) < 4 * POINTS:
        return np.zeros(len(time))
    coarse = accumulate_errors(start, *_error_per_step(time[::2], speed[::2], acceleration[::2], rate[::2]))
    converging = bool(np.all(np.diff(time) * np.maximum(rate[1:], rate[:-1]) < MOST_DECAY))
    unsure = (ERROR_SHARE if converging else 1.0) * np.maximum.accumulate(np.abs(coarse - errors[::2]))
    return np.maximum(np.abs(errors) - unsure[np.arange(len(time)) // 2], 0.0)


def _error_per_step(time: Array, speed: Array, acceleration: Array, rate: Array) -> tuple[Array, Array]:
    """For each step, the share of a speed error that it leaves, and the error that it adds, two arrays (n - 1,).

    Arguments are those of ``speed_errors``.
    """
    push, step = acceleration + rate * speed, np.diff(time)
    decay = step * 0.5 * (rate[1:] + rate[:-1])
    shares = np.exp(-decay)
    safe = np.maximum(decay, 1e-6)
    weight = np.where(decay > 1e-6, -np.expm1(-safe) / safe, 1.0 - 0.5 * decay)
    late = np.where(decay > 1e-3, (1.0 - weight) / safe, 0.5 - decay / 6.0)
    change = step * ((weight - late) * push[:-1] + late * push[1:])
    slope = np.gradient(push, time, edge_order=2)
    change += np.where(decay < MOST_DECAY, step**2 * (slope[:-1] - slope[1:]) / 12.0, 0.0)
    return shares, speed[1:] - shares * speed[:-1] - change


# One motion inspected: corrections, assembly modes, forces, sharp passages.


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
MOST_LENGTH_RATIO = 4.0  # times as long as its neighbour a piece of a law may be


@dataclass(frozen=True)
class Inspection:
    """One observed motion with its joints' equations evaluated once on each clock of its channels.

    ``assur`` are the linkage's groups, in an order in which they can be solved. What rests on a channel that was not
    recorded raises AssertionError.
    """

    motion: ObservedMotion
    assur: Sequence[AssurGroup]

    @cached_property
    def groups(self) -> AssurGroups:
        """The equations of the scene's Assur groups; lengths in them are over the scene's size."""
        return AssurGroups(JointEquations(self.motion.scene, scene_size(self.motion.scene)), self.assur)

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
        """The findings by the bytes of each clock of a position, velocity or acceleration.

        They go up to the highest derivative that has this clock.
        """
        recorded = list(takewhile(self.motion.has, LEVELS))
        clocks = {(time := self.motion.signal(c).time).tobytes(): (time, order) for order, c in enumerate(recorded)}
        return {key: findings(self.motion, self.groups, *clock) for key, clock in clocks.items()}

    def on(self, channel: Channel) -> Findings:
        """The findings at a channel's sample times; raises KeyError for a channel on a clock that no level has.

        The levels are position, velocity and acceleration. Raises AssertionError for a channel that was not recorded.
        """
        return self._findings[self.motion.signal(channel).time.tobytes()]

    def corrections(self) -> dict[str, Signal]:
        """The largest correction of any body, by level, that fits it to the joints and a prescribed crank, over time.

        Keys are "position", "velocity" and "acceleration". Displacements over the scene's size, turns in rad; of
        velocities and accelerations over their peak in the run. Raises AssertionError where one of the three was not
        recorded.
        """
        result = {}
        for order, channel in enumerate(LEVELS):
            outcome = self.on(channel)
            scale = float(np.max(outcome.moving[:, order])) if order else 1.0
            result[channel.value] = Signal(outcome.time, outcome.lacking[:, order] / (scale or 1.0))
        return result

    def assembly_mode(self) -> Signal:
        """How deep any group is in the wrong assembly mode, over its largest determinant, at the positions' times.

        It is 0 in the right one.
        """
        result = self.on(Channel.POSITION)
        depth = np.maximum(-result.determinants * self._start_modes() * self._mode_signs(result.time), 0.0)
        return Signal(result.time, np.max(depth / np.max(np.abs(result.determinants), axis=0), axis=1))

    def _start_modes(self) -> Array:
        """Sign of every group's determinant in the start state, (1 + groups,); of one that starts at 0, soon after."""
        equations = self.groups.equations
        first = self.groups.determinants(equations.jacobian(equations.arms(equations.start())))
        seen = np.concatenate([first, self.on(Channel.POSITION).determinants])
        values = np.argmax(np.abs(seen) > LEAST_DETERMINANT, axis=0)
        return np.asarray(np.sign(np.take_along_axis(seen, values[None], axis=0)[0]))

    @cached_property
    def _group_changes(self) -> list[tuple[int, float]]:
        """The change points of all groups: the group's number among the determinants, from 1, and φ, rad."""
        return [(number, change) for number, group in enumerate(self.assur, start=1) for change in group.changes]

    def _mode_signs(self, time: Array) -> Array:
        """-1 where a group has passed an odd number of its change points since the start, else 1; (n, 1 + groups).

        ``time`` (n,) is in s; the first column is the crank's.
        """
        angle = self.motion.crank(Channel.POSITION, time)
        start = start_coordinate(self.motion.scene) if self._group_changes else 0.0
        result = np.ones((len(time), 1 + len(self.groups.blocks)))
        for number, change in self._group_changes:
            turned = np.floor((angle - change) / FULL_TURN) - np.floor((start - change) / FULL_TURN)
            result[:, number] *= np.where(turned % 2 == 0, 1.0, -1.0)
        return result

    def beside_changes(self, time: Array) -> Booleans:
        """Where a group is at its change point or a few samples from it, (n, 1 + groups): it moves on smoothly there.

        The determinant is small there, and corrections, which are divided by it, are mere rounding. ``time`` (n,) is in
        s; the first column is the crank's.
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

        They are nan where there are too few samples around, one of the ``jumps`` of the acceleration, s, or no such
        curve. The signal itself is not changed.
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
        """The largest difference of any joint's force from what balances the bodies, over its peak, over time.

        At the accelerations' times that all claimed forces span; a force too faint is over a share of the largest one's
        peak. Every joint must have its force, with direction; raises KeyError for one without.
        """
        result, claimed = self.on(Channel.ACCELERATION), self.motion.history.joint_force
        joints = self.motion.scene.joints
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
        """Which intervals of a clock (n,), s, (n - 1,), the motion changes in faster than its samples can show.

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
        """Rate, 1/s, (n,), at which dampers take an error of the speed: half their power over kinetic energy.

        ``time`` (n,) is in s. Beside standstill it is interpolated; without dampers, or motion, it is 0.
        """
        power = self.motion.dissipation(time)
        if not power.any():
            return power
        kinetic = self.motion.kinetic_energy(time)
        moving = kinetic > STANDSTILL * np.max(kinetic)
        if not moving.any():  # nothing has a mass, nor then a speed to lose
            return np.zeros(len(time))
        return np.asarray(np.interp(time, time[moving], 0.5 * power[moving] / kinetic[moving]))

    def _undersampled_intervals(self, time: Array) -> Iterator[tuple[float, float]]:
        """Yield start and end, s, of intervals with too few samples, in no order; they may overlap.

        Near dead positions a determinant changes too much from one sample to the next; pieces of the prescribed motion
        may have too few instants of ``time`` (n,), s.
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

    Nan without one. There is none over one of the ``jumps``, s, or where it misses the samples.
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
