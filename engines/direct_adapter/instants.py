"""Positions, velocities, accelerations and joint forces at given instants, each instant solved by itself."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from engines.contract import History, Signal
from engines.direct_adapter.assembly import Closed, Solver
from engines.direct_adapter.equations import Arms, Equations, Pose, Reals, across
from engines.direct_adapter.loads import applied_loads
from engines.scene import Channel

FORCES = frozenset({Channel.TORQUE, Channel.JOINT_FORCE})
KINETIC = FORCES | {Channel.ACCELERATION}


@dataclass(frozen=True)
class Crank:
    """The crank's motion at n instants, rad and s; ``acceleration`` is None where ``torque``, N m, sets it."""

    angle: Reals
    speed: Reals
    acceleration: Reals | None
    torque: float = 0.0

    def part(self, instants: slice) -> Crank:
        """Some of the instants."""
        second = None if self.acceleration is None else self.acceleration[instants]
        return Crank(self.angle[instants], self.speed[instants], second, self.torque)


@dataclass(frozen=True)
class Instants:
    """What is known of n instants, SI: bodies' coordinates (n, bodies, 3), drive torque (n,), joint forces by name."""

    position: Reals
    velocity: Reals | None = None
    acceleration: Reals | None = None
    torque: Reals | None = None
    joint_force: dict[str, Reals] | None = None


def solve(equations: Equations, closed: Closed, crank: Crank, wanted: frozenset[Channel], passes: int) -> Instants:
    """The instants' motion and forces, no further than ``wanted`` asks."""
    position = coordinates(equations, closed.pose)
    if wanted <= {Channel.POSITION}:
        return Instants(position)
    solver = closed.solver(equations, passes)
    lever = transfer(equations, solver)
    rate = lever * crank.speed[:, None]
    velocity = equations.spread(rate) * metres(equations)
    if not wanted & KINETIC:
        return Instants(position, velocity)
    bend = solver.solve(equations.bend(closed.arms, equations.spread(rate)))
    loads: Reals = np.zeros(0)
    second = crank.acceleration
    if second is None or wanted & FORCES:  # a prescribed crank moves as it does whatever pulls at the links
        loads = applied_loads(equations.scene, equations, closed.pose, velocity, crank.angle)
        loads[:, equations.crank, 2] += crank.torque
    if second is None:
        second = _free_acceleration(equations, lever, bend, loads)
    acceleration = equations.spread(bend + lever * second[:, None]) * metres(equations)
    if not wanted & FORCES:
        return Instants(position, velocity, acceleration)
    multipliers = reactions(equations, solver, equations.mass * acceleration - loads)
    torque = multipliers[:, equations.crank_row] * equations.unit
    if crank.acceleration is None:
        torque = np.full_like(crank.speed, crank.torque)  # the row of the crank takes nothing: rounding, no torque
    forces = joint_forces(equations, closed.arms, multipliers) if Channel.JOINT_FORCE in wanted else None
    return Instants(position, velocity, acceleration, torque, forces)


def metres(equations: Equations) -> Reals:
    """Factors from units and rad to m and rad, (3,)."""
    return np.array([equations.unit, equations.unit, 1.0])


def coordinates(equations: Equations, pose: Pose) -> Reals:
    """x, y, m, and angle, rad, (n, bodies, 3)."""
    return np.concatenate([pose.place * equations.unit, pose.angle[..., None]], axis=-1)


def transfer(equations: Equations, solver: Solver) -> Reals:
    """The derivatives q' = dq/dφ, (n, k), in units and rad."""
    return solver.solve(equations.crank_unit(len(solver.matrix)))


def reactions(equations: Equations, solver: Solver, needed: Reals) -> Reals:
    """λ (n, rows), N, that together make the generalised forces ``needed`` (n, bodies, 3), N and N m.

    The rows of angles hold torques over the unit of length.
    """
    return solver.solve_transposed(equations.gather(needed / np.array([1.0, 1.0, equations.unit])))


def joint_forces(equations: Equations, arms: Arms, multipliers: Reals) -> dict[str, Reals]:
    """Force on each joint's first body, N, (n, 2) by joint name."""
    forces = np.empty_like(arms.gap)
    forces[:, : equations.pins, 0] = multipliers[:, equations.x_rows]
    forces[:, : equations.pins, 1] = multipliers[:, equations.y_rows]
    forces[:, equations.pins :] = multipliers[:, equations.line_rows, None] * across(arms.along)
    return {name: forces[:, number] for number, name in enumerate(equations.joints)}


def _free_acceleration(equations: Equations, lever: Reals, bend: Reals, loads: Reals) -> Reals:
    """ε of a crank that nothing drives but the loads: d'Alembert's principle along q'."""
    lever, bend = equations.spread(lever) * metres(equations), equations.spread(bend) * metres(equations)
    power = np.sum(lever * (loads - equations.mass * bend), axis=(1, 2))
    return np.asarray(power / np.sum(lever * lever * equations.mass, axis=(1, 2)))


def history(time: Reals, parts: list[Instants], names: Iterable[str], wanted: frozenset[Channel]) -> History:
    """The channels asked for, from consecutive blocks of instants."""

    def whole(channel: Channel) -> Signal | None:
        if channel not in wanted:
            return None
        blocks = [getattr(part, channel.value) for part in parts]
        return _signal(time, [block[:, :-1] if block.ndim == 3 else block for block in blocks])  # not the ground

    forces = {}
    if Channel.JOINT_FORCE in wanted:
        held = [part.joint_force for part in parts if part.joint_force is not None]
        forces = {name: _signal(time, [block[name] for block in held]) for name in names}
    return History(
        whole(Channel.POSITION),
        whole(Channel.VELOCITY),
        whole(Channel.ACCELERATION),
        whole(Channel.TORQUE),
        forces,
    )


def _signal(time: Reals, blocks: list[Reals]) -> Signal:
    return Signal(np.asarray(time, dtype=np.float64), np.concatenate(blocks).astype(np.float64))
