"""What may be wanted of every design: a signal over the motion of the crank, brought down to one number."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from math import nan, pi


class Reduction(StrEnum):
    """How a signal over the sampled angles becomes one number.

    ``PEAK`` is the largest magnitude, of a transmission angle the value farthest from 90°; ``RANGE``
    the largest less the smallest; ``AT`` the value at one crank angle. Means are over the angle.
    """

    PEAK = "peak"
    MEAN = "mean"
    RMS = "rms"
    MAX = "max"
    MIN = "min"
    RANGE = "range"
    AT = "at"


def middle(signal: str) -> float:
    """What a peak of a signal is farthest from."""
    return 0.5 * pi if signal.startswith("transmission_angle:") else 0.0


@dataclass(frozen=True)
class Figure:
    """A figure of a design, SI: a signal of ``analytic.signals``, or the magnitude of a vector, and its reduction.

    A magnitude is ``joint_force:A:magnitude`` or ``shaking_force:magnitude``. ``angle``, rad, belongs to ``AT``.
    """

    signal: str
    reduction: Reduction
    angle: float = nan

    @property
    def is_magnitude(self) -> bool:
        """Whether it is a largest magnitude, which has no sign."""
        return self.reduction is Reduction.PEAK and not middle(self.signal)
