"""Motions of the driver: what a case and its truth ask of one."""

from __future__ import annotations

from typing import Final, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.kinematics.mechanism import Mechanism
from analytic.motion.unit_functions import top_of_turn
from analytic.numerics.refine import highest

Array = NDArray[np.float64]

INSTANTS: Final = 2001  # at which a motion is looked at as a whole


class Spin(Protocol):
    """A crank motion whose angle and speed can be evaluated at any time."""

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        ...

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        ...


class Motion(Spin, Protocol):
    """A crank motion, prescribed or integrated."""

    @property
    def regime(self) -> str:
        """Name of the regime."""
        ...

    @property
    def duration(self) -> float:
        """Time at which it ends, s; it starts at 0."""
        ...

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        ...

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s."""
        ...

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s²."""
        ...


# The zero of S: the top dead centre, or the farthest point of a motion whose crank cannot turn fully.


def zero_of_output(mechanism: Mechanism, motion: Motion) -> float:
    """The output's coordinate at which S is 0, m.

    It is that of the top dead centre where the crank can turn fully, else of the farthest point the motion reaches,
    between instants too. Raises LinkproofError where the output of a full turn stands still along its direction.
    """
    top = top_of_turn(mechanism)
    return _farthest_reached(mechanism, motion) if top is None else top


def _farthest_reached(mechanism: Mechanism, motion: Motion) -> float:
    """The largest coordinate, m, of the output over a motion, between instants too."""
    time = np.linspace(0.0, motion.duration, INSTANTS)

    def coordinate(instants: Array) -> Array:
        return mechanism.sweep(motion.angle(instants)).output()[None]

    return float(highest(coordinate, time, coordinate(time))[0][0])
