"""A list of operations as the source of one straight Python function, laid out for a processor's vector registers.

    def straight(lanes, rows, results): ...

goes through chunks of ``LANES`` lanes, such as designs, and in each through rows, such as crank angles, with the lanes
innermost. The k-th number of a chunk's lane d is ``lanes[chunk, k * LANES + d]``, the same in every row; the j-th of a
row is ``rows[row, j]``, the same in every lane; ``results[chunk, m * LANES + d]`` is the m-th result. Constant offsets
let the compiler see that no two of them overlap, and compute several lanes in one instruction. Sines and cosines of
what is given, which a library computes lane by lane, come first in a loop of their own, and lie behind the numbers of
the lanes (``ahead``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Final, NamedTuple

from analytic.machine_code.tracing import CONSTANT, OperationList

LANES: Final = 64
FUNCTION: Final = "straight"

# How each operation is written, of {0}, {1} and {2}. NumPy's maximum and minimum are nan where one number is.
WRITTEN: Final[Mapping[str, str]] = {
    **{"add": "{0} + {1}", "subtract": "{0} - {1}", "multiply": "{0} * {1}", "divide": "{0} / {1}"},
    **{"negative": "-{0}", "absolute": "abs({0})", "sign": "({0} > 0.0) - ({0} < 0.0)", "sqrt": "math.sqrt({0})"},
    "hypot": "math.sqrt({0} * {0} + {1} * {1})",  # a library's function would leave the vector registers
    **{"sin": "math.sin({0})", "cos": "math.cos({0})", "arctan2": "math.atan2({0}, {1})"},
    **{"maximum": "{1} if {0} < {1} else {0}", "minimum": "{1} if {0} > {1} else {0}"},
    **{"less": "{0} < {1}", "less_equal": "{0} <= {1}", "greater": "{0} > {1}", "greater_equal": "{0} >= {1}"},
    **{"and": "{0} & {1}", "or": "{0} | {1}", "not": "not {0}", "where": "{1} if {0} else {2}"},
}
LOGICAL: Final = frozenset({"less", "less_equal", "greater", "greater_equal", "and", "or", "not"})
LATEST: Final = "{value}"  # a result that is the last row's


class Result(NamedTuple):
    """A result of each lane: its value after every row, from its ``start`` on.

    The ``formula`` is of the ``line`` as {value}, of the result up to here as {so_far}, and of the next result in the
    list as {next}, as the row before has left it.
    """

    line: int
    formula: str = LATEST
    start: float = 0.0


def ahead(trace: OperationList, lanes: Sequence[int], results: Sequence[Result]) -> list[int]:
    """The lines of sines and cosines of the lanes' numbers."""
    rows = trace.operations
    needed = trace.leading_to([result.line for result in results], lanes)
    return [line for line in needed if rows[line].name in {"sin", "cos"} and rows[line].operands[0] in lanes]


def python_source(trace: OperationList, lanes: Sequence[int], rows: Sequence[int], results: Sequence[Result]) -> str:
    """The source of ``FUNCTION``, whose numbers of lanes and of rows are these lines."""
    names: dict[int, str] = {}
    first = ahead(trace, lanes, results)
    places = {line: f"given[{number * LANES} + d]" for number, line in enumerate([*lanes, *first])}
    outs = [f"out[{number * LANES} + d]" for number in range(len(results) + 1)]
    over_lanes = f"for d in range({LANES}):"
    begun = [f"{out} = {_number(result.start)}" for out, result in zip(outs, results, strict=False)]
    if all(result.formula == LATEST for result in results):
        begun = []  # no result is of what it was
    for line in first:  # side by side, so that a sine and a cosine of one number are one call
        operation = trace.operations[line]
        begun.append(f"{places[line]} = {WRITTEN[operation.name].format(places[operation.operands[0]])}")
    text = [
        f"def {FUNCTION}(lanes, rows, results):",
        "    for chunk in range(len(results)):",
        "        given, out = lanes[chunk], results[chunk]",
        f"        {over_lanes}",
        *(f"            {name}" for name in begun or ["pass"]),
        "        for row in range(len(rows)):",
    ]

    def take(depth: int, line: int, expression: str, *, is_given: bool = False) -> None:
        names[line] = f"v{line}"
        if is_given and trace.operations[line].name in LOGICAL:  # truth values are given as numbers
            expression = f"{expression} != 0.0"
        text.append(f"{' ' * 4 * depth}v{line} = {expression}")

    for number, line in enumerate(rows):
        take(3, line, f"rows[row, {number}]", is_given=True)
    text.append(f"            {over_lanes}")
    for line, place in places.items():
        take(4, line, place, is_given=True)
    for line in trace.leading_to([result.line for result in results], names):
        operation = trace.operations[line]
        if operation.name == CONSTANT:
            names[line] = _number(operation.value)
        elif line not in names:
            take(4, line, WRITTEN[operation.name].format(*(names[other] for other in operation.operands)))
    for number, result in enumerate(results):
        value = result.formula.format(value=names[result.line], so_far=outs[number], next=outs[number + 1])
        text.append(f"{' ' * 16}{outs[number]} = {value}")
    return "\n".join(text) + "\n"


def _number(value: float) -> str:
    return repr(value) if isfinite(value) else f"float('{value!r}')"
