"""Long curves made short for drawing without hiding a peak."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reports.facts.views import Trace

Array = NDArray[np.float64]

BUCKETS = 400
FULL_TURN = 2.0 * np.pi


def thinned(time: Array, values: Array, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """Lowest and highest sample of every bucket, in their order, and both ends; short curves come back whole."""
    if len(time) <= 2 * buckets:
        return time, values
    kept = [np.array([0, len(time) - 1]), _highest(values, buckets), _highest(-values, buckets)]
    chosen = np.unique(np.concatenate(kept))
    return time[chosen], values[chosen]


def envelope(time: Array, values: Array, buckets: int = BUCKETS // 2) -> tuple[Array, Array]:
    """The largest value of every bucket, at its own instant; NaN samples are ignored, zeros left out."""
    seen = np.flatnonzero(~np.isnan(values) & (values > 0.0))
    time, values = time[seen], values[seen]
    chosen = _highest(values, buckets)
    return time[chosen], values[chosen]


def _highest(values: Array, buckets: int) -> NDArray[np.intp]:
    """Index of the highest sample of every bucket; the last bucket may be shorter."""
    size = -(-len(values) // buckets) or 1
    whole = len(values) // size
    found = np.argmax(values[: whole * size].reshape(whole, size), axis=1) + size * np.arange(whole)
    rest = values[whole * size :]
    last = [whole * size + int(np.argmax(rest))] if len(rest) else []
    return np.array([*found, *last], dtype=np.intp)


def last_turn(angle: Array) -> NDArray[np.intp]:
    """Indices of the last full turn of a crank angle, rad, in order of the angle within it; all if it made none."""
    inside = np.flatnonzero(np.abs(angle - angle[-1]) < FULL_TURN)
    return inside[np.argsort(angle[inside] % FULL_TURN, kind="stable")]


def over_last_turn(trace: Trace) -> Trace:
    """A trace over the last turn of its crank, its time replaced by the crank angle in degrees."""
    order = last_turn(trace.angle)
    return replace(
        trace,
        time=np.degrees(trace.angle[order]) % 360.0,
        observed=trace.observed[order],
        reference=trace.reference[order],
        error=trace.error[order],
    )
