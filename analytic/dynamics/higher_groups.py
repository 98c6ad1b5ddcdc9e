"""Force analysis of a group of class III or higher: the equilibrium of its links solved for the forces in its joints.

The group is statically determinate: three equations to a link hold as many unknowns of its joints, two to a pin or a
slide and one to a cylinder. The matrix is the transpose of the one that its velocities solve, with moments about the
links' reference points.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.dynamics.force_formulas import Wrench
from analytic.dynamics.link_balance import LinkBalance
from analytic.kinematics import frames
from analytic.kinematics.frames import Scalar
from analytic.kinematics.structure import DrivenDistance, Group, GroupJoint, Revolute

Array = NDArray[np.float64]


@dataclass(frozen=True)
class UnitReaction:
    """What a unit of one unknown of a joint exerts on its far body and on its near one."""

    far: Wrench
    near: Wrench


def higher_wrenches(balance: LinkBalance, group: Group) -> list[tuple[GroupJoint, Wrench]]:
    """What every joint exerts on its far body, about that one's reference point (of a pin: at the pin)."""
    units = [list(_units(balance, joint)) for joint in group.joints]
    columns = [(joint, unit) for joint, both in zip(group.joints, units, strict=True) for unit in both]
    needs = [balance.needs[body] for body in group.links]
    shape = np.broadcast_shapes(*(np.shape(part) for need in needs for part in need), *_shapes(columns))
    matrix = np.zeros((*shape, len(columns), len(columns)))
    right = np.stack([np.broadcast_to(part, shape) for need in needs for part in need], axis=-1)
    rows = {body: 3 * number for number, body in enumerate(group.links)}
    for column, (joint, unit) in enumerate(columns):
        for body, wrench in ((joint.far, unit.far), (joint.near, unit.near)):
            for part, value in enumerate(wrench if body in rows else ()):
                matrix[..., rows[body] + part, column] = value
    solution = iter(np.moveaxis(np.linalg.solve(matrix, right[..., None])[..., 0], -1, 0))
    return [(joint, _sum(joint, [(next(solution), unit) for unit in both]))
            for joint, both in zip(group.joints, units, strict=True)]  # fmt: skip


def _shapes(columns: list[tuple[GroupJoint, UnitReaction]]) -> Iterator[tuple[int, ...]]:
    yield from (np.shape(part) for _, unit in columns for part in (*unit.far, *unit.near))


def _units(balance: LinkBalance, joint: GroupJoint) -> Iterator[UnitReaction]:
    """A unit of each unknown: a pin's force along x and y, a slide's across its line and moment, a cylinder's push."""
    if isinstance(joint, Revolute):
        far, near = (balance.arm(b, at) for b, at in ((joint.far, joint.far_local), (joint.near, joint.near_local)))
        for force in ((1.0, 0.0), (0.0, 1.0)):
            yield UnitReaction((*force, frames.cross(far, force)), _reverse(force, frames.cross(near, force)))
    elif isinstance(joint, DrivenDistance):
        far, near = (balance.arm(b, at) for b, at in ((joint.far, joint.far_local), (joint.near, joint.near_local)))
        u = balance.direction(joint)
        yield UnitReaction((*u, frames.cross(far, u)), _reverse(u, frames.cross(near, u)))
    else:
        x, y = frames.arm(balance.poses[joint.near], joint.along)
        gap = frames.minus(balance.place(joint.far), balance.place(joint.near))
        across = (-y, x)
        yield UnitReaction((*across, 0.0), _reverse(across, frames.cross(gap, across)))
        yield UnitReaction((0.0, 0.0, 1.0), (0.0, 0.0, -1.0))


def _reverse(force: tuple[Scalar, Scalar], moment: Scalar) -> Wrench:
    return (-force[0], -force[1], -moment)


def _sum(joint: GroupJoint, shares: list[tuple[Scalar, UnitReaction]]) -> Wrench:
    x = sum(size * unit.far[0] for size, unit in shares)
    y = sum(size * unit.far[1] for size, unit in shares)
    moment = 0.0 if isinstance(joint, Revolute) else sum(size * unit.far[2] for size, unit in shares)
    return (x, y, moment)
