"""Figures: a signal over the motion of the crank reduced to one number, such as a peak or a mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import nan, pi
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class Reduction(StrEnum):
    """How a signal over the sampled angles becomes one number.

    ``PEAK`` is the largest magnitude; ``RANGE`` the largest less the smallest; ``AT`` the value at one crank angle.
    Means are integrals over the angle, whatever the samples.
    """

    PEAK = "peak"
    MEAN = "mean"
    RMS = "rms"
    MAX = "max"
    MIN = "min"
    RANGE = "range"
    AT = "at"


# The extremes that figures are made of, by ``SignalExtreme.way``.
WAYS: Final[Mapping[Reduction, tuple[int, ...]]] = {
    Reduction.PEAK: (0,),
    Reduction.MAX: (1,),
    Reduction.MIN: (-1,),
    Reduction.RANGE: (1, -1),
}


SQUARE: Final = 0.5 * pi
NEAR: Final = 1e-7  # rad: how near a kink is closed in on at least


class SignalExtreme(NamedTuple):
    """The highest (1), the lowest (-1) value of a signal, or the largest magnitude (0)."""

    signal: str
    way: int

    def side(self, values: Array) -> Array:
        """The derivative of the height by the value, 1 or -1."""
        if self.way:
            return np.full(values.shape, float(self.way))
        return np.where(values < 0.0, -1.0, 1.0)

    def height(self, values: Array, side: Array | None = None) -> Array:
        """A function of the signal that is largest at the extreme; ``side`` is its sign, that of each value if None."""
        return (self.side(values) if side is None else side) * values

    def is_kink(self, value: ArrayLike) -> Array:
        """Whether it is the top that a transmission angle has at 90°, which no number of the design moves."""
        can_be = self.way >= 0 and self.signal.startswith("transmission_angle:")
        return np.asarray(can_be & (np.asarray(value) > SQUARE - NEAR))

    def value(self, height: Array, side: Array) -> Array:
        """The signal where it has a height on a side."""
        return side * height


@dataclass(frozen=True)
class Figure:
    """A figure of a design, SI: a signal of ``analytic.signals``, or the magnitude of a vector, and its reduction.

    A magnitude is ``joint_force:A:magnitude`` or ``shaking_force:magnitude``. ``angle``, rad, belongs to ``AT``; in its
    place may stand a ``time``, s, where the motion is one in time.
    """

    signal: str
    reduction: Reduction
    angle: float = nan
    time: float = nan

    @property
    def is_magnitude(self) -> bool:
        """Whether it is a largest magnitude, which has no sign."""
        return self.reduction is Reduction.PEAK

    @property
    def is_mean(self) -> bool:
        """Whether it is an integral over the motion."""
        return self.reduction in (Reduction.MEAN, Reduction.RMS)

    @property
    def extremes(self) -> tuple[SignalExtreme, ...]:
        """The extremes from which it is computed; none for a mean or a single value."""
        return tuple(SignalExtreme(self.signal, way) for way in WAYS.get(self.reduction, ()))

    def integrand(self, values: Array) -> Array:
        """The integrand of a mean: the signal, or its square for an RMS."""
        return np.square(values) if self.reduction is Reduction.RMS else values

    def of_mean(self, mean: Array) -> Array:
        """The figure of the mean of its integrand."""
        return np.sqrt(mean) if self.reduction is Reduction.RMS else mean

    def of(self, ends: Sequence[Array]) -> Array:
        """The figure of designs from the values of its ``extremes``."""
        value = ends[0] if len(ends) == 1 else ends[0] - ends[1]
        return np.abs(value) if self.is_magnitude else value
