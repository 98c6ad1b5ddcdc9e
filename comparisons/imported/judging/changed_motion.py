"""A motion of the crank at another pace, from another angle, on another clock, or with its rates left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from comparisons.reference.motion import Motion

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ChangedMotion:
    """``pace`` φ(t + ``shift``) + ``offset``; derivatives above ``order`` are left out: 0 of them leave rest."""

    motion: Motion
    pace: float = 1.0
    offset: float = 0.0
    shift: float = 0.0
    order: int = 2

    @property
    def regime(self) -> str:
        """Name of the regime."""
        return self.motion.regime

    @property
    def duration(self) -> float:
        """Time at which it ends, s."""
        return self.motion.duration

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        return self.motion.peak_speed * abs(self.pace)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s."""
        return tuple(jump - self.shift for jump in self.motion.jumps)

    def _clock(self, time: ArrayLike) -> Array:
        return np.asarray(np.asarray(time, dtype=float) + self.shift)

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        return np.asarray(self.pace * self.motion.angle(self._clock(time)) + self.offset)

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        return np.asarray((self.order > 0) * self.pace * self.motion.speed(self._clock(time)))

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s²."""
        return np.asarray((self.order > 1) * self.pace * self.motion.acceleration(self._clock(time)))
