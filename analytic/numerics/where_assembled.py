"""Functions of the crank angle over a turn, of a crank that may not be able to make one."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from analytic.errors import AssemblyError

Array = NDArray[np.float64]
_Angles = TypeVar("_Angles", Array, NDArray[np.int64])


def where_assembled(function: Callable[[_Angles], Array], angle: _Angles, rows: tuple[int, ...] = ()) -> Array:
    """A function at every angle (n,), rad or by number, nan where the linkage is not assembled or stuck; (*rows, n)."""
    try:
        return function(angle)
    except AssemblyError:
        if len(angle) == 1:
            return np.full((*rows, 1), np.nan)
        halves = np.split(angle, [len(angle) // 2])
        return np.concatenate([where_assembled(function, half, rows) for half in halves], axis=-1)
