"""Numbers that record the operations on them: the closed form as one straight list of operations.

A formula written for arrays does not compute when it gets ``Traced`` numbers: every NumPy function that it calls is
noted in their ``OperationList``. An operation that is in the list already is not added again, constants are computed
at once, and sums with zero and products with zero or one fall away. The list is data: ``analytic.machine_code``
writes it as a function, and ``OperationList.evaluate`` computes it by NumPy.

The list has no branches: formulas choose by ``np.where``, and a branch on a traced number raises TypeError.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from analytic.numerics.arrays import Array
from analytic.numerics.rounded import RULES

Law = Callable[[Array, int], Array]

INPUT, CONSTANT = "input", "constant"
# What the list can have: functions of NumPy by the name they have there.
FUNCTIONS: Final[Mapping[str, Callable[..., Any]]] = {
    **{"add": np.add, "subtract": np.subtract, "multiply": np.multiply, "divide": np.divide, "negative": np.negative},
    **{"absolute": np.absolute, "sign": np.sign, "sqrt": np.sqrt, "hypot": np.hypot},
    **{"sin": np.sin, "cos": np.cos, "arctan2": np.arctan2, "maximum": np.maximum, "minimum": np.minimum},
    **{"less": np.less, "less_equal": np.less_equal, "greater": np.greater, "greater_equal": np.greater_equal},
    **{"and": np.logical_and, "or": np.logical_or, "not": np.logical_not, "where": np.where},
}
NAMES: Final = {function: name for name, function in FUNCTIONS.items()} | {
    **{np.bitwise_and: "and", np.bitwise_or: "or", np.invert: "not"},
}


@dataclass(frozen=True)
class Operation:
    """A line of the list: a function by its name in ``FUNCTIONS``, and the numbers of the lines that it takes.

    The operand of an ``INPUT`` is its number among the inputs; a ``CONSTANT`` has a value.
    """

    name: str
    operands: tuple[int, ...] = ()
    value: float = 0.0


class OperationList:
    """A list of ``operations`` that grows as formulas are applied to its numbers; ``inputs`` by their names."""

    def __init__(self) -> None:
        """An empty list."""
        self.operations: list[Operation] = []
        self.inputs: dict[Hashable, int] = {}  # the line of each
        self._lines: dict[Operation, int] = {}
        self._plans: dict[object, list[tuple[int, Operation, list[int]]]] = {}

    def input(self, name: Hashable) -> Traced:
        """The traced number of an input by name, which is added to the list if it is new."""
        if name not in self.inputs:
            self.inputs[name] = self._add_operation(Operation(INPUT, (len(self.inputs),)))
        return Traced(self, self.inputs[name])

    def line(self, number: Any) -> int:  # noqa: ANN401 - plain or traced
        """The number of the line that holds a traced number of this list, or a constant, which is added if new."""
        return (
            number.line if isinstance(number, Traced) else self._add_operation(Operation(CONSTANT, (), float(number)))
        )

    def apply(self, name: str, *numbers: Any) -> Any:  # noqa: ANN401 - plain or traced
        """Note a function, by name, of numbers and return its result: traced, or plain where constants alone decide it.

        The numbers are traced ones of this list or plain ones; the name is one of ``FUNCTIONS``. Functions that leave a
        number unchanged, such as a sum with zero, are not noted.
        """
        lines = tuple(self.line(number) for number in numbers)
        rows = [self.operations[line] for line in lines]
        values = [row.value if row.name == CONSTANT else None for row in rows]
        if None not in values:
            with np.errstate(all="ignore"):
                return float(FUNCTIONS[name](*values))
        match name, values:
            case (("multiply" | "divide" | "and"), [0.0, _]) | (("multiply" | "divide" | "and"), [_, 1.0]):
                return numbers[0]
            case (("add" | "subtract" | "or"), [_, 0.0]) | ("or", [1.0, _]):
                return numbers[0]
            case (("multiply" | "and"), [_, 0.0]) | (("multiply" | "and"), [1.0, _]) | ("where", [1.0, _, _]):
                return numbers[1]
            case (("add" | "or"), [0.0, _]) | ("or", [_, 1.0]):
                return numbers[1]
            case ("subtract", [0.0, _]) | ("multiply", [-1.0, _]):
                name, lines = "negative", lines[1:]
            case (("add" | "multiply"), _):
                lines = tuple(sorted(lines))
        return Traced(self, self._add_operation(Operation(name, lines)))

    def _add_operation(self, operation: Operation) -> int:
        """The number of an operation's line, which is added if the list does not have it."""
        if operation not in self._lines:
            self._lines[operation] = len(self.operations)
            self.operations.append(operation)
        return self._lines[operation]

    def lines_needed(self, outputs: Iterable[int], known: Iterable[int] = ()) -> list[int]:
        """Numbers, ascending, of the lines needed to compute ``outputs``, these included, from ``known`` ones.

        Known lines and inputs that are needed are among them, what only known lines need is not.
        """
        seen, given = set(outputs), set(known) | set(self.inputs.values())
        for line in range(len(self.operations) - 1, -1, -1):
            if line in seen and line not in given:
                seen.update(self.operations[line].operands)
        return sorted(seen)

    def evaluate(self, outputs: Sequence[int], known: Mapping[int, Any]) -> list[Any]:
        """The values of the lines with these numbers, computed by NumPy, in the order of ``outputs``.

        ``known`` has values by line, those of all needed inputs among them: numbers or arrays that broadcast together.
        Raises KeyError where an input's is missing.
        """
        values = dict(known)
        with np.errstate(all="ignore"):
            for line, row, spent in self._computing_order(tuple(outputs), frozenset(known)):
                values[line] = (
                    row.value
                    if row.name == CONSTANT
                    else FUNCTIONS[row.name](*[values[other] for other in row.operands])
                )
                for other in spent:
                    del values[other]  # memory that stays in the cache
        return [values[line] for line in outputs]

    def _computing_order(
        self, outputs: tuple[int, ...], known: frozenset[int]
    ) -> list[tuple[int, Operation, list[int]]]:
        """The lines to compute for the ``outputs``, in order: number, operation, lines needed for the last time there.

        Lines ``known`` are not computed. The answer is kept as long as the list does not grow.
        """
        key = (outputs, known, len(self.operations))
        if key not in self._plans:
            needed = [line for line in self.lines_needed(outputs, known) if line not in known]
            last = {other: line for line in needed for other in self.operations[line].operands}
            spent: dict[int, list[int]] = {line: [] for line in needed}
            for other in last.keys() - set(outputs):
                spent[last[other]].append(other)
            self._plans[key] = [(line, self.operations[line], spent[line]) for line in needed]
        return self._plans[key]

    def differentiated(
        self, outputs: Sequence[int], known: Mapping[int, Any], moving: Collection[int]
    ) -> list[tuple[Any, dict[int, Any]]]:
        """The values of lines, and of each its derivatives by those of the ``moving`` inputs that it depends on.

        In the order of ``outputs``: a value, and derivatives by the number of the input's line, as ``moving`` has them.
        One pass backward over the list for every line (reverse accumulation), by NumPy; ``known`` as for ``evaluate``.
        """
        needed = self.lines_needed(outputs)
        values = dict(zip(needed, self.evaluate(needed, known), strict=True))
        moved = set(moving)
        for line in needed:
            if self.operations[line].name != INPUT and not moved.isdisjoint(self.operations[line].operands):
                moved.add(line)
        result = []
        for output in outputs:
            slopes: dict[int, Any] = {output: 1.0} if output in moved else {}
            for line in reversed(needed):
                if line in slopes and line not in moving:
                    self._pass_back(line, slopes, values, moved)
            result.append((values[output], slopes))
        return result

    def _pass_back(self, line: int, slopes: dict[int, Any], values: Mapping[int, Any], moved: Collection[int]) -> None:
        """Replace a line's slope in ``slopes`` by the parts of it that belong to those operands that are ``moved``.

        The slopes, by line, are derivatives of one result by it, and are changed in place; ``values`` are those of all
        lines. A function that only steps passes nothing on.
        """
        row, slope = self.operations[line], slopes.pop(line)
        arguments = [values[other] for other in row.operands]
        with np.errstate(all="ignore"):
            if row.name == "where":
                partials = (0.0, np.where(arguments[0], 1.0, 0.0), np.where(arguments[0], 0.0, 1.0))
            elif FUNCTIONS[row.name] in RULES:
                partials = RULES[FUNCTIONS[row.name]](values[line], *arguments)
            else:
                return  # a step
            for other, partial in zip(row.operands, partials, strict=True):
                if other in moved:
                    slopes[other] = slopes.get(other, 0.0) + slope * partial


