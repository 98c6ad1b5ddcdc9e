"""What is done to a column after the simulation: smoothed, thinned out and filled up.

Each function yields kind, words and values of what the closed form becomes by it, at the numbers nearest to the file;
nan where it is open, as at the ends of a filter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter, savgol_filter

from comparisons.imported.judging.judgement import SignalVerdict

Array = NDArray[np.float64]
Changed = tuple[str, str, Array]  # kind, words, values

WIDEST: Final = 0.2  # of the samples: a filter
NARROWEST: Final = 3  # samples
FEWEST: Final = 12  # samples of a column of which any of this can be told
MOST_STRIDES: Final = 64
EVERY_PHASE: Final = 12  # strides up to which each phase is tried
NARROWER: Final = 0.1  # of the best odd number of samples
GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


def filters(verdict: SignalVerdict) -> Iterator[Changed]:
    """Smoothed over several samples: of each kind of filter the width that is nearest to the file."""
    name, truth = verdict.name, verdict.truth
    if len(truth) < FEWEST:
        return
    step = float(np.median(np.diff(verdict.samples.time)))
    whole: dict[str, Callable[[float], Array]] = {
        "moving average": lambda w: moving_average(truth, int(w)),
        "Savitzky-Golay filter": lambda w: _inner(savgol_filter(truth, max(int(w), 5), 2), w),
    }
    broken: dict[str, Callable[[float], Array]] = {
        "Gaussian filter": lambda w: _inner(gaussian_filter1d(truth, w / 6.0), w),
        "low-pass filter": lambda w: low_pass(truth, w),
    }
    for kind, smooth in (whole | broken).items():
        width = _nearest_width(verdict, smooth, is_whole=kind in whole)
        words = f"{name} is smoothed: a {kind} over {width:.3g} samples ({width * step:.3g} s)"
        yield f"smoothed by {kind}", words, smooth(width)


def moving_average(truth: Array, width: int) -> Array:
    """Mean of ``width`` samples about each, nan at the ends."""
    half = width // 2
    sums = np.concatenate([[0.0], np.cumsum(truth)])
    means = np.full(len(truth), np.nan)
    if len(truth) > 2 * half:
        means[half : len(truth) - half] = (sums[width:] - sums[:-width]) / width
    return means


def low_pass(truth: Array, width: float) -> Array:
    """A first-order filter with a time constant of ``width`` samples."""
    share = 1.0 - math.exp(-1.0 / width)
    return np.asarray(lfilter([share], [1.0, share - 1.0], truth, zi=[(1.0 - share) * truth[0]])[0])


def _inner(values: Array, width: float) -> Array:
    """Without the ends, where filters differ."""
    values = np.array(values, dtype=float)
    half = max(int(width) // 2, 1)
    values[:half] = values[-half:] = np.nan
    return values


def _widths(count: int) -> list[int]:
    """Odd numbers of samples: every small one, then in ever larger steps."""
    widest = max(NARROWEST, int(WIDEST * count))
    spread = {int(width) | 1 for width in np.geomspace(NARROWEST, widest, 24)}
    return sorted(spread | set(range(NARROWEST, min(32, widest), 2)))


def _nearest_width(verdict: SignalVerdict, smooth: Callable[[float], Array], *, is_whole: bool) -> float:
    def cost(width: float) -> float:
        return _distance(verdict, smooth(width))

    best = min(_widths(len(verdict.truth)), key=cost)
    if is_whole:
        return min((w for w in (best - 2, best, best + 2) if w >= NARROWEST), key=cost)
    low, high = NARROWER * best, 2.0 * best
    for _ in range(40):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, right) if cost(left) < cost(right) else (left, high)
    return 0.5 * (low + high)


def _distance(verdict: SignalVerdict, values: Array) -> float:
    rest = (values - verdict.samples.values)[verdict.kept]
    known = rest[np.isfinite(rest)]
    return float(np.mean(known**2)) if len(known) else math.inf


def coarser(verdict: SignalVerdict) -> Iterator[Changed]:
    """The closed form at every k-th sample alone, joined by straight lines or held, for the k nearest to the file."""
    if len(verdict.truth) < FEWEST:
        return
    kinds = {"joined by straight lines": _joined, "each held until the next": _held}
    for kind, fill in kinds.items():
        trials = [(stride, fill(verdict, nodes)) for stride, nodes in _every_kth(len(verdict.truth))]
        stride, values = min(trials, key=lambda trial: _distance(verdict, trial[1]), default=(0, verdict.truth))
        words = f"the sample rate of {verdict.name} is too low: one sample in {stride} is simulated, {kind}"
        yield f"sample rate, {kind}", words, values


def _every_kth(count: int) -> Iterator[tuple[int, NDArray[np.int64]]]:
    for stride in range(2, min(MOST_STRIDES, count // 8) + 1):
        for phase in range(stride if stride <= EVERY_PHASE else 1):
            yield stride, np.arange(phase, count, stride)


def _joined(verdict: SignalVerdict, nodes: NDArray[np.int64]) -> Array:
    time = verdict.samples.time
    return np.interp(time, time[nodes], verdict.truth[nodes], left=np.nan, right=np.nan)


def _held(verdict: SignalVerdict, nodes: NDArray[np.int64]) -> Array:
    before = np.searchsorted(nodes, np.arange(len(verdict.truth)), side="right") - 1
    return np.where(before >= 0, verdict.truth[nodes[np.maximum(before, 0)]], np.nan)
