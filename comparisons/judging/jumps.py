"""Which samples lie at a jump of the driver's acceleration: one rule for all who judge or draw them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from comparisons.reference.motion import Motion

Array = NDArray[np.float64]

WINDOW: Final = 1e-2  # of the shortest time between two jumps, the start and the end: half of the window at a jump
ROUNDING: Final = 1e-9  # of the half window


def near_jumps(time: Array, motion: Motion) -> NDArray[np.bool_]:
    """Which of the times (n,), s, lie in the window at any jump of a motion's acceleration; nowhere without a jump.

    There accelerations, torques and forces have two true values. The window belongs to the motion: it is as wide for
    long steps of an engine or a file as for short ones.
    """
    near = np.zeros(len(time), dtype=bool)
    for jump in motion.jumps:
        near |= near_jump(time, motion, jump)
    return near


def near_jump(time: Array, motion: Motion, jump: float) -> NDArray[np.bool_]:
    """Which of the times (n,), s, lie in the window at one of the motion's jumps, s."""
    pieces = np.diff(np.unique([0.0, *motion.jumps, motion.duration]))
    half = WINDOW * float(np.min(pieces, initial=motion.duration))
    return np.asarray(np.abs(time - jump) <= half * (1.0 + ROUNDING))
