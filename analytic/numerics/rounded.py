"""Numbers that carry a bound on their error: the rounding of a formula written for arrays, and its inherited errors.

Running error analysis (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 3.3) to the first
order, by the derivatives in ``dual.RULES``.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, NDArray

from analytic.numerics.dual import RULES

Array = NDArray[np.float64]
EPS: Final = float(np.finfo(float).eps)
UNIT: Final = 0.5 * EPS  # of a result, what one operation rounds away


class Rounded(NDArrayOperatorsMixin):
    """An array ``value`` with the ``bound`` on its error, of the same shape; if none is given, that of one rounding."""

    __slots__ = ("bound", "value")

    def __init__(self, value: ArrayLike, bound: Array | None = None) -> None:
        self.value: Any = np.asarray(value, dtype=float)
        self.bound: Any = UNIT * np.abs(self.value) if bound is None else bound

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:  # noqa: ANN401
        if method != "__call__" or options or ufunc not in RULES:
            return NotImplemented
        values = [item.value if isinstance(item, Rounded) else item for item in inputs]
        result = ufunc(*values)
        partials = RULES[ufunc](result, *values)
        bound = UNIT * np.abs(result)
        for partial, entry in zip(partials, inputs, strict=True):
            if isinstance(entry, Rounded):
                bound = bound + np.abs(partial) * entry.bound
        return Rounded(result, bound)


def bound_of(number: Any) -> Any:  # noqa: ANN401 - a number that carries one, or a plain one, which is exact
    """The bound on a number's error."""
    return number.bound if isinstance(number, Rounded) else 0.0
