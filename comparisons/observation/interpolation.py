"""Values between samples: six-point Lagrange interpolation on any increasing clock."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analytic.numerics.refine import highest
from engines.contract import Signal

Array = NDArray[np.float64]

POINTS = 6
SHARP_POINTS = 16  # samples beside a place whose value is the zero of all others, where more accuracy counts


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
    """Values of a signal at other times, (len(time), ...), from nodes on one side of each break, s, alone.

    A derivative jumps at a break, and no polynomial follows it.

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
    points = min(SHARP_POINTS, len(signal.time))

    def between(time: Array) -> Array:
        return resample_piecewise(signal, time, breaks, points)[None]

    return float(highest(between, signal.time, signal.values[None])[0][0])


# Integrals over samples that an engine chose, with an estimate of their error.

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
        sums = total + _integrate_stretch(nodes, Signal(time[inside], signal.values[inside]), order)
        here = (time >= start - near) & (time <= end + near)
        result[here] = sums[np.clip(np.searchsorted(nodes, time[here] - near), 0, len(nodes) - 1)]
        total = float(sums[-1])
    return result


def _integrate_stretch(nodes: Array, stretch: Signal, order: int) -> Array:
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
