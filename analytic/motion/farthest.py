"""The zero of S: the top dead centre, or the farthest position of a crank that cannot turn fully."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from analytic.errors import AssemblyError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.unit_functions import top_dead_centre
from analytic.numerics.refine import highest

Array = NDArray[np.float64]

POINTS = 721  # of a range of angles, at which its highest place is looked for


@lru_cache(maxsize=64)
def top_of_turn(mechanism: Mechanism) -> float | None:
    """The output's coordinate at the top dead centre, m; None where the crank cannot turn fully to show it."""
    if mechanism.linkage.is_linear:
        return None
    try:
        mechanism.check_full_turn()
        return top_dead_centre(mechanism).coordinate
    except AssemblyError:
        return None


def farthest_between(mechanism: Mechanism, angle: Array) -> float:
    """The output's coordinate at which S is 0, m, where the crank moves between the least and the largest angle, rad.

    It is that of the top dead centre where the crank can turn fully, else the highest between them. Raises
    LinkproofError where the output of a full turn stands still along its direction.
    """
    top = top_of_turn(mechanism)
    if top is not None:
        return top
    places = np.linspace(np.min(angle), np.max(angle), POINTS)
    return float(
        highest(lambda phi: mechanism.sweep(phi).output()[None], places, mechanism.sweep(places).output()[None])[0][0]
    )
