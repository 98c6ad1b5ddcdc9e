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
    """Where means of evenly spaced samples of a turn are right: where every second sample gives the same mean.

    The tolerance is a share of the signal's RMS, its ``size``; the error for smooth signals is the gap squared.
    """
    return np.abs(whole - half) <= SAME * size


def edges_of(grid: Array) -> Array:
    """The cells from which means over a grid's whole length are integrated."""
    return np.linspace(grid[0], grid[-1], CELLS + 1)


def on_branch(values: Any, phi: Array, places: Array, near: Array | None) -> Any:  # noqa: ANN401 - plain or dual
    """Angles at ``phi`` (..., n) with the whole turns of samples ``near`` (..., places) that are unwrapped, if any."""
    if near is None:
        return values
    here = np.searchsorted(places, phi, "right") - 1
    known = near[here] if near.ndim == 1 else np.take_along_axis(near, here, 1)
    plain = values.value if isinstance(values, Dual) else values
    return values + FULL_TURN * np.round((known - plain) / FULL_TURN)
