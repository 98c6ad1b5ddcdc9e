"""Integrals over samples that an engine chose, with what the samples leave in doubt."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from comparisons.observation.interpolation import POINTS, resample
from engines.contract import Signal

Array = NDArray[np.float64]

# A fourth-order quadrature is off by a fifteenth of its difference from the one on half its samples; jumps spoil that.
DOUBT_SHARE = 0.25


def integral(signal: Signal, jumps: tuple[float, ...]) -> Array:
    """∫ dt from the first sample to each, fourth order between the times at which the signal jumps.

    A sample on a jump has two values, so that it is dropped and both sides are extrapolated to it.
    """
    time = signal.time
    near = 1e-6 * float(time[1] - time[0])
    on_jump = np.any([np.abs(time - jump) <= near for jump in jumps] or [np.zeros(len(time), dtype=bool)], axis=0)
    borders = [float(time[0]), *(jump for jump in jumps if time[0] < jump < time[-1]), float(time[-1])]
    result = np.zeros(len(time))
    total = 0.0
    for start, end in itertools.pairwise(borders):
        inside = (time >= start) & (time <= end) & ~on_jump
        nodes = np.unique(np.concatenate([[start], time[inside], [end]]))
        sums = total + _cumulative(nodes, _extended(Signal(time[inside], signal.values[inside]), nodes))
        here = (time >= start - near) & (time <= end + near)
        result[here] = sums[np.clip(np.searchsorted(nodes, time[here] - near), 0, len(nodes) - 1)]
        total = float(sums[-1])
    return result


def _extended(stretch: Signal, nodes: Array) -> Array:
    """A stretch's values at its ends as well; held constant there if it has too few samples for more."""
    if len(stretch.time) >= POINTS:
        return resample(stretch, nodes)
    if len(stretch.time) == 0:
        return np.zeros(len(nodes))
    return np.asarray(np.interp(nodes, stretch.time, stretch.values))


def _cumulative(time: Array, values: Array) -> Array:
    """∫ dt by the trapezoid rule with its end correction, fourth order where the values are smooth."""
    step = np.diff(time)
    parts = step * (values[1:] + values[:-1]) / 2.0
    if len(time) > 2:
        slope = np.gradient(values, time, edge_order=2)
        parts += step**2 * (slope[:-1] - slope[1:]) / 12.0
    return np.concatenate([[0.0], np.cumsum(parts)])


def doubt(signal: Signal, fine: Array, jumps: tuple[float, ...]) -> Array:
    """What may be wrong with ``integral`` up to each sample, never falling, from the integral of every other sample.

    Infinite where there are too few samples to tell.
    """
    time = signal.time
    if len(time) < 4 * POINTS:
        return np.full(len(time), np.inf)
    coarse = Signal(time[::2], integral(Signal(time[::2], signal.values[::2]), jumps))
    return np.asarray(DOUBT_SHARE * np.maximum.accumulate(np.abs(resample(coarse, time) - fine)))
