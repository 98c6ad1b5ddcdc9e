"""The zero of S: the top dead centre, or the farthest point of a motion whose crank cannot turn fully."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.refine import highest
from analytic.turn.farthest import top_of_turn
from comparisons.reference.motion import INSTANTS, Motion

Array = NDArray[np.float64]


def farthest(mechanism: Mechanism, motion: Motion) -> float:
    """The output's coordinate at which S is 0, m.

    It is that of the top dead centre where the crank can turn fully, else of the farthest point the motion reaches,
    between instants too. Raises LinkproofError where the output of a full turn stands still along its direction.
    """
    top = top_of_turn(mechanism)
    return _reached(mechanism, motion) if top is None else top


def _reached(mechanism: Mechanism, motion: Motion) -> float:
    time = np.linspace(0.0, motion.duration, INSTANTS)

    def coordinate(instants: Array) -> Array:
        return mechanism.sweep(motion.angle(instants)).output()[None]

    return float(highest(coordinate, time, coordinate(time))[0][0])
