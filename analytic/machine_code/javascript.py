"""A list of operations as the source of one straight JavaScript function: numbers of a design, and of rows one by one.

    (given, rows, results, count) => { ... }

``given[k]`` is the k-th number of the design; ``rows[j * count + i]`` the j-th number of row i, such as its crank
angle; ``results[m * count + i]`` becomes the m-th result there. All three are arrays of doubles. What follows from the
design alone is computed once, before the rows. The source is made of numbers and operations: no name of a linkage is in
it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import copysign, isinf, isnan
from typing import Final

from analytic.machine_code.printing import WRITTEN
from analytic.machine_code.tracing import CONSTANT, OperationList

# What JavaScript writes otherwise than Python. Math.max and Math.min are NaN where one number is, as in NumPy.
OTHERWISE: Final[Mapping[str, str]] = {
    **{"absolute": "Math.abs({0})", "sign": "Math.sign({0})", "sqrt": "Math.sqrt({0})"},
    "hypot": "Math.sqrt({0} * {0} + {1} * {1})",
    **{"sin": "Math.sin({0})", "cos": "Math.cos({0})", "arctan2": "Math.atan2({0}, {1})"},
    **{"maximum": "Math.max({0}, {1})", "minimum": "Math.min({0}, {1})"},
    **{"and": "{0} && {1}", "or": "{0} || {1}", "not": "!{0}", "where": "{0} ? {1} : {2}"},
}
SPELT: Final = {**WRITTEN, **OTHERWISE}


def javascript_source(trace: OperationList, given: Sequence[int], rows: Sequence[int], results: Sequence[int]) -> str:
    """The source of the function, whose numbers of the design, of a row and results are these lines of the list."""
    names = {line: f"v{line}" for line in (*given, *rows)}
    needed = trace.leading_to(results, names)
    in_rows = set(rows)
    once = [f"const v{line} = given[{number}];" for number, line in enumerate(given) if line in needed]
    each = [f"const v{line} = rows[{number} * count + i];" for number, line in enumerate(rows) if line in needed]
    for line in needed:
        operation = trace.operations[line]
        if operation.name == CONSTANT:
            names[line] = _number(operation.value)
        elif line not in names:
            names[line] = f"v{line}"
            expression = SPELT[operation.name].format(*(names[other] for other in operation.operands))
            is_of_row = not in_rows.isdisjoint(operation.operands)
            in_rows |= {line} if is_of_row else set()
            (each if is_of_row else once).append(f"const v{line} = {expression};")
    each += [f"results[{number} * count + i] = {names[line]};" for number, line in enumerate(results)]
    body = "\n".join([*once, "for (let i = 0; i < count; i += 1) {", *each, "}"])
    return f"(given, rows, results, count) => {{\n{body}\n}}"


def _number(value: float) -> str:
    """A constant, in brackets where a minus might meet another."""
    if isnan(value):
        return "NaN"
    text = "Infinity" if isinf(value) else repr(abs(value))
    return f"(-{text})" if copysign(1.0, value) < 0.0 else text
