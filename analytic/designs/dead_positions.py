"""Designs that stand in a dead position between two crank angles, where samples alone do not show it."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.designs.batches import BLOCK, Booleans, Integers, Sweeps, faults_of
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]

# A dyad's determinant is zero in a dead position and goes there as the distance or faster: of the two samples on one of
# its sides the nearer has no more than half of the farther one's. ``analytic.compiled.kernels.figures`` has the same.
KEPT: Final = 0.6
PARTS: Final = 8  # of a step that is looked into
FINEST: Final = 1e-8  # of all crank angles: two assembly modes that are not apart there meet


def are_steep(sweep: Sweep) -> Booleans:
    """The steps between crank angles (designs, angles - 1) next to which a dead position may lie."""
    steep = np.zeros((sweep.angle.shape[0], sweep.angle.shape[1] - 1), dtype=bool)
    for dyad in sweep.structure.dyads:
        size = np.abs(np.broadcast_to(sweep.determinant(dyad), sweep.angle.shape))
        one, two = size[:, 1:], size[:, :-1]
        steep |= ~(np.minimum(one, two) >= KEPT * np.maximum(one, two))
    return steep


def stuck(sweeps: Sweeps, rows: Integers, angles: Array) -> Booleans:
    """Which designs of some rows (n,) cannot move from one of the crank angles (angles,) to the next.

    Also those that pass a change point, at which two assembly modes meet, unless their sweep knows it.
    """
    result = np.zeros(len(rows), dtype=bool)
    size = max(1, BLOCK // len(angles))
    for start in range(0, len(rows), size):
        own = np.arange(start, min(start + size, len(rows)))
        phi = np.broadcast_to(angles, (len(own), len(angles)))
        finest = FINEST * (angles[-1] - angles[0])
        while len(own):
            sweep = sweeps(rows[own], phi)
            for body in sweep.structure.bodies:
                sweep.rates(body)
            result[own[faults_of(sweep).any(axis=1)]] = True
            steep = are_steep(sweep) & ~result[own, None]
            if phi[0, 1] - phi[0, 0] < finest:
                if not any(dyad.changes for dyad in sweep.structure.dyads):
                    result[own[steep.any(axis=1)]] = True
                break
            near = steep.copy()
            near[:, 1:] |= steep[:, :-1]
            near[:, :-1] |= steep[:, 1:]
            row, step = np.nonzero(near)
            low, high = phi[row, step, None], phi[row, step + 1, None]
            own, phi = own[row], low + (high - low) * np.linspace(0.0, 1.0, PARTS + 1)
    return result
