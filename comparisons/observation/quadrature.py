"""Integrals over samples that an engine chose, with an estimate of their error."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from comparisons.observation.interpolation import POINTS, resample
from engines.contract import Signal

Array = NDArray[np.float64]

FEWEST = 4 * POINTS  # samples needed for an error estimate
PLACES, WEIGHTS = np.polynomial.legendre.leggauss(POINTS // 2)  # exact for the interpolating polynomials


def integral(signal: Signal, jumps: tuple[float, ...], order: int = POINTS) -> Array:
    """∫ dt from the first sample to each, of an even order up to 6 between the times at which the signal jumps.

    It is the integral of what ``resample`` puts between the samples. A sample on a jump has two values, so that it is
    dropped and both sides are extrapolated to it.
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
        sums = total + _cumulative(nodes, Signal(time[inside], signal.values[inside]), order)
        here = (time >= start - near) & (time <= end + near)
        result[here] = sums[np.clip(np.searchsorted(nodes, time[here] - near), 0, len(nodes) - 1)]
        total = float(sums[-1])
    return result


def _cumulative(nodes: Array, stretch: Signal, order: int) -> Array:
    """∫ dt from the first node to each; a stretch of few samples is taken for a polygon."""
    step = np.diff(nodes)
    places = (nodes[:-1, None] + 0.5 * step[:, None] * (1.0 + PLACES)).ravel()
    if len(stretch.time) >= POINTS:
        between = resample(stretch, places, order)
    elif len(stretch.time):
        between = np.interp(places, stretch.time, stretch.values)
    else:
        between = np.zeros(len(places))
    parts = 0.5 * step * (between.reshape(-1, len(PLACES)) @ WEIGHTS)
    return np.concatenate([[0.0], np.cumsum(parts)])


def error_estimate(signal: Signal, fine: Array, jumps: tuple[float, ...]) -> Array:
    """Estimated error of ``integral`` up to each sample, never falling: its distance from the integral of fourth order.

    Of a signal that its samples resolve this is several times the error; of one that they do not, less than it.
    Infinite where there are too few samples to tell.
    """
    if len(signal.time) < FEWEST:
        return np.full(len(signal.time), np.inf)
    return np.maximum.accumulate(np.abs(integral(signal, jumps, order=4) - fine))


def error_bound(signal: Signal, fine: Array, jumps: tuple[float, ...]) -> Array:
    """Error bound of ``integral`` up to each sample, never falling: its distance from that of every other sample.

    Of a signal that its samples resolve, this is some sixty times the error; of a peak as narrow as a few samples still
    no less than it. Infinite where there are too few samples to tell.
    """
    time = signal.time
    if len(time) < FEWEST:
        return np.full(len(time), np.inf)
    some = np.unique([*range(0, len(time), 2), len(time) - 1])
    coarse = integral(Signal(time[some], signal.values[some]), jumps)
    largest = np.maximum.accumulate(np.abs(coarse - fine[some]))
    return largest[np.searchsorted(some, np.arange(len(time)))]
