"""Whether a dyad can be assembled at every given crank angle, and whether it can move there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.dyads.arms import ROUNDING
from analytic.kinematics.frames import Scalar
from analytic.kinematics.groups.solver import GroupSolver

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]


def check_assembly(linkage: Linkage, solver: DyadSolver | GroupSolver, angle: Array) -> None:
    """Raise AssemblyError at the worst crank angle if the group's links do not meet somewhere; poses must be known."""
    if np.all(solver.moves):  # else a longer look: a dead position is no fault of assembly
        return
    if not np.all(np.isfinite(angle)):
        raise LinkproofError("crank angle: expected finite numbers, got nan or infinity; correct them")
    if isinstance(solver, GroupSolver):
        margin = np.broadcast_to(solver.margin(), angle.shape)
        worst = int(np.argmin(np.where(solver.moves, np.inf, np.minimum(margin, 0.0))))
        raise AssemblyError(
            f"'{linkage.name}' cannot be assembled at {linkage.place(_at(angle, angle, worst))}: {solver.why(linkage)}"
        )
    severity = _severity(solver)
    if np.any(severity < 0.0):
        worst = int(np.argmin(np.broadcast_to(severity, angle.shape)))
        fault, detail = solver.shortfall(lambda value: _at(value, angle, worst), linkage.written)
        raise AssemblyError(f"'{linkage.name}' {fault} at {linkage.place(_at(angle, angle, worst))}: {detail}")


def note_assembly(solver: DyadSolver | GroupSolver, faults: Booleans) -> None:
    """Set ``faults`` (of the angles' shape) where ``check_assembly`` would raise."""
    if not np.all(solver.moves):
        faults |= ~solver.moves if isinstance(solver, GroupSolver) else _severity(solver) < 0.0


def note_motion(solver: DyadSolver | GroupSolver, faults: Booleans) -> None:
    """Set ``faults`` (of the angles' shape) where ``check_motion`` would raise."""
    if not np.all(solver.moves):
        faults |= ~solver.moves


def _severity(solver: DyadSolver) -> Scalar:
    """Length by which the links fail to meet, m, below zero; zero where no more than rounding is missing."""
    with np.errstate(invalid="ignore"):
        missing, lengths = solver.missing()
        short = np.minimum(missing + ROUNDING * lengths, 0.0)
    undefined = ~(np.isfinite(solver.link_poses[0][0]) & np.isfinite(solver.link_poses[0][2]))
    return np.where(undefined & (short == 0.0), -np.finfo(float).tiny, short)


def check_motion(linkage: Linkage, solver: DyadSolver | GroupSolver, angle: Array) -> None:
    """Raise AssemblyError at the first crank angle at which the dyad stands in a dead position; poses must be known.

    The branch of a group of a higher class ends before its dead positions.
    """
    if np.all(solver.moves) or isinstance(solver, GroupSolver):
        return
    first = int(np.argmin(np.broadcast_to(solver.moves, angle.shape)))
    dyad, where = solver.dyad, linkage.place(_at(angle, angle, first))
    raise AssemblyError(
        f"'{linkage.name}': '{dyad.first}' and '{dyad.second}' stand in a dead position at {where}, "
        "where their velocities are undefined; choose other crank angles, or lengths that keep the transmission angle "
        "away from 0° and 180°"
    )


def _at(value: Scalar, angle: Array, index: int) -> float:
    return float(np.broadcast_to(value, angle.shape).ravel()[index])
