"""The axes of the stress maps: a table that is read once and checked."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

from analytic.errors import UnknownNameError
from comparisons.stress.scenes import Conditions

TABLE = Path(__file__).with_name("axes.toml")


@dataclass(frozen=True)
class Row:
    """One line of a map: all conditions but the one that varies. ``most`` is the largest value that makes sense."""

    label: str
    conditions: Conditions
    quick: bool = False
    most: float = float("inf")


@dataclass(frozen=True)
class Axis:
    """One map: ``vary`` names the field of ``Conditions`` that takes the ``values``, ``label`` what they are.

    ``unit`` is that of a solver's effort, where this varies: methods whose effort has another one are left out.
    ``good`` is the value at which the problem is easy; ``seconds`` is what one cell may take. Borders are narrowed down
    where ``narrow`` says so: runs of ever more turns cost more than their exact number is worth.
    """

    name: str
    title: str
    about: str
    vary: str
    label: str
    values: tuple[float, ...]
    good: float
    rows: tuple[Row, ...]
    quick: tuple[float, ...] = ()
    settings: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    unit: str = ""
    seconds: float = 20.0
    narrow: bool = True

    def row(self, label: str) -> Row:
        """A row by its label."""
        rows = {row.label: row for row in self.rows}
        if label not in rows:
            raise UnknownNameError(f"row of axis '{self.name}'", label, rows)
        return rows[label]

    def conditions(self, label: str, value: float) -> Conditions:
        """All conditions of a cell."""
        varied: dict[str, Any] = {self.vary: value}
        return replace(self.row(label).conditions, **varied)

    def chosen_rows(self, *, quick: bool) -> tuple[Row, ...]:
        """The rows of a full map, or of a quick one."""
        return tuple(row for row in self.rows if row.quick or not quick)

    def chosen_values(self, row: Row, *, quick: bool) -> tuple[float, ...]:
        """The values of a row in a full map, or in a quick one."""
        return tuple(value for value in (self.quick if quick else self.values) if value <= row.most)


@cache
def axes() -> Mapping[str, Axis]:
    """Every axis by its name, in the table's order."""
    tables = tomllib.loads(TABLE.read_text(encoding="utf-8"))["axis"]
    return {table["name"]: _axis(table) for table in tables}


def chosen_axes(names: Iterable[str]) -> list[Axis]:
    """The axes of these names, by default all; raises UnknownNameError."""
    known, chosen = axes(), list(names)
    for name in chosen:
        if name not in known:
            raise UnknownNameError("axis", name, known)
    return [axis for axis in known.values() if not chosen or axis.name in chosen]


def _axis(table: dict[str, Any]) -> Axis:
    common, rows = table.pop("common", {}), table.pop("rows")
    lists = {key: tuple(value) for key, value in table.items() if isinstance(value, list)}
    return Axis(**{**table, **lists}, rows=tuple(_row(common, row) for row in rows))


def _row(common: Mapping[str, Any], table: Mapping[str, Any]) -> Row:
    of_row = {field.name for field in fields(Row)} - {"conditions"}
    conditions: dict[str, Any] = {key: _plain(value) for key, value in {**common, **table}.items() if key not in of_row}
    return Row(conditions=Conditions(**conditions), **{key: table[key] for key in of_row & table.keys()})


def _plain(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


def nearest(values: Sequence[float], target: float) -> int:
    """Place of the value nearest to one, by ratio."""
    return min(range(len(values)), key=lambda n: _ratio(values[n], target))


def _ratio(first: float, second: float) -> float:
    low, high = sorted((first, second))
    return float("inf") if low <= 0.0 < high else (high / low if low > 0.0 else 1.0)
