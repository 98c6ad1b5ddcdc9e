"""Designs that stand in a dead position between two crank angles, where samples alone do not show it."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.designs.samples import BLOCK, Booleans, Integers, Sampler

Array = NDArray[np.float64]

# A dyad's determinant is zero in a dead position and goes there as the distance or faster: of the two samples on one of
# its sides the nearer has no more than half of the farther one's.
LEAST_RATIO: Final = 0.6
PARTS: Final = 8  # of a step that is looked into
FINEST: Final = 1e-8  # of all crank angles: two assembly modes that are not apart there meet


def are_steep(determinants: Array) -> Booleans:
    """The steps between crank angles (designs, angles - 1) next to which a dead position may lie.

    Of the dyads' ``determinants`` (dyads, designs, angles), magnitudes.
    """
    first, two = determinants[..., 1:], determinants[..., :-1]
    return np.asarray(np.any(~(np.minimum(first, two) >= LEAST_RATIO * np.maximum(first, two)), axis=0))


def beside(steps: Booleans) -> Booleans:
    """Steps (designs, steps) and their neighbours."""
    near = steps.copy()
    near[:, 1:] |= steps[:, :-1]
    near[:, :-1] |= steps[:, 1:]
    return near


def divided(phi: Array, row: Integers, step: Integers, parts: int) -> Array:
    """Crank angles (n, parts + 1) that divide some steps of those of designs (designs, angles)."""
    low, high = phi[row, step, None], phi[row, step + 1, None]
    return np.asarray(low + (high - low) * np.linspace(0.0, 1.0, parts + 1))


def stuck(sampler: Sampler, rows: Integers, angles: Array) -> Booleans:
    """Which designs of some rows (n,) cannot move from one of the crank angles (angles,) to the next.

    Also those that pass a change point, at which two assembly modes meet, unless the linkage as described does.
    """
    result = np.zeros(len(rows), dtype=bool)
    size = max(1, BLOCK // len(angles))
    for start in range(0, len(rows), size):
        designs = np.arange(start, min(start + size, len(rows)))
        phi = np.broadcast_to(angles, (len(designs), len(angles)))
        finest = FINEST * (angles[-1] - angles[0])
        while len(designs):
            samples = sampler(rows[designs], phi, ())
            result[designs[~samples.moves.all(axis=1)]] = True
            steep = are_steep(samples.determinants) & ~result[designs, None]
            if phi[0, 1] - phi[0, 0] < finest:
                result[designs[steep.any(axis=1)]] = True
                break
            row, step = np.nonzero(beside(steep))
            designs, phi = designs[row], divided(phi, row, step, PARTS)
    return result
