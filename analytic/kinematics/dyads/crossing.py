"""Common part of RPP and PRP: two lines along e and f, t e − u f = gap, with one assembly mode.

The determinant e × f vanishes where the lines are parallel.
"""

from __future__ import annotations

import numpy as np

from analytic.description.linkage import Vector
from analytic.kinematics.dyads.arms import LEAST_SINE, UNDETERMINED
from analytic.kinematics.dyads.closure import At, Closure, Poses, Shortfall, Written
from analytic.kinematics.frames import Pair, Scalar, cross
from analytic.kinematics.structure import Dyad

Constants = tuple[Vector, ...]


def slides(e: Pair, f: Pair, gap: Pair, scale: Scalar) -> Pair:
    """Solve t e − u f = gap for (t, u): travels, or their derivatives; ``scale`` is 1 / e × f."""
    return (cross(gap, f) * scale, cross(gap, e) * scale)


def least(k: Constants, closure: Closure) -> Scalar:
    """Why the links do not meet, as a fault and a sentence: the lines are parallel."""
    return LEAST_SINE


def missing(k: Constants, near: Poses, closure: Closure) -> tuple[Scalar, Scalar]:
    """No length is missing, but parallel lines do not cross."""
    return np.sign(abs(closure.determinant) - LEAST_SINE), 0.0


def toggle(dyad: Dyad, closure: Closure) -> str:
    """Why the links do not meet, as a fault and a sentence: the lines are parallel."""
    return f"the guides of '{dyad.first}' and '{dyad.second}' parallel"


def shortfall(dyad: Dyad, k: Constants, near: Poses, at: At, written: Written) -> Shortfall:
    """Why the links do not meet, as a fault and a sentence: the lines are parallel."""
    return UNDETERMINED, (
        f"the guides of '{dyad.first}' and '{dyad.second}' are parallel, so nothing holds the two in "
        "place; turn one of the guides"
    )
