"""Repeated parts of a linkage file: ``[repeat.NAME]`` stands for ``count`` copies.

In every key and text of it ``{...}`` is a number made of the copy's number n = 1, 2, ..., such as ``{n}``, ``{n-1}`` or
``{60*n}``; a text that consists of one such pair of braces stands for the number itself.
"""

from __future__ import annotations

import ast
import copy
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final

from analytic.description.diagnosis import Source, shown
from analytic.errors import UnknownNameError

REPEATED: Final = ("ground", "links", "slots", "forces", "torques", "springs", "dampers", "sketch", "notes")
MOST_COPIES: Final = 1000
LONGEST: Final = 60  # characters of a formula
BRACES: Final = re.compile(r"\{([^{}]*)\}")
OPERATIONS: Final[Mapping[type, Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
}  # fmt: skip

Table = dict[str, Any]


def expand_copies(raw: Table, source: Source) -> tuple[Table, Source]:
    """A document with all copies written out, and its source with the line in the file of every copied key.

    Raises DescriptionError for a copy that cannot be made and for a name that is taken already.
    """
    groups = raw.get("repeat", {})
    if not isinstance(groups, dict) or not all(isinstance(group, dict) for group in groups.values()):
        raise source.fault("repeat: expected tables [repeat.NAME], got something else; write them so")
    copies = _Copies({key: value for key, value in raw.items() if key != "repeat"}, source)
    for name, group in groups.items():
        for number in range(1, _count(name, group, source) + 1):
            for key in group.keys() - {"count"}:
                if key not in REPEATED:
                    raise source.fault(f"repeat.{name}.{key}: {UnknownNameError('key', key, ('count', *REPEATED))}")
            for key in sorted(group.keys() - {"count"}):
                copies.add(copies.document, [key], group[key], ["repeat", name, key], number)
    return copies.document, replace(source, copies=copies.templates)


def _count(name: str, group: Table, source: Source) -> int:
    """The number of copies, checked."""
    count = group.get("count")
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST_COPIES:
        where = f"repeat.{name}.count" if "count" in group else f"repeat.{name}"
        raise source.fault(
            f"{where}: expected count = a whole number of copies from 1 to {MOST_COPIES}, got {shown(count)}; give one"
        )
    return count


class _Copies:
    """A document that copies are added to, with the path in the file that each part of a copy was written at."""

    def __init__(self, document: Table, source: Source) -> None:
        self.document = copy.deepcopy(document)
        self.source = source
        self.templates: dict[str, str] = {}

    def add(self, table: Table, path: list[str], value: object, template: list[str], n: int) -> None:
        """Put a value under the last key of its path: tables grow, lists get longer, all else needs its own key."""
        key = path[-1]
        self.templates.setdefault(".".join(path), ".".join(template))
        if isinstance(value, dict) and isinstance(table.setdefault(key, {}), dict):
            for inner, part in value.items():
                name = str(self.filled(inner, [*template, inner], n, is_name=True))
                self.add(table[key], [*path, name], part, [*template, inner], n)
        elif len(path) == 1 and isinstance(value, list) and isinstance(table.setdefault(key, []), list):
            first = len(table[key])
            table[key] += [
                self.value(part, [*path, str(first + i)], [*template, str(i)], n) for i, part in enumerate(value)
            ]
        elif key in table:
            raise self.source.fault(
                f"{'.'.join(template)}: expected a name of its own for copy {n}, got '{'.'.join(path)}', which is "
                "there already; write {n} into the name"
            )
        else:
            table[key] = self.value(value, path, template, n)

    def value(self, value: object, path: list[str], template: list[str], n: int) -> object:
        """A value, tables and lists included, with its formulas computed for copy n."""
        self.templates.setdefault(".".join(path), ".".join(template))
        if isinstance(value, dict):
            names = {inner: str(self.filled(inner, [*template, inner], n, is_name=True)) for inner in value}
            return {names[k]: self.value(part, [*path, names[k]], [*template, k], n) for k, part in value.items()}
        if isinstance(value, list):
            return [self.value(part, [*path, str(i)], [*template, str(i)], n) for i, part in enumerate(value)]
        return self.filled(value, template, n) if isinstance(value, str) else value

    def filled(self, text: str, template: list[str], n: int, *, is_name: bool = False) -> str | float:
        """A text with its formulas computed for copy n; a number where the text is one formula alone."""
        try:
            if not is_name and (whole := BRACES.fullmatch(text)):
                return _number(whole[1], n)
            return BRACES.sub(lambda match: _whole_in_words(_number(match[1], n)), text)
        except (ValueError, SyntaxError, ZeroDivisionError, RecursionError) as error:
            raise self.source.fault(
                f"{'.'.join(template)}: expected numbers made of n in braces, such as {{n-1}} or {{60*n}} (whole ones "
                f"in names), got {shown(text)}; correct it"
            ) from error


def _number(formula: str, n: int) -> float:
    """The value of a formula of numbers, n, + - * / and brackets; raises ValueError for anything else."""
    if len(formula) > LONGEST:
        raise ValueError(formula)
    return float(_evaluated(ast.parse(formula.strip(), mode="eval").body, n))


def _evaluated(node: ast.expr, n: int) -> float:
    """The value of the syntax tree of a formula for copy n; raises ValueError for what no formula may have."""
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATIONS:
        value: float = OPERATIONS[type(node.op)](_evaluated(node.left, n), _evaluated(node.right, n))
        return value
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -_evaluated(node.operand, n)
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return float(node.value)
    if isinstance(node, ast.Name) and node.id == "n":
        return float(n)
    raise ValueError(ast.dump(node))


def _whole_in_words(value: float) -> str:
    """A whole number as names carry it."""
    if not value.is_integer():
        raise ValueError(value)
    return str(int(value))
