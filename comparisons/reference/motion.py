"""Motions of the driver: what a case and its truth ask of one."""

from __future__ import annotations

from typing import Final, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
