"""Cost against error: the points that no other beats, and what an error costs along a sweep."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def pareto(costs: Sequence[float], errors: Sequence[float]) -> NDArray[np.bool_]:
    """Which of the points (n,) no other beats: none is as cheap and as exact and better in one of the two."""
    order = np.lexsort((errors, costs))
    kept = np.zeros(len(costs), dtype=bool)
    least, at = math.inf, math.nan
    for k in order:
        # Sorted by cost, then error: only a smaller error, or a twin of the point kept last, is not beaten.
        if errors[k] < least or (errors[k] == least and costs[k] == at):
            kept[k] = True
            least, at = errors[k], costs[k]
    return kept


def sustained(errors: Sequence[float], wanted: float) -> int | None:
    """Place of the coarsest step from which on every finer one, down to the smallest error, is at or below ``wanted``.

    A coarse step can be right by accident; one that the next finer step contradicts is not to be relied on. None where
    the error is never reached.
    """
    place = int(np.argmin(errors))
    if errors[place] > wanted:
        return None
    while place > 0 and errors[place - 1] <= wanted:
        place -= 1
    return place


def price(costs: Sequence[float], errors: Sequence[float], wanted: float) -> float | None:
    """What a sweep, coarse to fine, costs where its error falls to ``wanted``, by logarithms between two points.

    None where it never gets there.
    """
    place = sustained(errors, wanted)
    if place is None:
        return None
    if place == 0 or errors[place] <= 0.0:
        return float(costs[place])
    above, below = math.log(errors[place - 1] / wanted), math.log(wanted / errors[place])
    share = above / (above + below)
    return math.exp((1.0 - share) * math.log(costs[place - 1]) + share * math.log(costs[place]))
