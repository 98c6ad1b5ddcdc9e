"""Means of designs: when samples show them, and where they are integrated; angles of links on the branch of samples."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.numerics.averages import SAME
from analytic.numerics.dual import Dual

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]

CELLS: Final = 12  # of the motion, from which a mean is integrated


def is_settled(whole: Array, half: Array, size: Array) -> Booleans:
    """Where means of evenly spaced samples of a turn are right: every second sample gives the same mean.

    The tolerance is a share of the signal's RMS, its ``size``; the error for smooth signals is the gap squared.
    """
    return np.abs(whole - half) <= SAME * size


def mean_cells(grid: Array) -> Array:
    """The ends, rad, of the cells from which means over a grid's whole length are integrated."""
    return np.linspace(grid[0], grid[-1], CELLS + 1)


def unwrapped_near(values: Any, phi: Array, places: Array, samples: Array | None) -> Any:  # noqa: ANN401 - plain or dual
    """Values at ``phi`` (..., n) with whole turns added, as the unwrapped ``samples`` at ``places`` have them.

    Without ``samples``, for signals that are no angles of links, the values as they are.
    """
    if samples is None:
        return values
    here = np.searchsorted(places, phi, "right") - 1
    known = samples[here] if samples.ndim == 1 else np.take_along_axis(samples, here, 1)
    plain = values.value if isinstance(values, Dual) else values
    return values + FULL_TURN * np.round((known - plain) / FULL_TURN)