class Traced(NDArrayOperatorsMixin):
    """A number of a trace, which records every NumPy function that is applied to it."""

    __slots__ = ("line", "trace")
    __hash__ = None  # type: ignore[assignment]
    shape: tuple[int, ...] = ()
    ndim = 0

    def __init__(self, trace: OperationList, line: int) -> None:
        """The number that stands in a ``line``, by its number, of the list ``trace``."""
        self.trace, self.line = trace, line

    def __bool__(self) -> bool:
        """Raise TypeError: a traced number has no value yet, so that no formula may branch on it."""
        raise TypeError("expected a formula without branches on its numbers, got one that branches; use np.where")

    def __array__(self, *_: object, **__: object) -> Array:
        """Raise TypeError: a traced number has no value yet to put into an array."""
        raise TypeError("expected a formula of NumPy's functions, got one that makes a plain array of a traced number")

    def looked_up(self, law: Law, order: int) -> list[Traced]:
        """Components of a law, which has a table, at this number, as a list, or of its derivative of an ``order``.

        Of a law over φ they are inputs, (law, order, component), added to the list. A law over S is computed in the
        list by its formula, value only: ``order`` has to be 0 there and is not looked at.
        """
        if getattr(law, "over", "phi") == "S":
            return law.formula(self)  # type: ignore[attr-defined,no-any-return]
        return [self.trace.input((law, order, row)) for row in range(len(law(np.zeros(()), order)))]

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:  # noqa: ANN401
        """Note the operation in the list instead of computing it, and return the traced result.

        NotImplemented for functions that the list does not have, for arrays and for options other than ``out``.
        """
        # An ``out``, that of array += traced, is left as it was: what is returned takes its name.
        if method != "__call__" or options or any(np.ndim(entry) for entry in inputs):
            return NotImplemented
        if ufunc is np.square or (ufunc is np.power and inputs[1] == 2):
            return self.trace.apply("multiply", inputs[0], inputs[0])
        return self.trace.apply(NAMES[ufunc], *inputs) if ufunc in NAMES else NotImplemented

    def __array_function__(self, function: Any, _: object, inputs: Any, options: Any) -> Any:  # noqa: ANN401
        """Apply one of the functions in ``SHAPING``: ``np.where``, which is noted, or one that only arranges numbers.

        NotImplemented for others.
        """
        return SHAPING[function](*inputs, **options) if function in SHAPING else NotImplemented


def _where(*numbers: Any) -> Any:  # noqa: ANN401 - plain or traced
    """Note NumPy's ``where`` of condition, value and other value in the list; the result, traced or plain."""
    trace: OperationList = next(number.trace for number in numbers if isinstance(number, Traced))
    return trace.apply("where", *numbers)


# Of numbers that are no arrays little is left to be done.
SHAPING: Final[Mapping[Any, Callable[..., Any]]] = {
    np.where: _where,
    np.stack: list,
    np.broadcast_to: lambda number, _: number,
    np.copy: lambda number: number,
    np.any: lambda _: True,
    np.shape: lambda _: (),
    np.ndim: lambda _: 0,
}
