"""Few samples of a long curve that show as much of it as a drawing can: the extremes of its stretches."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.numerics.arrays import Array, Integers, distinct

# A run's curve is stored by the worst sample of each of so many stretches, and by the extremes of so many of the truth.
WORST: Final = 120
EXTREMES: Final = 40


def stored_curve(time: Array, angle: Array, reference: Array, error: Array) -> NDArray[np.float32]:
    """The curve that a run stores: rows of time, angle, reference and error, (4, samples), at few samples.

    The four are (n,). The samples show the reference's extremes, and that with the largest error is among them.
    """
    chosen = distinct(np.concatenate([extreme_samples(reference, EXTREMES), highest_samples(np.abs(error), WORST)]))
    return np.array([row[chosen] for row in (time, angle, reference, error)], dtype=np.float32)


def extreme_samples(values: Array, stretches: int) -> Integers:
    """Indices, ascending, of the samples that show a long curve (n,): extremes of every stretch and both ends.

    ``stretches`` is the number of stretches; a curve of no more than two samples for each is whole.
    """
    if len(values) <= 2 * stretches:
        return np.arange(len(values))
    ends = np.array([0, len(values) - 1])
    return distinct(np.concatenate([ends, highest_samples(values, stretches), highest_samples(-values, stretches)]))


def highest_samples(values: Array, stretches: int) -> Integers:
    """Indices, ascending, of the highest sample of each of a curve's stretches, equally long but for the last.

    ``stretches`` is their number; a short curve has fewer.
    """
    size = -(-len(values) // stretches) or 1
    starts = np.arange(0, len(values), size)
    padded = np.full(len(starts) * size, -np.inf)
    padded[: len(values)] = values
    return np.asarray(starts + np.argmax(padded.reshape(-1, size), axis=1), dtype=np.intp)
