"""Further instants where a group comes near a dead position: peaks of forces are narrower than the steps there."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.kinematics.transmission import transmission_angle
from comparisons.reference.case import Case

Array = NDArray[np.float64]

# Between two instants the sine of a transmission angle changes by no more than this share of itself: the forces go as
# its inverse. Next to such a change, too, for its least value may lie between two that are equal.
CHANGE: Final = 0.2
HALVINGS: Final = 14
MOST: Final = 4000  # instants added


def with_near_toggles(case: Case, grid: Array) -> Array:
    """The instants, s, with as many between them as the groups' transmission angles ask for."""
    added = grid
    for _ in range(HALVINGS):
        halves = _halved(case, added)
        if not len(halves) or len(added) + len(halves) > len(grid) + MOST:
            break
        added = np.union1d(added, halves)
    return added


def _halved(case: Case, time: Array) -> Array:
    """The middles of those steps in which, or next to which, a sine changes by too much."""
    sweep = case.mechanism.sweep(case.motion.angle(time))
    coarse = np.zeros(len(time) - 1, dtype=bool)
    for dyad in case.mechanism.structure.dyads:
        sine = np.sin(transmission_angle(sweep, dyad))
        coarse |= np.abs(np.diff(sine)) > CHANGE * np.minimum(sine[1:], sine[:-1])
    wide = np.convolve(coarse, [True, True, True], mode="same").astype(bool)
    middles = 0.5 * (time[1:] + time[:-1])
    return np.asarray(middles[wide & (middles > time[:-1]) & (middles < time[1:])])
