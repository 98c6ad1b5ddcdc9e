"""Numbers that carry their derivatives: formulas written for arrays give exact derivatives when they get these.

Forward differentiation. A NumPy function in a formula acts on a ``Dual`` as on an array, by the rules
of ``RULES`` and ``FUNCTIONS``; any other raises TypeError, lest a derivative be lost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class Dual(NDArrayOperatorsMixin):
    """An array ``value`` of any shape with its derivatives by k variables, ``slopes`` (k, ...).

    ``slopes`` has one dimension more than ``value``, and is of its shape or broadcasts to it: ``full`` is of its shape.
    It is never a plain zero, so that no formula leaves it out, and it compares as its value does.
    """

    __slots__ = ("slopes", "value")

    def __init__(self, value: ArrayLike, slopes: Array) -> None:
        self.value: Any = np.asarray(value, dtype=float)
        self.slopes = slopes

    @property
    def full(self) -> Array:
        """Derivatives, (k, *shape)."""
        return np.broadcast_to(self.slopes, (len(self.slopes), *self.shape))

    @property
    def shape(self) -> tuple[int, ...]:
        """That of the value."""
        return np.shape(self.value)

    @property
    def ndim(self) -> int:
        """Dimensions of the value."""
        return np.ndim(self.value)

    def looked_up(self, law: Callable[[Array, int], Array], order: int) -> Dual:
        """A function of this number, or its derivative of an order, (m, ...): from values and the next derivative."""
        return Dual(law(self.value, order), law(self.value, order + 1) * self.slopes[:, None])

    def __getitem__(self, key: Any) -> Dual:  # noqa: ANN401 - whatever an array takes
        keys = key if isinstance(key, tuple) else (key,)
        return Dual(self.value[keys], self.full[(slice(None), *keys)])

    def __array__(self, *_: object, **__: object) -> Array:
        raise TypeError("expected a formula of arrays that keeps derivatives, got one that makes a plain array of them")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:  # noqa: ANN401
        # An ``out``, that of array += dual, is left as it was: what is returned takes its name.
        if method != "__call__" or options:
            return NotImplemented
        values = [entry.value if isinstance(entry, Dual) else entry for entry in inputs]
        if ufunc in WITHOUT:
            return ufunc(*values)
        if ufunc not in RULES:
            return NotImplemented
        result = ufunc(*values)
        partials = RULES[ufunc](result, *values)
        parts = [
            partial * _padded(entry.slopes, np.ndim(result))
            for partial, entry in zip(partials, inputs, strict=True)
            if isinstance(entry, Dual)
        ]
        return Dual(result, parts[0] if len(parts) == 1 else parts[0] + parts[1])

    def __array_function__(self, function: Any, _: object, inputs: Any, options: Any) -> Any:  # noqa: ANN401
        return FUNCTIONS[function](*inputs, **options) if function in FUNCTIONS else NotImplemented


Rule = Callable[..., tuple[Any, ...]]

# Of each function its derivatives by its arguments, from its result and the arguments.
RULES: Final[Mapping[np.ufunc, Rule]] = {
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
# Of no or a vanishing derivative.
WITHOUT: Final = frozenset({
    *(np.equal, np.not_equal, np.less, np.less_equal, np.greater, np.greater_equal),
    *(np.isfinite, np.isnan, np.sign, np.signbit),
})  # fmt: skip


def _padded(slopes: Array, dimensions: int) -> Array:
    """Derivatives of an argument with the axes that a result of more dimensions has."""
    missing = dimensions + 1 - slopes.ndim
    return slopes.reshape(len(slopes), *[1] * missing, *slopes.shape[1:]) if missing > 0 else slopes


def _parts(numbers: Sequence[Any]) -> tuple[list[Any], list[Array]]:
    """Values and derivatives of several numbers, plain ones among them, which have none."""
    count = next(len(number.slopes) for number in numbers if isinstance(number, Dual))
    values = [number.value if isinstance(number, Dual) else np.asarray(number, dtype=float) for number in numbers]
    slopes = [number.full if isinstance(number, Dual) else np.zeros((count, *np.shape(number))) for number in numbers]
    return values, slopes


def _where(condition: ArrayLike, yes: Any, no: Any) -> Dual:  # noqa: ANN401 - duals or plain
    values, slopes = _parts((yes, no))
    result = np.where(condition, *values)
    return Dual(result, np.where(condition, *(_padded(slope, result.ndim) for slope in slopes)))


def _stack(numbers: Sequence[Any]) -> Dual:
    values, slopes = _parts(numbers)
    return Dual(np.stack(values), np.stack(slopes, axis=1))


def _broadcast(number: Dual, shape: tuple[int, ...]) -> Dual:
    slopes = np.broadcast_to(_padded(number.slopes, len(shape)), (len(number.slopes), *shape))
    return Dual(np.broadcast_to(number.value, shape), slopes)


FUNCTIONS: Final[Mapping[Any, Callable[..., Any]]] = {
    np.where: _where,
    np.stack: _stack,
    np.broadcast_to: _broadcast,
    np.copy: lambda number: number,
    np.unwrap: lambda number: Dual(np.unwrap(number.value), number.slopes),
    np.shape: lambda number: number.shape,
    np.any: lambda _: True,
}


# Numbers that carry a bound on their error: the rounding of a formula written for arrays, and its inherited errors.
#
# Running error analysis (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 3.3) to the
# first order, by the derivatives in ``dual.RULES``.

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
