"""Means of many curves over an interval: Gauss's rule on cells that are halved until the halves agree with the whole.

Evenly spaced samples do for smooth periodic curves; the spike of a torque beside a dead position is far narrower than
their step, and over less than a turn they err by its square.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.numerics.arrays import Array

Integers = NDArray[np.int64]
# Integrands (k, n, m) of rows (n,) at places (n, m).
Integrands = Callable[[Integers, Array], Array]

COUNT: Final = 8  # nodes of a cell
NODES: Final = 0.5 + 0.5 * np.polynomial.legendre.leggauss(COUNT)[0]
WEIGHTS: Final = 0.5 * np.polynomial.legendre.leggauss(COUNT)[1]
# Relative agreement of a cell's two halves with the whole; the halves are then about 2^16 times more accurate where the
# curve is smooth, and a few times where it has a kink.
SAME: Final = 1e-10
LEVELS: Final = 40
MOST: Final = 128  # cells of a row that still differ: of more the integrand is nothing but rounding


def averages(integrands: Integrands, edges: Array, rows: int = 1) -> Array:
    """Means (k, rows) of k integrands over the interval that ascending ``edges`` divide; of one with a nan it is nan.

    ``integrands(row, places)`` gives values (k, n, m) for the numbers (n,) of rows, such as designs, at places (n, m).
    The edges are those of every row; one at a jump saves work. The mean over an interval without length is the value
    there.
    """
    start, width = np.tile(edges[:-1], rows), np.tile(np.diff(edges), rows)
    row = np.repeat(np.arange(rows), len(edges) - 1)
    length = edges[-1] - edges[0]
    share = width / length if length else np.full(len(width), 1.0 / (len(edges) - 1))
    parts, _ = _cell_integrals(integrands, row, start, width, share)
    means, sizes = np.zeros((2, len(parts), rows))
    rough = np.zeros(means.shape, dtype=bool)
    for level in range(LEVELS):
        whole, row_of_cell = parts, row
        start, width = np.concatenate([start, start + 0.5 * width]), np.tile(0.5 * width, 2)
        row, share = np.tile(row, 2), np.tile(0.5 * share, 2)
        parts, magnitudes = _cell_integrals(integrands, row, start, width, share)
        halves = parts.reshape(len(parts), 2, -1).sum(axis=1)
        scale = sizes + _sums(magnitudes, row, rows)
        off = np.abs(halves - whole) > SAME * scale[:, row_of_cell]
        rough |= _sums(off, row_of_cell, rows) > MOST
        wide = np.any(off & ~rough[:, row_of_cell], axis=0) & (level < LEVELS - 1)
        means += _sums(halves[:, ~wide], row_of_cell[~wide], rows)
        both = np.tile(wide, 2)
        sizes += _sums(magnitudes[:, ~both], row[~both], rows)
        if not np.any(wide):
            break
        start, width, row, share, parts = start[both], width[both], row[both], share[both], parts[:, both]
    return means


def _cell_integrals(
    integrands: Integrands, row: Integers, start: Array, width: Array, share: Array
) -> tuple[Array, Array]:
    """Contributions of cells (n,) to the means of k integrands, and to those of their magnitudes: (k, n).

    A cell has the number of its ``row``, its ``start`` and ``width`` in the places' unit, and its ``share`` of the
    whole interval, 0 to 1. ``integrands`` is called as in ``averages``.
    """
    values = integrands(row, start[:, None] + width[:, None] * NODES)
    return np.sum(values * WEIGHTS, axis=2) * share, np.sum(np.abs(values) * WEIGHTS, axis=2) * share


def _sums(parts: Array, row: Integers, rows: int) -> Array:
    """Sums of parts (k, n) row by row, (k, rows); ``row`` (n,) is the number of each part's row, below ``rows``."""
    return np.array([np.bincount(row, part, rows) for part in parts])
