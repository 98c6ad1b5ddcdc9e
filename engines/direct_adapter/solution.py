"""Positions, velocities, accelerations and joint forces at given instants, each instant solved by itself."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines.contract import History, Signal
from engines.direct_adapter.assembly import Closed, Equations, Solver
from engines.mechanics.loads import applied_loads
from engines.mechanics.states import Reals
from engines.scene import Channel

Array = NDArray[np.float64]

FORCES = frozenset({Channel.TORQUE, Channel.JOINT_FORCE})
KINETIC = FORCES | {Channel.ACCELERATION}


@dataclass(frozen=True)
class Crank:
    """The driver's motion at n instants, rad or units, and s; ``acceleration`` is None where ``torque`` sets it.

    That is in N m, of a linear driver its force in N times the unit.
    """

    angle: Reals
    speed: Reals
    acceleration: Reals | None
    torque: Reals | None = None

    def part(self, instants: slice) -> Crank:
        """Some of the instants."""
        second = None if self.acceleration is None else self.acceleration[instants]
        torque = None if self.torque is None else self.torque[instants]
        return Crank(self.angle[instants], self.speed[instants], second, torque)


@dataclass(frozen=True)
class Solution:
    """What is known of n instants, SI, by channel: bodies' coordinates (n, bodies, 3), the drive's torque (n,).

    ``joint_force`` is (n, joints, 2).
    """

    position: Reals
    velocity: Reals | None = None
    acceleration: Reals | None = None
    torque: Reals | None = None
    joint_force: Reals | None = None


def solve(equations: Equations, closed: Closed, crank: Crank, channels: frozenset[Channel], passes: int) -> Solution:
    """The instants' motion and forces, no further than the channels need."""
    pose = closed.pose.scaled(equations.unit)
    if channels <= {Channel.POSITION}:
        return Solution(pose.coordinates())
    solver = closed.solver(equations, passes)
    lever = transfer(equations, closed, solver)
    rate = equations.spread(lever * crank.speed[:, None])
    velocity = rate * equations.metres
    if not channels & KINETIC:
        return Solution(pose.coordinates(), velocity)
    bend = bends(equations, closed, solver, lever, crank.speed)
    loads: Reals = np.zeros(0)
    second = crank.acceleration
    if second is None or channels & FORCES:  # a prescribed crank moves as it does whatever pulls at the links
        loads = applied_loads(equations.scene, pose, velocity)
        if crank.torque is not None:
            push = equations.driver.gradient(closed.arms.driver, len(loads)) / equations.metres
            loads = loads + crank.torque[:, None, None] * push
    if second is None:
        second = _free_acceleration(equations, lever, bend, loads)
    acceleration = equations.spread(bend + lever * second[:, None]) * equations.metres
    if not channels & FORCES:
        return Solution(pose.coordinates(), velocity, acceleration)
    lacking = equations.mass * acceleration - loads
    multipliers = solver.solve_transposed(equations.generalised(lacking))
    scale = equations.driver.scale
    torque = multipliers[:, equations.crank_row] * (equations.unit / scale)
    if closed.smooth is not None:  # by virtual power, which needs no joint forces
        power = np.sum(equations.spread(lever) * equations.metres * lacking, axis=(1, 2))
        torque = np.where(closed.smooth[0], power / scale, torque)
    if crank.acceleration is None:
        assert crank.torque is not None
        torque = crank.torque / scale  # the driver's row takes nothing: rounding, no torque
    forces = equations.joint_forces(closed.arms, multipliers) if Channel.JOINT_FORCE in channels else None
    return Solution(pose.coordinates(), velocity, acceleration, torque, forces)


def transfer(equations: Equations, closed: Closed, solver: Solver) -> Reals:
    """The derivatives q' = dq/dφ, (n, k), in units and rad."""
    result = solver.solve(equations.crank_unit(len(solver.matrix)))
    if closed.smooth is not None:
        within, (first, _) = closed.smooth
        result[within] = first
    return result


def bends(equations: Equations, closed: Closed, solver: Solver, lever: Reals, speed: Reals) -> Reals:
    """What the speeds (n,) alone accelerate the coordinates by, q'' φ̇², (n, k), in units and rad."""
    result = solver.solve(equations.bend(closed.arms, equations.spread(lever * speed[:, None])))
    if closed.smooth is not None:
        within, (_, second) = closed.smooth
        result[within] = second * speed[within, None] ** 2
    return result


def _free_acceleration(equations: Equations, lever: Reals, bend: Reals, loads: Reals) -> Reals:
    """ε of a crank that nothing drives but the loads: d'Alembert's principle along q'."""
    lever, bend = equations.spread(lever) * equations.metres, equations.spread(bend) * equations.metres
    power = np.sum(lever * (loads - equations.mass * bend), axis=(1, 2))
    return np.asarray(power / np.sum(lever * lever * equations.mass, axis=(1, 2)))


def history(time: Array, blocks: list[Solution], joints: Iterable[str], channels: frozenset[Channel]) -> History:
    """The requested channels, from consecutive blocks of instants."""
    whole = {
        channel: np.concatenate([getattr(block, channel.value) for block in blocks]).astype(np.float64)
        for channel in channels
    }
    forces = whole.pop(Channel.JOINT_FORCE).swapaxes(0, 1) if Channel.JOINT_FORCE in channels else ()
    # The ground, the last body, is left out.
    signals = {c.value: Signal(time, values[:, :-1] if values.ndim == 3 else values) for c, values in whole.items()}
    joint_force = {name: _bounded(Signal(time, force)) for name, force in zip(joints, forces, strict=False)}
    return History(**signals, joint_force=joint_force)


def _bounded(signal: Signal) -> Signal:
    """A joint's force without the instants beside change points, where it has no bound."""
    kept = ~np.isnan(signal.values[:, 0])
    return Signal(signal.time[kept], signal.values[kept])
