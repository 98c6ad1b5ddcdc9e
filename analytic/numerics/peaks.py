"""The highest values of many curves at once, refined beyond the grid they are sampled on.

Unlike ``extremes`` the curves need not be periodic, and they may jump between two neighbours of the grid: a curve is
looked at on either side of a jump, never across it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TOPS: Final = 3  # sampled tops of a curve that are looked at more closely: of more, the highest
# Each look divides both sides of a bracket by PARTS: half a degree becomes 1e-7 rad in eight looks, and a smooth top is
# then exact, for it errs by the square of that.
PARTS, LOOKS = 4, 8
ROUNDING: Final = 1e-12  # of a curve's largest value: of tops that differ by less the first is taken, on every machine


def highest(curves: Callable[[Array], Array], grid: Array, values: Array) -> tuple[Array, Array]:
    """The highest value of every curve between the ends of the grid, and its place: two arrays (k,).

    Of equal ones it is the first. ``curves`` gives k curves at places (m,) as (k, m); ``values`` (k, n) are theirs on
    the ascending ``grid`` (n,). A top narrower than two steps of the grid may be missed.
    """
    sides, row = brackets(grid, values), np.arange(len(values))
    share = np.linspace(0.0, 1.0, PARTS + 1)
    for _ in range(LOOKS):
        low, middle, high = (sides[..., side, None] for side in range(3))
        near = np.concatenate([low + (middle - low) * share[:-1], middle + (high - middle) * share], axis=2)
        seen = curves(near.ravel()).reshape(len(row), *near.shape)[row, row]
        best = np.argmax(seen, axis=2)[..., None]
        heights = np.take_along_axis(seen, best, 2)[..., 0]
        best = np.where(heights[..., None] > seen[..., PARTS, None], best, PARTS)  # not an empty left side
        beside = np.clip(best + np.array([-1, 0, 1]), 0, near.shape[2] - 1)
        sides = np.take_along_axis(near, beside, 2)
    places = sides[:, :, 1]
    equal = heights >= np.max(heights, axis=1, keepdims=True) - ROUNDING * np.max(np.abs(values), axis=1, keepdims=True)
    first = np.argmin(np.where(equal, places, np.inf), axis=1)
    return heights[row, first], places[row, first]


def brackets(grid: Array, values: Array) -> Array:
    """Places left of, at and right of the highest sampled tops of every curve, (k, TOPS, 3)."""
    walled = np.pad(values, ((0, 0), (1, 1)), constant_values=-np.inf)
    is_top = (values >= walled[:, :-2]) & (values >= walled[:, 2:])
    least = ROUNDING * np.max(np.abs(values), axis=1, keepdims=True)
    levels = np.round(values / np.where(least, least, 1.0))
    tops = np.argsort(np.where(is_top, -levels, np.inf), axis=1, kind="stable")[:, :TOPS]
    return np.stack([grid[np.clip(tops + side, 0, len(grid) - 1)] for side in (-1, 0, 1)], axis=2)
