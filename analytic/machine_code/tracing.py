"""Numbers that record the operations on them: the closed form as one straight list of operations.

A formula written for arrays does not compute when it gets ``Traced`` numbers: every NumPy function that it calls is
noted in their ``OperationList``. An operation that is in the list already is not added again, constants are computed at
once, and sums with zero and products with zero or one fall away. The list is data: ``analytic.machine_code.compiling``
writes it as a function, and ``OperationList.computed`` computes it by NumPy.

The list has no branches: formulas choose by ``np.where``, and a branch on a traced number raises TypeError.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import SPEED, with_numbers
from analytic.errors import LinkproofError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.groups.solver import GroupSolver
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.moving import MovingSweep
from analytic.signals import signal

Array = NDArray[np.float64]
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
    """A line of the list: a function by name and the lines that it takes.

    The operand of an ``INPUT`` is its number among the inputs; a ``CONSTANT`` has a value.
    """

    name: str
    operands: tuple[int, ...] = ()
    value: float = 0.0


class OperationList:
    """A list of ``operations`` that grows as formulas are applied to its numbers; ``inputs`` by their names."""

    def __init__(self) -> None:
        self.operations: list[Operation] = []
        self.inputs: dict[Hashable, int] = {}  # the line of each
        self._lines: dict[Operation, int] = {}

    def input(self, name: Hashable) -> Traced:
        """A number that is given from outside, always the same for one name."""
        if name not in self.inputs:
            self.inputs[name] = self._add_operation(Operation(INPUT, (len(self.inputs),)))
        return Traced(self, self.inputs[name])

    def line(self, number: Any) -> int:  # noqa: ANN401 - plain or traced
        """The line of a number of this trace, or of a constant."""
        return (
            number.line if isinstance(number, Traced) else self._add_operation(Operation(CONSTANT, (), float(number)))
        )

    def apply(self, name: str, *numbers: Any) -> Any:  # noqa: ANN401 - plain or traced
        """A function of numbers, noted; a plain number where all of them are constants."""
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
        """The line of an operation, which is added if the list does not have it."""
        if operation not in self._lines:
            self._lines[operation] = len(self.operations)
            self.operations.append(operation)
        return self._lines[operation]

    def lines_needed(self, outputs: Iterable[int], known: Iterable[int] = ()) -> list[int]:
        """The lines needed to compute ``outputs``, these included, in order; nothing that only ``known`` lines need."""
        seen, given = set(outputs), set(known) | set(self.inputs.values())
        for line in range(len(self.operations) - 1, -1, -1):
            if line in seen and line not in given:
                seen.update(self.operations[line].operands)
        return sorted(seen)

    def evaluate(self, outputs: Sequence[int], known: Mapping[int, Any]) -> list[Any]:
        """The values of the lines with these numbers, computed by NumPy, in the order of ``outputs``.

        ``known`` has values by line, those of all needed inputs among them: arrays that broadcast together.
        """
        needed = self.lines_needed(outputs, known)
        last = {other: line for line in needed if line not in known for other in self.operations[line].operands}
        values = {line: known[line] for line in needed if line in known}
        numbers = set(outputs)
        with np.errstate(all="ignore"):
            for line in needed:
                if line in values:
                    continue
                row = self.operations[line]
                if row.name == CONSTANT:
                    values[line] = row.value
                    continue
                values[line] = FUNCTIONS[row.name](*(values[other] for other in row.operands))
                for other in set(row.operands) - numbers:
                    if last[other] == line:
                        del values[other]  # memory that stays in the cache
        return [values[line] for line in outputs]


class Traced(NDArrayOperatorsMixin):
    """A number of a trace, which records every NumPy function that is applied to it."""

    __slots__ = ("line", "trace")
    __hash__ = None  # type: ignore[assignment]
    shape: tuple[int, ...] = ()
    ndim = 0

    def __init__(self, trace: OperationList, line: int) -> None:
        self.trace, self.line = trace, line

    def __bool__(self) -> bool:
        raise TypeError("expected a formula without branches on its numbers, got one that branches; use np.where")

    def __array__(self, *_: object, **__: object) -> Array:
        raise TypeError("expected a formula of NumPy's functions, got one that makes a plain array of a traced number")

    def looked_up(self, law: Law, order: int) -> list[Traced]:
        """Components of a law of this angle, or of its derivative of an order: inputs, (law, order, component)."""
        return [self.trace.input((law, order, row)) for row in range(len(law(np.zeros(()), order)))]

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:  # noqa: ANN401
        # An ``out``, that of array += traced, is left as it was: what is returned takes its name.
        if method != "__call__" or options or any(np.ndim(entry) for entry in inputs):
            return NotImplemented
        if ufunc is np.square or (ufunc is np.power and inputs[1] == 2):
            return self.trace.apply("multiply", inputs[0], inputs[0])
        return self.trace.apply(NAMES[ufunc], *inputs) if ufunc in NAMES else NotImplemented

    def __array_function__(self, function: Any, _: object, inputs: Any, options: Any) -> Any:  # noqa: ANN401
        return SHAPING[function](*inputs, **options) if function in SHAPING else NotImplemented


def _where(*numbers: Any) -> Any:  # noqa: ANN401 - plain or traced
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


# The signals of a linkage as one list of operations: of its crank angle, the crank's motion and numbers that vary.


PHI, ACCELERATION = ("crank angle", "crank acceleration")  # no numbers' names
OF_DESIGN, OF_PLACE = 1, 2


class TracedSweep(Sweep):
    """A sweep of traced numbers: where its groups can move is noted in ``moves`` in place of being checked."""

    moves: Any = True

    def _handle_assembly(self, solver: DyadSolver | GroupSolver) -> None:
        self.moves = solver.moves if self.moves is True else self.moves & solver.moves

    def _check_motion(self, solver: DyadSolver | GroupSolver) -> None:
        """Nothing to check: ``_handle_assembly`` has recorded where the group can move."""


@dataclass(frozen=True, eq=False)
class LinkageTrace:
    """Lines of the signals of designs that differ in ``varied`` numbers, and of whether all groups needed can move.

    ``determinants`` are those of the dyads, magnitudes. Inputs of the ``trace`` are the numbers by name, ``PHI``,
    ``SPEED``, ``ACCELERATION`` and laws over φ, which are named (law, order, component).
    """

    trace: OperationList
    varied: frozenset[str]
    signals: tuple[int, ...]
    moves: int
    determinants: tuple[int, ...]

    @property
    def lines(self) -> tuple[int, ...]:
        """Line numbers of the results: the signals, whether it moves, the determinants."""
        return (*self.signals, self.moves, *self.determinants)

    def values(
        self, numbers: Mapping[str, Any], phi: ArrayLike = 0.0, speed: ArrayLike = 0.0, acceleration: ArrayLike = 0.0
    ) -> dict[int, Any]:
        """Values of the inputs by line: ``numbers`` by name, the crank's angle or stroke, speed, acceleration, SI."""
        known = {**numbers, PHI: phi, SPEED: speed, ACCELERATION: acceleration}
        table: dict[int, Any] = {}
        for name, line in self.trace.inputs.items():
            if isinstance(name, tuple):
                law, order, component = name
                table[line] = law(phi, order)[component]
            elif name in known:
                table[line] = known[name]
        return table

    def split_inputs(self, outputs: Iterable[int]) -> tuple[list[int], list[int]]:
        """Lines that depend on the design alone, and lines that depend on the crank alone, from which outputs follow.

        Each can be computed once and shared.
        """
        parts = dict.fromkeys(range(len(self.trace.operations)), 0)
        for name, line in self.trace.inputs.items():
            parts[line] = OF_DESIGN if name in self.varied else OF_PLACE
        for line, operation in enumerate(self.trace.operations):
            if operation.name != INPUT:
                for other in operation.operands:
                    parts[line] |= parts[other]
        needed = self.trace.lines_needed(outputs)
        mixed = [line for line in needed if parts[line] == OF_DESIGN | OF_PLACE]
        used = sorted({other for line in mixed for other in self.trace.operations[line].operands} | set(outputs))
        return [line for line in used if parts[line] == OF_DESIGN], [line for line in used if parts[line] == OF_PLACE]


