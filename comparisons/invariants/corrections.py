"""What an observed motion would have to be corrected by to fit its scene: an estimate of its error from itself.

With G = ∂Φ/∂q the residual r of the joints on position, velocity or acceleration level becomes, to first order, an
error of the state: G δ = −r. Near a dead position a joint that is open by little means a link that is off by much, and
δ says so, where the gap itself does not. Each level is taken at the corrected state of the one below it, since a
velocity may fit a wrong position. The forces that the corrected state requires follow from the transposed equations,
Gᵀ λ = M q̈ − Q (E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems, 1989, chapters 3 and 7).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from comparisons.invariants.joint_equations import JointEquations
from comparisons.observation.body_states import States
from comparisons.observation.loads import wrenches
from comparisons.observation.observed_motion import ObservedMotion
from engines.scene import Channel, Prescribed

Array = NDArray[np.float64]

LEVELS = (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION)
EPS = float(np.finfo(float).eps)
BLOCK = 4096  # instants whose equations are held in memory at a time


@dataclass(frozen=True)
class Instants:
    """An observed motion at the samples of one clock; lengths are in the scene's size, orders count time derivatives.

    What rests on G⁻¹ is not a number in a position that is dead to the last digit.
    """

    motion: ObservedMotion
    equations: JointEquations
    time: Array
    _states: dict[int, States] = field(default_factory=dict, repr=False, compare=False)

    def observed(self, order: int) -> Array:
        """Position, velocity or acceleration of every body, (instants, bodies, 3)."""
        size = self.equations.size
        return np.asarray(self.motion.on_clock(LEVELS[order], self.time) / np.array([size, size, 1.0]))

    def correction(self, order: int) -> Array:
        """What the position, velocity or acceleration lacks, (instants, bodies, 3)."""
        corrected = self.corrected(order)
        return np.asarray(getattr(corrected, LEVELS[order].value) - self.observed(order))

    def corrected(self, order: int) -> States:
        """The states up to this order as they would fit the joints and the drive."""
        if order not in self._states:
            states = self._with(self.corrected(order - 1) if order else self._seen, order, self.observed(order))
            lack = self._lack(states, order)
            self._states[order] = self._with(states, order, getattr(states, LEVELS[order].value) + lack)
        return self._states[order]

    @staticmethod
    def _with(states: States, order: int, values: Array) -> States:
        changed: dict[str, Any] = {LEVELS[order].value: values}
        return replace(states, **changed)

    @cached_property
    def _seen(self) -> States:
        return States(self.equations.numbers, self.equations.size, self.observed(0))

    def _lack(self, states: States, order: int) -> Array:
        residual = self.equations.residual(states, order)
        residual[:, -1] -= self.crank_target(order)
        lack = self.equations.spread(-np.einsum("ncr,nr->nc", self.inverse, residual))
        for number, angle in self.equations.still:
            lack[:, number, 2] = (angle if order == 0 else 0.0) - getattr(states, LEVELS[order].value)[:, number, 2]
        return lack

    def crank_target(self, order: int) -> Array:
        """Crank angle, speed or acceleration as the drive prescribes it; a released crank's own."""
        scene = self.equations.scene
        if isinstance(scene.drive, Prescribed):
            motion = scene.drive.motion
            return (motion.angle, motion.speed, motion.acceleration)[order](self.time)
        return self.observed(order)[:, self.equations.numbers[scene.crank], 2]

    @cached_property
    def jacobian(self) -> Array:
        """G, (instants, equations, coordinates)."""
        return self.equations.jacobian(self._seen)

    @cached_property
    def determinants(self) -> Array:
        """Of every group's equations, (instants, groups); see ``JointEquations.group_determinants``."""
        return self.equations.group_determinants(self.jacobian)

    @cached_property
    def inverse(self) -> Array:
        """G⁻¹, (instants, coordinates, equations)."""
        regular = np.all(np.abs(self.determinants) > EPS, axis=1)
        result = np.full(self.jacobian.shape, np.nan)
        result[regular] = np.linalg.inv(self.jacobian[regular])
        return result

    @cached_property
    def reactions(self) -> Array:
        """λ of the corrected state, (instants, equations): N m; for a pin or a line its force times the scene's size.

        The crank's is the torque of its drive by the principle of virtual power, standstill included.
        """
        states, size = self.corrected(2), self.equations.size
        unit = np.array([size, size, 1.0])
        wanted = (self.motion.masses * unit * states.acceleration - wrenches(self.equations.scene, states)) * unit
        return np.asarray(np.einsum("nc,ncr->nr", wanted[:, self.equations.free], self.inverse))

    @property
    def forces(self) -> Array:
        """What every pin, then every guided point, exerts on its first body, (instants, joints, 2), N."""
        scene, forces = self.equations.scene, self.reactions / self.equations.size
        found = [forces[:, [row, row + 1]] for row in self.equations.pin_rows]
        for joint, row in zip(scene.guided, self.equations.line_rows, strict=True):
            x, y = self.corrected(0).turned(joint.host, joint.along)
            found.append(np.stack([-y * forces[:, row], x * forces[:, row]], axis=1))
        return np.stack(found, axis=1)


@dataclass(frozen=True)
class Findings:
    """What the joints' equations say of a motion at the samples of one clock, up to an order.

    ``lacking`` and ``moving`` hold, by order, the size of the largest correction of any body and of the largest motion
    of any: displacements over the scene's size, turns in rad, (n,). ``determinants`` is (n, groups). ``torque`` (n,),
    N m, and ``forces`` (n, joints, 2), N, of the accelerations' clock are what the motion requires; else empty.
    """

    time: Array
    lacking: tuple[Array, ...]
    moving: tuple[Array, ...]
    determinants: Array
    torque: Array
    forces: Array


def findings(motion: ObservedMotion, equations: JointEquations, time: Array, order: int) -> Findings:
    """Look at a motion block by block."""
    found = list(_blocks(motion, equations, time, order))
    orders = range(order + 1)
    return Findings(
        time,
        lacking=tuple(np.concatenate([one.lacking[k] for one in found]) for k in orders),
        moving=tuple(np.concatenate([one.moving[k] for one in found]) for k in orders),
        determinants=np.concatenate([one.determinants for one in found]),
        torque=np.concatenate([one.torque for one in found]),
        forces=np.concatenate([one.forces for one in found]),
    )


def _blocks(motion: ObservedMotion, equations: JointEquations, time: Array, order: int) -> Iterator[Findings]:
    for start in range(0, len(time), BLOCK):
        instants = Instants(motion, equations, time[start : start + BLOCK])
        orders, forces = range(order + 1), order == len(LEVELS) - 1
        yield Findings(
            instants.time,
            tuple(size(instants.correction(k)) for k in orders),
            tuple(size(instants.observed(k)) for k in orders),
            instants.determinants,
            instants.reactions[:, -1] if forces else np.zeros(0),
            instants.forces if forces else np.zeros(0),
        )


def size(states: Array) -> Array:
    """Largest displacement or turn of any body at each instant of (instants, bodies, 3)."""
    return np.asarray(np.max(np.maximum(np.hypot(states[..., 0], states[..., 1]), np.abs(states[..., 2])), axis=1))
