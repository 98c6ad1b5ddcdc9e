"""Names of arrays by what they hold, and the distinct values of one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Integers = NDArray[np.intp]


def distinct(values: ArrayLike) -> NDArray[Any]:
    """The values, of any shape, as a flat array, ascending and each once.

    ``np.unique`` imports ``numpy.ma``, a tenth of the time of NumPy itself.
    """
    ordered = np.sort(np.ravel(values))
    return np.asarray(ordered[np.append(True, ordered[1:] != ordered[:-1])[: len(ordered)]])