def is_traceable(mechanism: Mechanism) -> bool:
    """Whether the linkage is made of dyads whose assembly modes stay: others have no straight list."""
    return not mechanism.is_numerical and not any(dyad.changes for dyad in mechanism.structure.dyads)


def linkage_trace(
    mechanism: Mechanism,
    varied: Iterable[str],
    signals: Sequence[str],
    *,
    zero: Iterable[str] = (),
    accelerates: bool = False,
    all_groups: bool = True,
) -> LinkageTrace:
    """The list of a linkage's signals, with numbers by name, or ``SPEED``, that vary or are ``zero``, others constants.

    ``signals`` are those of ``analytic.signals``, magnitudes of vectors and the output's coordinate. ``all_groups``
    takes the groups that no signal needs as well. Raises LinkproofError for a linkage that is not traceable.
    """
    if not is_traceable(mechanism):
        raise LinkproofError(f"'{mechanism.linkage.name}': expected groups of two links without change points")
    trace, varied = OperationList(), frozenset(varied)
    linkage = with_numbers(
        mechanism.linkage, {name: trace.input(name) for name in sorted(varied)} | dict.fromkeys(zero, 0.0)
    )
    signs = tuple(dyad.sign for dyad in mechanism.structure.dyads)
    sweep = TracedSweep(linkage, find_structure(linkage).with_signs(signs), trace.input(PHI))  # type: ignore[arg-type]
    at = MovingSweep(mechanism, sweep, trace.input(SPEED), trace.input(ACCELERATION) if accelerates else 0.0)  # type: ignore[arg-type]
    lines = tuple(trace.line(signal(at, name)) for name in signals)
    dyads = sweep.structure.dyads if all_groups else ()
    determinants = tuple(trace.line(abs(sweep.determinant(dyad))) for dyad in dyads)
    return LinkageTrace(trace, varied, lines, trace.line(sweep.moves), determinants)
