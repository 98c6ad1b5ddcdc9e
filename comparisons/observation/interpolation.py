"""Values between samples: six-point Lagrange interpolation on any increasing clock."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from engines.contract import Signal

Array = NDArray[np.float64]

POINTS = 6
SHARP = 16  # points where a value between samples is itself the zero that all others are counted from
# Places between the neighbours of the largest value, and how often they are looked at: to a millionth of a sample.
BETWEEN, CLOSER = 65, 3


def resample(signal: Signal, time: Array, points: int = POINTS) -> Array:
    """Values of a signal at other times, (len(time), ...); of order ``points`` inside, one-sided at the ends.

    On the signal's own clock the values come back untouched.
    """
    if time is signal.time or np.array_equal(time, signal.time):
        return signal.values
    if len(signal.time) < points:
        raise ValueError(f"expected at least {points} samples to interpolate, got {len(signal.time)}")
    start = np.clip(np.searchsorted(signal.time, time) - points // 2, 0, len(signal.time) - points)
    nodes = [signal.time[start + k] for k in range(points)]
    result = np.zeros((len(time), *signal.values.shape[1:]))
    shape = (len(time), *([1] * (signal.values.ndim - 1)))
    for k in range(points):
        weight = np.ones(len(time))
        for j in range(points):
            if j != k:
                weight *= (time - nodes[j]) / (nodes[k] - nodes[j])
        result += weight.reshape(shape) * signal.values[start + k]
    return result


def resample_piecewise(signal: Signal, time: Array, breaks: Sequence[float], points: int = POINTS) -> Array:
    """The same with nodes from one side of each break alone: a derivative jumps there, and no polynomial follows it.

    A piece with fewer nodes takes what it has; one with a single node is read across the break.
    """
    if time is signal.time or np.array_equal(time, signal.time) or not len(breaks):
        return resample(signal, time, points)
    nodes, places = np.searchsorted(breaks, signal.time, "right"), np.searchsorted(breaks, time, "right")
    result = np.empty((len(time), *signal.values.shape[1:]))
    for piece in np.unique(places):
        here, there = nodes == piece, places == piece
        count = int(np.count_nonzero(here))
        part = Signal(signal.time[here], signal.values[here]) if count > 1 else signal
        result[there] = resample(part, time[there], min(points, len(part.time)))
    return result


def peak(signal: Signal, breaks: Sequence[float] = ()) -> float:
    """The largest value of a signal (n,) that is smooth but for its ``breaks``, between its samples too."""
    time = signal.time
    at = int(np.argmax(signal.values))
    low, high = time[max(at - 1, 0)], time[min(at + 1, len(time) - 1)]
    for _ in range(CLOSER):
        places = np.linspace(low, high, BETWEEN)
        values = resample_piecewise(signal, places, breaks, min(SHARP, len(time)))
        at = int(np.argmax(values))
        low, high = places[max(at - 1, 0)], places[min(at + 1, BETWEEN - 1)]
    return float(values[at])
