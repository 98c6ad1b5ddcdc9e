"""A prescribed crank in exudyn: its angle as functions of time, and what the accelerations do where its own jumps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from analytic.regimes import Segment

Array = NDArray[np.float64]
Foreign: TypeAlias = Any  # an object of exudyn, which carries no types

ROUNDING = 1e-9  # of the largest acceleration beside it: a smaller jump is rounding


@dataclass(frozen=True)
class Meeting:
    """The crank where two segments meet: its speed, rad/s, and its acceleration before and after, rad/s²."""

    speed: float
    before: float
    after: float
    jumps: bool


def meeting(before: Segment, after: Segment) -> Meeting:
    """Speed and accelerations where ``before`` goes over into ``after``."""
    times = [(s, s.start + share * (s.end - s.start)) for s in (before, after) for share in (0.0, 0.5, 1.0)]
    scale = max(abs(crank_value(segment, time, 2)) for segment, time in times)
    left, right = crank_value(before, before.end, 2), crank_value(after, after.start, 2)
    return Meeting(crank_value(after, after.start, 1), left, right, abs(right - left) > ROUNDING * scale)


def crank_value(segment: Segment, time: float, order: int) -> float:
    """Crank angle or a derivative of it; in plain numbers, a tenth of the price of a call made for arrays."""
    value = 0.0
    for coefficient in reversed(derivative(segment.coefficients, order)):
        value = value * (time - segment.start) + coefficient
    return value


def crank_angle(segments: Sequence[Segment], time: float) -> float:
    """φ at any time of a motion, rad."""
    return crank_value(next((s for s in segments if time <= s.end), segments[-1]), time, 0)


def derivative(coefficients: Sequence[float], order: int) -> list[float]:
    """Coefficients of a polynomial's derivative, lowest power first."""
    result = [float(coefficient) for coefficient in coefficients]
    for _ in range(order):
        result = [power * coefficient for power, coefficient in enumerate(result)][1:]
    return result or [0.0]


def accelerations_after(meeting: Meeting, velocity: Array, acceleration: Array) -> Array:
    """Accelerations of all coordinates just after a jump of the crank's, from those just before it.

    With one degree of freedom q' = dq/dφ: q̇ = q' ω and q̈ = q'' ω² + q' ε, so that q̈ grows by q̇/ω for every unit of ε.
    """
    if not meeting.jumps:
        return acceleration
    if meeting.speed != 0.0:
        return acceleration + velocity * ((meeting.after - meeting.before) / meeting.speed)
    return acceleration * (meeting.after / meeting.before)  # at rest q̈ = q' ε


def polynomial(coefficients: Sequence[float], start: float) -> Callable[..., Foreign]:
    """A polynomial of the time since ``start`` in the form exudyn asks a connector's function of time to have."""

    def value(_mbs: Foreign, t: Foreign, _item: Foreign, _offset: Foreign) -> Foreign:
        x = t - start
        result = coefficients[-1] + 0.0 * x  # a symbolic function has to return a symbolic
        for coefficient in coefficients[-2::-1]:
            result = result * x + coefficient
        return result

    return value


def whole_angle(segments: Sequence[Segment]) -> Callable[..., float]:
    """The crank's angle from its start over the whole motion, as a plain Python function."""
    start = crank_value(segments[0], segments[0].start, 0)
    return lambda _mbs, t, _item, _offset: crank_angle(segments, t) - start
