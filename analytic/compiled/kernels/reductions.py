"""What a signal at a block of crank angles adds to the statistics of its figures, and the figures these end up in.

What is gathered of a signal over the blocks is a row of ``TALLY`` numbers per design; nothing is kept per angle.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import inlined, kernel, reducing

Array = NDArray[np.float64]

# Statistics of a signal, flags.
EXTREMES, MEAN, SQUARES = 1, 2, 4
# What is gathered of it: largest and smallest value, mean, mean of squares, and a value from which all are counted.
HIGH, LOW, FIRST, SECOND, BASE = range(5)
TALLY: Final = 5
# Reductions, by the number that they have here.
REDUCTIONS: Final = ("peak", "mean", "rms", "max", "min", "range", "at")
# The statistics that each needs.
STATISTICS: Final = (EXTREMES, MEAN, MEAN | SQUARES, EXTREMES, EXTREMES, EXTREMES, 0)
PEAK, MEAN_VALUE, ROOT_MEAN_SQUARE, MAXIMUM, MINIMUM, RANGE, AT = range(len(REDUCTIONS))


@reducing
def _extremes(n: int, factor: float, base: float, row: Array, tally: Array) -> None:
    high, low = tally[HIGH], tally[LOW]
    for i in range(n):
        value = factor * (row[i] - base)
        high = value if value > high else high
        low = value if value < low else low
    tally[HIGH], tally[LOW] = high, low


@reducing
def _mean(n: int, factor: float, base: float, row: Array, weights: Array, tally: Array) -> None:
    total = 0.0
    for i in range(n):
        total += weights[i] * (factor * (row[i] - base))
    tally[FIRST] += total


@reducing
def _squares(n: int, factor: float, base: float, row: Array, weights: Array, tally: Array) -> None:
    total = 0.0
    for i in range(n):
        value = factor * (row[i] - base)
        total += weights[i] * (value * value)
    tally[SECOND] += total


@kernel
def gather(statistics: int, n: int, factor: float, row: Array, weights: Array, tally: Array) -> None:
    """Take up a signal, ``factor`` times a row, at the first ``n`` angles of a block."""
    base = tally[BASE]
    if statistics & EXTREMES:
        _extremes(n, factor, base, row, tally)
    if statistics & MEAN:
        _mean(n, factor, base, row, weights, tally)
    if statistics & SQUARES:
        _squares(n, factor, base, row, weights, tally)


@inlined
def finished(reduction: int, shift: float, value: float, tally: Array) -> float:
    """A figure from what has been gathered; the signal is ``shift`` more than what was, and ``value`` at its angle."""
    high, low = tally[HIGH] + shift, tally[LOW] + shift
    figure: float = value + shift
    if reduction == PEAK:
        figure = max(abs(high), abs(low))
    elif reduction == MEAN_VALUE:
        figure = tally[FIRST] + shift
    elif reduction == ROOT_MEAN_SQUARE:
        figure = math.sqrt(max(tally[SECOND] + shift * (2.0 * tally[FIRST] + shift), 0.0))
    elif reduction == MAXIMUM:
        figure = high
    elif reduction == MINIMUM:
        figure = low
    elif reduction == RANGE:
        figure = high - low
    return figure
