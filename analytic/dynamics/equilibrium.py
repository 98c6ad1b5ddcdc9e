"""Crank angles at which a linkage stays at rest under its loads and a crank torque, and whether it returns to them."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN, Law
from analytic.dynamics import reduced
from analytic.dynamics.equation_of_motion import crank_torque
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.extremes import grid, in_turn
from analytic.numerics.roots import root
from analytic.numerics.where_assembled import where_assembled

Array = NDArray[np.float64]

# A moment smaller than this share of what the links' weights could make is rounding: the linkage is balanced.
BALANCED: Final = 1e-12


class Equilibrium(NamedTuple):
    """A crank angle, rad in [0, 2π), where Q + M1 = 0; stable where the moment drives the crank back to it.

    For a driver that is pushed it is a travel or a length, m.
    """

    angle: float
    stable: bool


def equilibria(mechanism: Mechanism, torque: float | Law = 0.0) -> tuple[Equilibrium, ...]:
    """Every angle at which the moment on the crank changes sign, in increasing order.

    ``torque`` is M1, N m, a number or a law of φ. Empty without an equilibrium: the torque outweighs the loads,
    or there is no moment at any angle. A crank that cannot make a full turn is searched over its range, like a driver
    that is pushed; two angles nearer to each other than half a degree may be missed.
    """
    law = crank_torque(torque)

    def moment(angle: Array) -> Array:
        return np.asarray(reduced.generalised_force(mechanism.sweep(angle)) + law(angle)[0])

    is_linear = mechanism.linkage.is_linear
    start = mechanism.turn.angle if is_linear else grid()
    before = where_assembled(moment, start)
    peak = float(np.nanmax(np.abs(before), initial=0.0))
    if peak <= BALANCED * _weight(mechanism):
        return ()
    after = np.roll(before, -1)
    if is_linear:
        after[-1] = np.nan
    changes = np.flatnonzero((np.signbit(before) != np.signbit(after)) & np.isfinite(before) & np.isfinite(after))
    equilibria = []
    for change in changes:
        left = float(start[change])
        right = float(start[change + 1]) if is_linear else left + FULL_TURN / len(start)
        angle = root(lambda phi: float(moment(np.asarray(phi))), left, right)
        ends = max(abs(before[change]), abs(after[change]))
        if abs(float(moment(np.asarray(angle)))) <= ends:  # else it passes through infinity, at a dead position
            place = angle if is_linear else float(in_turn(angle))
            equilibria.append(Equilibrium(place, bool(after[change] < before[change])))
    return tuple(sorted(equilibria))


def _weight(mechanism: Mechanism) -> float:
    """Moment of all links' weights at the largest lever arm in the drawing, N m."""
    linkage = mechanism.linkage
    return float(sum(link.mass for link in linkage.links.values()) * np.hypot(*linkage.gravity) * linkage.extent())
