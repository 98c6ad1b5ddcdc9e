"""A prescribed crank in exudyn: its angle as functions of time, and where its acceleration jumps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from analytic.description.crank_motion import Segment

Foreign: TypeAlias = Any  # an object of exudyn, which carries no types

ROUNDING = 1e-9  # of the largest acceleration beside it: a smaller jump is rounding


def jumps(before: Segment, after: Segment) -> bool:
    """Whether the crank's acceleration jumps where ``before`` goes over into ``after``."""
    times = [(s, s.start + share * (s.end - s.start)) for s in (before, after) for share in (0.0, 0.5, 1.0)]
    scale = max(abs(crank_value(segment, time, 2)) for segment, time in times)
    return abs(crank_value(after, after.start, 2) - crank_value(before, before.end, 2)) > ROUNDING * scale


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
