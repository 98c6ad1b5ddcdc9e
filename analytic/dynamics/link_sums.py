"""One link's or spring's part in what a rigid crank feels: formulas that NumPy calls and numba compiles."""

from __future__ import annotations

from typing import Final

import numpy as np

from analytic.kinematics.frames import Pair, Rate, Scalar, dot, inverse, is_zero

TINY: Final = float(np.finfo(float).tiny)


def weighed(mass: float, inertia: float, u: Rate, v: Rate) -> Scalar:
    """A link's part of Jeq, m |S'|² + J θ'², from the derivatives (x', y', θ') of its mass centre and angle, twice.

    With their second derivatives in place of one of the two it is the part of ½ Jeq', m S'·S'' + J θ' θ''.
    """
    if is_zero(inertia):
        return mass * dot((u[0], u[1]), (v[0], v[1]))
    if is_zero(mass):
        return inertia * (u[2] * v[2])
    return mass * dot((u[0], u[1]), (v[0], v[1])) + inertia * (u[2] * v[2])


def stretching(span: Pair, rate: Pair) -> tuple[Scalar, Scalar]:
    """Length of a spring and its derivative over φ, from the vector between its ends and that one's derivative.

    The derivative is zero where the ends meet, so that the spring has no line to act along.
    """
    length = np.sqrt(dot(span, span))
    return length, dot(span, rate) * inverse(np.maximum(length, TINY))
