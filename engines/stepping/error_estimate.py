"""Estimate of the error of an extrapolation, from the changes that its last passes made."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from engines.contract import History, Signal
from engines.stepping.richardson import Pass, extrapolate

SAFETY = 2.0  # of an estimated error over that of the theory of evenly shrinking terms
COARSE = 0.5  # relative error assumed of a step that is far too long
# A component this much smaller than its neighbours is rounding and has no relative error.
NOTHING = 1e-9


def estimated_error(passes: Sequence[Pass], orders: Sequence[int]) -> float:
    """Error of the extrapolation of all passes, relative to the peaks; infinite for a single pass."""
    counts = range(max(1, len(passes) - 2), len(passes) + 1)
    changes = [change(a, b) for a, b in pairwise(extrapolate(passes[:count], orders) for count in counts)]
    return remaining_error(changes, passes[-1].step / passes[-2].step) if changes else math.inf


def remaining_error(changes: Sequence[float], ratio: float) -> float:
    """Error left of an extrapolation by what its last passes changed, the last at ``ratio`` of the step before it.

    If the terms of the error, cₖ h²ᵏ, shrink evenly, the error left by k passes is as much less than the last change as
    that is less than the one before, times the square of the ratio of their steps. With one change only, COARSE
    stands for the one before it. Measured on all test linkages: half to twice the error from three passes on, seven
    tenths to six times from two, as long as the constraint solver's tolerance is not what limits it.
    """
    before = changes[-2] if len(changes) > 1 else COARSE
    now = changes[-1]
    shrinking = now / before if before else 1.0
    return SAFETY * now * min(1.0, shrinking) * ratio**2


def change(history: History, other: History) -> float:
    """Largest relative difference of two histories of one scene, over the peak of its own component in ``other``.

    Taken in accelerations and torque, which integrators find hardest, or in what else was recorded; 0 if nothing was.
    """
    hard = [(history.acceleration, other.acceleration), (history.torque, other.torque)]
    easy: list[tuple[Signal | None, Signal | None]] = [
        (history.joint_force[name], other.joint_force[name]) for name in history.joint_force
    ]
    easy += [(history.velocity, other.velocity), (history.position, other.position)]
    for pairs in (hard, easy):
        present = [(a, b) for a, b in pairs if a is not None and b is not None]
        if present:
            return max(_relative(a, b) for a, b in present)
    return 0.0


def _relative(signal: Signal, other: Signal) -> float:
    shape = (-1, other.values.shape[-1] if other.values.ndim > 1 else 1)
    peak = np.abs(other.values).reshape(shape).max(axis=0)
    difference = np.abs(signal.values - other.values).reshape(shape).max(axis=0)
    moves = peak > NOTHING * peak.max()
    return float(np.max(difference[moves] / peak[moves], initial=0.0))
