"""Where a linkage's bodies are over a turn of its crank, or over the range that its driver reaches."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.curves import Curves
from comparisons.datasheet.sheet import Positions

COUNT: Final = 121
WHOLE: Final = 1e-9  # of a turn: what is missing of a whole one for rounding
INSET: Final = 1e-9  # of a range that ends in dead positions, so that its ends are assembled


def over_reach(mechanism: Mechanism) -> Positions:
    """The positions from φ = 0 over a turn, or between the ends of the range."""
    reach = mechanism.crank_range()
    if reach.is_full_turn:
        return at(mechanism, np.linspace(0.0, FULL_TURN, COUNT), closed=True)
    low, high = reach.limits
    inset = INSET * (high - low)
    return at(mechanism, np.linspace(low + inset, high - inset, COUNT), closed=False)


def over_motion(curves: Curves) -> Positions:
    """The positions over a turn of a motion that makes one, else over its time."""
    case = curves.case
    mechanism, (low, high) = case.mechanism, case.reach
    if not mechanism.linkage.is_linear and high - low >= FULL_TURN * (1.0 - WHOLE):
        return at(mechanism, np.linspace(0.0, mechanism.period, COUNT), closed=True)
    truth = curves.at(np.linspace(0.0, case.motion.duration, COUNT))
    positions = at(mechanism, truth.sweep.angle, closed=False)
    bodies = {
        name: np.array([x, y, curves.of(truth, f"link:{name}:angle")]) for name, (x, y, _) in positions.bodies.items()
    }
    return replace(positions, over="time", axis=truth.time, bodies=bodies)


def at(mechanism: Mechanism, angle: NDArray[np.float64], *, closed: bool) -> Positions:
    """The positions at these values of φ, rad, or of the travel, m."""
    sweep, linkage = mechanism.sweep(angle), mechanism.linkage
    bodies = {name: np.array(np.broadcast_arrays(*sweep.poses(name)[:2], sweep.angles(name))) for name in linkage.links}
    carriers = {slot.point: sweep.carrier(slot.point) for slot in linkage.slots}
    return Positions("phi", angle, bodies, carriers, closed)
