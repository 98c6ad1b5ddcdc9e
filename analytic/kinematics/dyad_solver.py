"""Solving a dyad within a linkage: from the placed bodies' poses, rates and accelerations to those of its two links."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from analytic.description.linkage import Linkage
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.branch import Windows
from analytic.kinematics.dyads import FORMS, ROUNDING, At, Shortfall
from analytic.kinematics.frames import Pose, Rate, Scalar
from analytic.kinematics.group_solver import GroupSolver
from analytic.kinematics.structure import ClosedGroup
from analytic.numerics.arrays import Array, Booleans


class DyadSolver:
    """A dyad being solved, in its ``form``; the mappings hold every body placed before it.

    Each order of derivative reuses the results of the one below; poses alone cost no more than poses.
    """

    def __init__(self, dyad: ClosedGroup, angle: Scalar = None, windows: Windows | None = None) -> None:
        """Prepare to solve a group; ``angle`` is φ, rad or m, any shape, which change points and cylinders need.

        ``windows`` are those of φ so far, to which new ones are added.
        """
        self.group, self.angle = dyad, angle
        self.windows: Windows = {} if windows is None else windows
        self.sign: Scalar = float(dyad.sign) if dyad.changes is None else dyad.changes.signs(angle)
        self.form: Any = FORMS[dyad.kind](dyad, self.sign, angle)
        self.hosts = (dyad.joints[0].near, dyad.joints[-1].near)
        self.link_poses: tuple[Pose, ...]  # of both sides; of the driving cylinder, which is no link, None

    def poses(self, poses: Mapping[str, Pose]) -> tuple[Pose, ...]:
        """Poses of the links, by those of placed bodies by name, nan where they do not meet.

        Keeps them, and in ``moves`` where they can move, for the derivatives.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            pair = self.form.poses(self._of_hosts(poses))
            self.moves = self._moves()
        self.link_poses = self._through_change_points(0, pair)
        return _of_links(self.link_poses)

    def _of_hosts(self, known: Mapping[str, Any]) -> tuple[Any, Any]:
        """The poses of both hosts, or a derivative of them, out of those ``known``, by the body's name."""
        first, second = self.hosts
        return known[first], known[second]

    def _through_change_points(self, order: int, pair: tuple[Any, ...]) -> tuple[Any, ...]:
        """``pair`` as the formulas give it, replaced near change points by the series through them.

        It has both links' poses, or their derivatives of an ``order``.
        """
        changes = self.group.changes
        return pair if changes is None else changes.with_series(self.angle, order, pair, self.windows)

    def _moves(self) -> Scalar:
        """Where the dyad is far enough from its dead positions for its links to meet and move; a truth value per φ."""
        determinant, least = self.form.determinant, self.form.least_determinant()
        if self.group.changes is not None:
            return self.group.changes.moves(self.angle, self.sign * determinant > least, self.windows)
        if self.group.sign > 0:  # the determinant's own sign
            return determinant > least
        return determinant < -least if self.group.sign < 0 else abs(determinant) > least

    def rates(self, rates: Mapping[str, Rate]) -> tuple[Rate, ...]:
        """Derivatives over φ of the links' poses, from those of placed bodies by name; the poses must be known."""
        with np.errstate(divide="ignore", invalid="ignore"):
            pair = self.form.rates(self._of_hosts(rates), self.link_poses)
        return _of_links(self._through_change_points(1, pair))

    def accelerations(self, accelerations: Mapping[str, Rate]) -> tuple[Rate, ...]:
        """Second derivatives over φ of the links' poses, from those of placed bodies; the rates must be known.

        ``accelerations`` has those of the placed bodies by name.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            pair = self.form.seconds(self._of_hosts(accelerations), self.link_poses)
        return _of_links(self._through_change_points(2, pair))

    def severity(self) -> Scalar:
        """Minus the length, m, by which the links fail to meet, per φ; zero where only rounding is missing.

        For parallel guides it is -1; where a pose is undefined without a length missing, a tiny number below zero.
        """
        with np.errstate(invalid="ignore"):
            missing, lengths = self.form.reach_margin()
            short = np.minimum(missing + ROUNDING * lengths, 0.0)
        pose = _of_links(self.link_poses)[0]
        undefined = ~(np.isfinite(pose[0]) & np.isfinite(pose[2]))
        return np.where(undefined & (short == 0.0), -np.finfo(float).tiny, short)

    def fault(self, at: At, linkage: Linkage) -> Shortfall:
        """The reason why the links do not meet, at the value of φ that ``at`` picks, as fault and sentence.

        ``at`` turns a number or array over φ into its number there.
        """
        shortfall: Shortfall = self.form.fault(at, linkage.written)
        return shortfall


def _of_links(sides: tuple[Any, ...]) -> tuple[Any, ...]:
    """The results of links, in order, out of those of sides, of which a cylinder, which is no link, has None."""
    return tuple(part for part in sides if part is not None)


# Whether a dyad can be assembled at every given crank angle, and whether it can move there.


def check_assembly(
    linkage: Linkage, solver: DyadSolver | GroupSolver, angle: Array, faults: Booleans | None = None
) -> None:
    """Raise AssemblyError at the worst crank angle if the group's links do not meet somewhere; poses must be known.

    With ``faults``, of the angles' shape, these are set True there, in place, instead. Raises LinkproofError for an
    angle that is not finite, but not with ``faults``.
    """
    if np.all(solver.moves):  # else a longer look: a dead position is no fault of assembly
        return
    severity = solver.severity()
    if faults is not None:
        faults |= severity < 0.0
        return
    if not np.all(np.isfinite(angle)):
        raise LinkproofError("crank angle: expected finite numbers, got nan or infinity; correct them")
    if np.any(severity < 0.0):
        worst = int(np.argmin(np.broadcast_to(severity, angle.shape)))
        fault, detail = solver.fault(lambda value: _value_at(value, angle, worst), linkage)
        raise AssemblyError(f"'{linkage.name}' {fault} at {linkage.phi.text(_value_at(angle, angle, worst))}: {detail}")


def check_motion(
    linkage: Linkage, solver: DyadSolver | GroupSolver, angle: Array, faults: Booleans | None = None
) -> None:
    """Raise AssemblyError at the first crank angle with the dyad in a dead position; poses must be known.

    With ``faults``, of the angles' shape, these are set True there, in place, instead. A group of a higher class
    passes: its branch ends before its dead positions.
    """
    if np.all(solver.moves) or isinstance(solver, GroupSolver):
        return
    if faults is not None:
        faults |= ~solver.moves
        return
    first = int(np.argmin(np.broadcast_to(solver.moves, angle.shape)))
    dyad, where = solver.group, linkage.phi.text(_value_at(angle, angle, first))
    stand = "stand" if len(dyad.links) > 1 else "and its cylinder stand"
    raise AssemblyError(
        f"'{linkage.name}': {dyad.words} {stand} in a dead position at {where}, "
        "where their velocities are undefined; choose other crank angles, or lengths that keep the transmission angle "
        "away from 0° and 180°"
    )


def _value_at(value: Scalar, angle: Array, index: int) -> float:
    """The number of a value over the crank angles, or of a constant, at the angle of a flat ``index``."""
    return float(np.broadcast_to(value, angle.shape).ravel()[index])
