"""Processing of a curve after the simulation: smoothing, and fewer samples filled up; nan where that is ambiguous."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError

Array = NDArray[np.float64]

WIDEST_SHARE: Final = 0.2  # of the samples: a filter
NARROWEST: Final = 3  # samples
FEWEST: Final = 12  # samples of a curve from which filters are recognised
MOST_STRIDES: Final = 64
EVERY_PHASE: Final = 12  # strides up to which each phase is tried


def moving_average(values: Array, width: float) -> Array:
    """Mean of a whole odd number of samples about each, nan at the ends."""
    width = int(width)
    half = width // 2
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means = np.full(len(values), np.nan)
    if len(values) > 2 * half:
        means[half : len(values) - half] = (sums[width:] - sums[:-width]) / width
    return means


def low_pass(values: Array, width: float) -> Array:
    """A first-order filter with a time constant of ``width`` samples; raises LinkproofError for another width."""
    if not 0.05 < width < len(values):
        raise LinkproofError(f"width of a filter: expected up to {len(values)} samples, got {width:g}")
    from scipy.signal import lfilter  # noqa: PLC0415 - half a second that pages and checks of engines do not pay

    share = 1.0 - math.exp(-1.0 / width)
    return np.asarray(lfilter([share], [1.0, share - 1.0], values, zi=[(1.0 - share) * values[0]])[0])


def filter_widths(count: int) -> tuple[list[float], list[float]]:
    """Odd and spread-out widths of filters of a curve of ``count`` samples; none of a short curve."""
    if count < FEWEST:
        return [], []
    widest = max(NARROWEST, int(WIDEST_SHARE * count))
    spread = {float(int(width) | 1) for width in np.geomspace(NARROWEST, widest, 24)}
    odd = spread | {float(width) for width in range(NARROWEST, min(32, widest), 2)}
    return sorted(odd), [0.5, 1.0, 2.0, *sorted(spread)]


def strides_and_phases(count: int) -> Iterator[tuple[float, float]]:
    """Strides and phases of the only simulated samples that a curve of ``count`` samples may have; none if short."""
    for stride in range(2, min(MOST_STRIDES, count // 8) + 1 if count >= FEWEST else 0):
        for phase in range(stride if stride <= EVERY_PHASE else 1):
            yield float(stride), float(phase)


def join_samples(time: Array, values: Array, stride: int, phase: int) -> Array:
    """Every k-th sample of values (n,), joined by straight lines; nan outside."""
    nodes = np.arange(phase, len(values), stride)
    return np.interp(time, time[nodes], values[nodes], left=np.nan, right=np.nan)


def hold_samples(_: Array, values: Array, stride: int, phase: int) -> Array:
    """Every k-th sample of values (n,), each repeated until the next; nan before the first."""
    number = np.arange(len(values)) - phase
    return np.where(number >= 0, values[np.maximum(number - number % stride, 0) + phase], np.nan)


FILLINGS: Final = {"joined by straight lines": join_samples, "each repeated until the next": hold_samples}
