"""Which samples show long curves."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MISSED: Final = 1e-3  # of a signal's largest magnitude, by which a straight line between two instants may miss it
ROUNDS: Final = 6


def needed(axis: Array, curves: Array, few: int, most: int) -> NDArray[np.intp]:
    """Which of the instants ``axis`` (n,) curves (k, n) need, so that straight lines between them show all they do.

    ``few`` are evenly spaced; of the others, up to ``most`` in all, those that the lines miss by most.
    """
    even = np.linspace(axis[0], axis[-1], min(few, len(axis)))
    places = np.unique(np.append(np.abs(np.searchsorted(0.5 * (axis[1:] + axis[:-1]), even)), len(axis) - 1))
    shown = np.nan_to_num(curves, nan=0.0, posinf=0.0, neginf=0.0)
    shown = shown / np.maximum(np.max(np.abs(shown), axis=1, keepdims=True), np.finfo(float).tiny)
    for _ in range(ROUNDS):
        lines = np.array([np.interp(axis, axis[places], curve[places]) for curve in shown])
        missed = np.max(np.abs(lines - shown), axis=0)
        worst = np.array([low + int(np.argmax(missed[low : high + 1])) for low, high in pairwise(places)])
        worst = worst[missed[worst] > MISSED]
        worst = worst[np.argsort(-missed[worst])][: most - len(places)]
        if not len(worst):
            break
        places = np.union1d(places, worst)
    return places


def extremes(values: Array, stretches: int) -> NDArray[np.intp]:
    """Indices of the lowest and the highest sample of every stretch, and of both ends; all where there are few."""
    if len(values) <= 2 * stretches:
        return np.arange(len(values))
    ends = np.array([0, len(values) - 1])
    return np.unique(np.concatenate([ends, highest(values, stretches), highest(-values, stretches)]))


def highest(values: Array, stretches: int) -> NDArray[np.intp]:
    """Index of the highest sample of every stretch, all equally long but the last."""
    size = -(-len(values) // stretches) or 1
    starts = np.arange(0, len(values), size)
    padded = np.full(len(starts) * size, -np.inf)
    padded[: len(values)] = values
    return np.asarray(starts + np.argmax(padded.reshape(-1, size), axis=1), dtype=np.intp)
