"""Functions of the crank angle that are nan where the linkage cannot be assembled."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from analytic.errors import AssemblyError

Array = NDArray[np.float64]


def where_assembled(function: Callable[[Array], Array], angle: Array) -> Array:
    """A function at every angle (n,), rad, nan where the linkage is not assembled or stuck."""
    try:
        return function(angle)
    except AssemblyError:
        if len(angle) == 1:
            return np.full(1, np.nan)
        halves = np.split(angle, [len(angle) // 2])
        return np.concatenate([where_assembled(function, half) for half in halves], axis=-1)
