"""Corrections that make an observed motion fit its scene, with its Assur groups: an estimate of its error from itself.

With G = ∂Φ/∂q the residual r of the joints on position, velocity or acceleration level becomes, to first order, an
error of the state: G δ = −r. Near a dead position a joint that is open by little means a link that is off by much, and
δ says so, where the gap itself does not. Each level is taken at the corrected state of the one below it, since a
velocity may fit a wrong position. The forces that the corrected state requires follow from the transposed equations,
Gᵀ λ = M q̈ − Q (E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems, 1989, chapters 3 and 7).

The equations are those of ``engines.mechanics``, which ``direct`` solves too; nothing is shared with the closed form.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analytic.description.linkage import GROUND, Vector
from analytic.kinematics.decomposition import Matching
from analytic.numerics.arrays import Array
from comparisons.trials.observed_motion import POINTS, ObservedMotion
from engines.mechanics.joints import Arms, JointEquations, applied_loads
from engines.mechanics.states import Numbers, Pose, Reals, pose_of
from engines.scene import Channel, Prescribed

LEVELS = (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION)
EPS = float(np.finfo(float).eps)
BLOCK = 4096  # instants whose equations are in memory at a time


class AssurGroups:
    """The groups: each the fewest bodies not yet placed that their joints place.

    Their joints among each other and with placed bodies give as many equations as they have coordinates. What cannot
    be divided further is one group, whatever its class. ``blocks`` holds the rows and columns of each; rows come in
    pairs (2, k): the equation is the first one less the second, where ``equations.rows`` and more stand for none.
    """

    def __init__(self, equations: JointEquations) -> None:
        """Divide the joints' equations into blocks, one for each Assur group, in an order that can be solved."""
        self.equations = equations
        self._pins = self._pin_points()
        self.blocks: list[tuple[Numbers, Numbers]] = []
        self.members: list[tuple[str, ...]] = []
        placed = {GROUND, equations.scene.crank} if equations.scene.crank else {GROUND}
        for group in self._placed_together(placed):
            rows = np.array(self._rows_of(group, placed), dtype=np.intp).T
            self.blocks.append((rows, self._columns(group)))
            self.members.append(group)
            placed |= {*group}

    def _columns(self, bodies: tuple[str, ...]) -> Numbers:
        """The columns, as numbers, of the Jacobian that belong to the free coordinates of these bodies."""
        columns = self.equations.column[[self.equations.index[name] for name in bodies]]
        return np.asarray(columns[columns != self.equations.size])

    def _placed_together(self, placed: set[str]) -> list[tuple[str, ...]]:
        """The bodies of every group that is not yet ``placed``, each group behind those that place it.

        Every coordinate is matched with an equation that gives it, which ties its body, or the point of a pin, to
        others. What depends on itself in a circle is placed together. Where the equations do not give all coordinates,
        all bodies are one group.
        """
        names, ties = [name for name in self.equations.index if name not in placed], self._ties(placed)
        sizes = dict.fromkeys((node for tie in ties for node in tie), 2)  # of a point
        matching = Matching(sizes | {name: len(self._columns((name,))) for name in names}, ties)
        if matching.locked or matching.loose():
            return [tuple(names)]
        waiting, groups, done = matching.components(), list[tuple[str, ...]](), set[str]()
        while part := next((part for part in waiting if matching.needs(part) <= done | part), None):
            waiting.remove(part)
            done |= part
            groups.append(tuple(name for name in names if name in part))
        return [group for group in groups if group]

    def _ties(self, placed: set[str]) -> list[tuple[str, ...]]:
        """Names tied together by each equation: bodies not yet placed, and points of pins.

        All placed bodies on a pin are one, as they do not place each other.
        """
        ties: list[tuple[str, ...]] = []
        for number, ends in enumerate(self._pins):
            bodies = {body if body not in placed else "" for body, _ in ends}
            if bodies != {""}:
                point = f"point {number}"
                ties += [(point, *filter(None, [body])) for body in sorted(bodies) for _ in range(2)]
        names = {number: name for name, number in self.equations.index.items() if name not in placed}
        for _, first, second in self._constraints():
            tied = tuple(names[end] for end in (first, second) if end in names)
            ties += [tied] if tied else []
        return ties

    def _rows_of(self, bodies: tuple[str, ...], placed: set[str]) -> list[tuple[int, int]]:
        """Rows of the joints between these bodies, and between them and placed bodies, as pairs of numbers.

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
        """Rows of guides, locked turns and a cylinder, each with the numbers of its two bodies."""
        equations = self.equations
        constraints = [
            *zip(equations.line_rows, equations.body[equations.pins :], equations.host[equations.pins :], strict=True),
            *zip(equations.turn_rows, equations.turn_body, equations.turn_host, strict=True),
        ]
        if equations.scene.cylinder is not None:
            constraints.append((equations.crank_row, *equations.driver.ends))
        return constraints

    def _pin_points(self) -> list[list[tuple[str, int]]]:
        """The bodies on every pin with the number of their joint: any of them can be the others' seat."""
        points: dict[tuple[str, Vector], list[tuple[str, int]]] = {}
        for number, pin in enumerate(self.equations.scene.pins):
            seat = points.setdefault((pin.second, pin.second_anchor), [(pin.second, self.equations.rows)])
            seat.append((pin.first, number))
        return list(points.values())

    def determinants(self, jacobian: Reals) -> Reals:
        """Determinant of every group's equations over the product of its rows' lengths, (instants, groups): no unit.

        Its sign tells the two assembly modes of a group apart; it is 0 where they meet.
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
    G⁻¹ is not a number in a position that is dead to the last digit.
    """

    motion: ObservedMotion
    groups: AssurGroups
    time: Array

    @property
    def equations(self) -> JointEquations:
        """The joints' equations of the scene."""
        return self.groups.equations

    def observed(self, order: int) -> Array:
        """Position, velocity or acceleration (order 0, 1, 2) of every body, (instants, bodies, 3), by the engine."""
        return np.asarray(self.motion.bodies(LEVELS[order], self.time) / self.equations.metres)

    def correction(self, order: int) -> Array:
        """The correction of position, velocity or acceleration (order 0, 1, 2), (instants, bodies, 3)."""
        if order == 0:
            return self._position_correction
        return self._velocity_correction if order == 1 else self._acceleration_correction

    def corrected(self, order: int) -> Array:
        """Position, velocity or acceleration (order 0, 1, 2) that fits joints and drive, (instants, bodies, 3)."""
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

    @cached_property
    def _position_correction(self) -> Array:
        """The correction of the positions, (instants, bodies, 3), in units and rad."""
        residual = self.equations.residual(*self._observed_pose)
        residual[:, self.equations.crank_row] = self.equations.driven(*self._observed_pose)
        return self._solve_correction(residual, 0)

    @cached_property
    def _velocity_correction(self) -> Array:
        """The correction of the velocities, (instants, bodies, 3), in units/s and rad/s."""
        return self._solve_correction(self._rates(1), 1)

    @cached_property
    def _acceleration_correction(self) -> Array:
        """The correction of the accelerations, (instants, bodies, 3), in units/s² and rad/s²."""
        return self._solve_correction(
            self._rates(2) - self.equations.bend(self._corrected_pose[1], self.corrected(1)), 2
        )

    def _rates(self, order: int) -> Reals:
        """The residual rates (instants, equations) of observed velocities or accelerations: G q̇ or G q̈."""
        jacobian = self.equations.jacobian(self._corrected_pose[1])
        return np.asarray(np.einsum("nrc,nc->nr", jacobian, self.equations.gather(self.observed(order))))

    def _solve_correction(self, residual: Reals, order: int) -> Array:
        """The coordinates, (instants, bodies, 3), that take a residual away, as of an order; ``residual`` is changed.

        What slides without turning keeps its angle.
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
        """φ, its speed or acceleration (order 0, 1, 2), rad or units, that the drive prescribes, (instants,).

        Of a released driver it is the driver's own.
        """
        drive = self.equations.scene.drive
        scale = self.equations.driver.scale
        if isinstance(drive, Prescribed):
            return (drive.motion.angle, drive.motion.speed, drive.motion.acceleration)[order](self.time) / scale
        if order == 0:
            return np.asarray(self.equations.driven(*self._observed_pose), dtype=float)
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
        """Determinants of every group's equations, (instants, groups); see ``AssurGroups.determinants``."""
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
        """Multipliers λ of the corrected state, N, (instants, equations), moments over the equations' unit."""
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
    motion of any: displacements over the scene's size, turns in rad. ``determinants`` is (n, groups). ``torque`` (n,),
    N m, and ``forces`` (n, joints, 2), N, of the accelerations' clock are what the motion requires; else empty.
    """

    time: Array
    lacking: Array
    moving: Array
    determinants: Array
    torque: Array
    forces: Array


def findings(motion: ObservedMotion, groups: AssurGroups, time: Array, order: int) -> Findings:
    """The findings on a motion at the times (n,) up to an order, in blocks so that the memory stays small."""
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
    """Largest displacement or turn of any body at each instant, (instants,), of (instants, bodies, 3)."""
    return np.asarray(np.max(np.maximum(np.hypot(states[..., 0], states[..., 1]), np.abs(states[..., 2])), axis=1))


# Errors of a damped motion: what damping forgets of them, and speeds that decay within a sample or less.

TINY = float(np.finfo(float).tiny)
ERROR_SHARE = 0.25  # of the distance from every other sample: fourth order leaves a fifteenth, if it converges
MOST_DECAY = 0.5  # of a relaxation time: within so long a step the ends' slopes still improve a quadrature


def accumulate_errors(start: float, shares: Array, added: Array) -> Array:
    """An error whose steps leave ``shares`` of it and add more: y₀ = ``start``, yₙ₊₁ = shareₙ yₙ + addedₙ, (n + 1,)."""
    if np.all(shares == 1.0):
        return start + np.concatenate([[0.0], np.cumsum(added)])
    result, value = [start], start
    for share, more in zip(shares.tolist(), added.tolist(), strict=True):
        value = value * share + more
        result.append(value)
    return np.array(result)


def undissipated_error(gained: Array, rate: Array, time: Array) -> Array:
    """An energy error, J, less what dampers dissipate of it at a ``rate``, 1/s: h' = δE' − rate · h.

    More speed is damped more: a power D taken of the kinetic energy T takes D/T of any error in it.
    """
    decay = np.diff(time) * 0.5 * (rate[1:] + rate[:-1])
    spread = -np.expm1(-decay) / np.maximum(decay, TINY)
    return accumulate_errors(float(gained[0]), np.exp(-decay), np.diff(gained) * np.where(decay > 0.0, spread, 1.0))


def speed_errors(time: Array, speed: Array, acceleration: Array, rate: Array, start: float) -> Array:
    """|ω − what the claimed acceleration makes of it|, rad/s, (n,), beyond the error of coarse samples.

    ``rate`` is b/Jeq, 1/s, with which a speed relaxes; ``start`` is the first sample's own error. Between samples the
    drive and loads, ε + rate · ω, are taken to be smooth, not ε itself, which may be over within a fraction of a step.
    0 for too few samples.
    """
    errors = accumulate_errors(start, *_error_per_step(time, speed, acceleration, rate))
    if len(time) < 4 * POINTS:
        return np.zeros(len(time))
    coarse = accumulate_errors(start, *_error_per_step(time[::2], speed[::2], acceleration[::2], rate[::2]))
    converging = bool(np.all(np.diff(time) * np.maximum(rate[1:], rate[:-1]) < MOST_DECAY))
    unsure = (ERROR_SHARE if converging else 1.0) * np.maximum.accumulate(np.abs(coarse - errors[::2]))
    return np.maximum(np.abs(errors) - unsure[np.arange(len(time)) // 2], 0.0)


def _error_per_step(time: Array, speed: Array, acceleration: Array, rate: Array) -> tuple[Array, Array]:
    """For each step, the share of a speed error that it leaves, and the error that it adds."""
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
