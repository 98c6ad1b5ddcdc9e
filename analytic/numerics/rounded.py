"""Numbers that carry a bound on their error: the rounding of a formula written for arrays, and its inherited errors.

Running error analysis (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 3.3) to the first
order, by the derivatives of NumPy's functions in ``RULES``, by which lists of operations are differentiated as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike

from analytic.numerics.arrays import Array

Rule = Callable[..., tuple[Any, ...]]

# Of each function its derivatives by its arguments, from its result and the arguments.
RULES: Final[Mapping[Any, Rule]] = {
    np.add: lambda _, a, b: (1.0, 1.0),
    np.subtract: lambda _, a, b: (1.0, -1.0),
    np.multiply: lambda _, a, b: (b, a),
    np.divide: lambda r, a, b: (1.0 / b, -r / b),
    np.negative: lambda _, a: (-1.0,),
    np.positive: lambda _, a: (1.0,),
    np.absolute: lambda _, a: (np.sign(a),),
    np.sqrt: lambda r, a: (0.5 / r,),
    np.square: lambda _, a: (2.0 * a,),
    np.power: lambda _, a, b: (b * a ** (b - 1), np.nan),  # exponents are constants
    np.sin: lambda _, a: (np.cos(a),),
    np.cos: lambda _, a: (-np.sin(a),),
    np.hypot: lambda r, a, b: (a / r, b / r),
    np.arctan2: lambda _, a, b: (b / (a * a + b * b), -a / (a * a + b * b)),
    np.maximum: lambda _, a, b: (np.where(a >= b, 1.0, 0.0), np.where(a >= b, 0.0, 1.0)),
    np.minimum: lambda _, a, b: (np.where(a <= b, 1.0, 0.0), np.where(a <= b, 0.0, 1.0)),
}

EPS: Final = float(np.finfo(float).eps)
UNIT: Final = 0.5 * EPS  # of a result, what one operation rounds away


class Rounded(NDArrayOperatorsMixin):
    """An array ``value`` with the ``bound`` on its error, of the same shape; if none is given, that of one rounding."""

    __slots__ = ("bound", "value")

    def __init__(self, value: ArrayLike, bound: Array | None = None) -> None:
        """A number with a ``bound`` of its error, by default half a unit in its last place."""
        self.value: Any = np.asarray(value, dtype=float)
        self.bound: Any = UNIT * np.abs(self.value) if bound is None else bound

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:  # noqa: ANN401
        """Apply a function of NumPy and carry the bounds through it, with the rounding of its own, into a new number.

        NotImplemented for a function without a rule in ``RULES``, and for its methods and options.
        """
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
    """The bound on a number's error; 0 for a plain number."""
    return number.bound if isinstance(number, Rounded) else 0.0
