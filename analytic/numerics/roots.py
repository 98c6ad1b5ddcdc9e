"""The root of a function of one number within a bracket."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

MOST_STEPS: Final = 200


def root(function: Callable[[float], float], left: float, right: float) -> float:
    """Where a continuous function that changes sign between ``left`` and ``right`` is zero, to the last digits.

    The Illinois method: false position, with the value at the end that stays halved, so that neither end is stuck.
    """
    low, high = function(left), function(right)
    for _ in range(MOST_STEPS):
        if low == 0.0 or high == 0.0 or abs(right - left) <= 0.0:
            break
        middle = right - high * (right - left) / (high - low)
        if not min(left, right) < middle < max(left, right):
            middle = 0.5 * (left + right)
            if middle in (left, right):
                break
        value = function(middle)
        if (value > 0.0) == (high > 0.0) and value != 0.0:
            low *= 0.5
        else:
            left, low = right, high
        right, high = middle, value
    return right if abs(high) <= abs(low) else left
