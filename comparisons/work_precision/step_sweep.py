"""A sweep of steps: the order its error falls with, whether refining still pays, what an error costs along it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# The order is fitted to errors below the first bound (no solution) and above the second (no step error).
SATURATED = 0.3
ABOVE_FLOOR = 3.0
# Local slopes that differ from the order by less than this are the same slope, seen through scatter.
SLOPE_SHARE, SLOPE_ROOM = 0.25, 0.3
LEAST_POINTS, LEAST_ORDER, LEAST_DROP = 3, 0.4, 3.0
# A refinement that takes less than this factor off no longer improves.
LEAST_GAIN = 1.5


def is_falling(errors: Sequence[float]) -> bool:
    """Whether the finest step has the least error, smaller by more than scatter than that of the step before."""
    if len(errors) < 2 or int(np.argmin(errors)) < len(errors) - 1 or errors[-1] <= 0.0:
        return False
    return errors[-2] / errors[-1] >= LEAST_GAIN


def observed_order(steps: Sequence[float], errors: Sequence[float]) -> float | None:
    """Slope of log error over log step where it is steady; None unless three points agree on it.

    The longest run of refinements counts, of equal ones the finest, whose local slopes agree with their own Theil-Sen
    slope, which an outlier does not move. Points at the floor or past it, and those so wrong that they are no solution,
    are left out.
    """
    best, log_steps = int(np.argmin(errors)), np.log(np.asarray(steps, dtype=float))
    log_errors = np.log(np.maximum(np.asarray(errors, dtype=float), np.finfo(float).tiny))
    lowest = log_errors[best] + (0.0 if is_falling(errors) else math.log(ABOVE_FLOOR))
    usable = [k for k in range(best + 1) if lowest <= log_errors[k] <= math.log(SATURATED)]
    windows: list[tuple[int, int, float]] = []
    for first in range(len(usable)):
        for end in range(first + LEAST_POINTS, len(usable) + 1):
            window = usable[first:end]
            slope = _steady_slope(log_steps[window], log_errors[window])
            windows += [(len(window), window[-1], slope)] if slope is not None else []
    return max(windows)[2] if windows else None


def theil_sen(x: Array, y: Array) -> float:
    """Median of the slopes between all pairs of points (P. K. Sen, J. Am. Stat. Assoc. 63, 1968).

    SciPy's also works out a confidence interval, which costs ten times as much and is not wanted here.
    """
    first, second = np.triu_indices(len(x), 1)
    return float(np.median((y[second] - y[first]) / (x[second] - x[first])))


def _steady_slope(steps: Array, errors: Array) -> float | None:
    """The slope of a window whose every refinement has that slope, near enough."""
    slope = theil_sen(steps, errors)
    local = np.diff(errors) / np.diff(steps)
    steady = bool(np.all(np.abs(local - slope) <= SLOPE_SHARE * abs(slope) + SLOPE_ROOM))
    return slope if steady and slope >= LEAST_ORDER and errors[0] - errors[-1] >= math.log(LEAST_DROP) else None


def still_improves(errors: Sequence[float]) -> bool:
    """Whether another refinement is worth its price: not after two in a row without a smaller error."""
    if len(errors) < LEAST_POINTS:
        return True
    return min(errors[-2:]) * LEAST_GAIN < min(errors[:-2])


def pareto(costs: Sequence[float], errors: Sequence[float]) -> NDArray[np.bool_]:
    """Which of the points (n,) no other beats, that is, is at most as dear and as wrong, and less in one of the two."""
    order = np.lexsort((errors, costs))
    unbeaten = np.zeros(len(costs), dtype=bool)
    least, at = math.inf, math.nan
    for k in order:
        # Sorted by cost, then error: only a smaller error, or a twin of the last point on the front, is not beaten.
        if errors[k] < least or (errors[k] == least and costs[k] == at):
            unbeaten[k] = True
            least, at = errors[k], costs[k]
    return unbeaten


def sustained(errors: Sequence[float], limit: float) -> int | None:
    """Place of the coarsest step from which on every finer one, down to the smallest error, is at or below ``limit``.

    A coarse step can be right by accident; one that the next finer step contradicts is not to be relied on. None where
    the error is never reached.
    """
    place = int(np.argmin(errors))
    if errors[place] > limit:
        return None
    while place > 0 and errors[place - 1] <= limit:
        place -= 1
    return place


def price(costs: Sequence[float], errors: Sequence[float], limit: float) -> float | None:
    """The cost at which the error of a sweep, coarse to fine, falls to ``limit``, by logarithms between two points.

    None where it never gets there.
    """
    place = sustained(errors, limit)
    if place is None:
        return None
    if place == 0 or errors[place] <= 0.0:
        return float(costs[place])
    above, below = math.log(errors[place - 1] / limit), math.log(limit / errors[place])
    share = above / (above + below)
    return math.exp((1.0 - share) * math.log(costs[place - 1]) + share * math.log(costs[place]))
