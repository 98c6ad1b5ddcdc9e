"""A prescribed crank in exudyn: its angle and speed as functions of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from analytic.description.crank_motion import Segment, derivative

Foreign: TypeAlias = Any  # an object of exudyn, which carries no types


def crank_angle(segments: Sequence[Segment], time: float) -> float:
    """φ at any time of a motion, rad."""
    return float(next((s for s in segments if time <= s.end), segments[-1]).value(time))


def polynomial(segment: Segment, order: int, origin: float = 0.0) -> Callable[..., Foreign]:
    """A derivative of a segment's crank angle, less ``origin``, in the form exudyn asks a function of time to have."""
    *higher, lowest = derivative(segment.coefficients, order)
    coefficients = (*higher, lowest - origin)

    def value(_mbs: Foreign, t: Foreign, _item: Foreign, _offset: Foreign) -> Foreign:
        x = t - segment.start
        result = coefficients[0] + 0.0 * x  # a symbolic function has to return a symbolic
        for coefficient in coefficients[1:]:
            result = result * x + coefficient
        return result

    return value


def whole_angle(segments: Sequence[Segment]) -> Callable[..., float]:
    """The crank's angle from its start over the whole motion, as a plain Python function."""
    start = crank_angle(segments, segments[0].start)
    return lambda _mbs, t, _item, _offset: crank_angle(segments, t) - start
