"""Cells of the stress maps: one value of one axis (``axes.toml``) in one row, engine and usage.

A cell can be made again on its own. Each is judged by ``stress.verdict``; ``stress.border`` finds the borders.
"""

from __future__ import annotations

import time
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.reference.case import Case
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import Lost, blamed_on, run_engine
from comparisons.stress.cell_result import Cell, CellResult, StressVerdict, blank_result
from comparisons.stress.scenes import Conditions, case, scene
from comparisons.stress.verdict import judged
from engines.contract import Engine, Run, Setting, StudiedEngine
from engines.registry import why_unavailable
from engines.scene import Scene

# The axes of the stress maps: a table that is read once and checked.


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
    return {table["name"]: _axis_of_table(table) for table in tables}


def chosen_axes(names: Iterable[str]) -> list[Axis]:
    """The axes of these names, by default all; raises UnknownNameError."""
    known, chosen = axes(), list(names)
    for name in chosen:
        if name not in known:
            raise UnknownNameError("axis", name, known)
    return [axis for axis in known.values() if not chosen or axis.name in chosen]


def _axis_of_table(table: dict[str, Any]) -> Axis:
    common, rows = table.pop("common", {}), table.pop("rows")
    lists = {key: tuple(value) for key, value in table.items() if isinstance(value, list)}
    return Axis(**{**table, **lists}, rows=tuple(_row_of_table(common, row) for row in rows))


def _row_of_table(common: Mapping[str, Any], table: Mapping[str, Any]) -> Row:
    of_row = {field.name for field in fields(Row)} - {"conditions"}
    conditions: dict[str, Any] = {
        key: _tuple_for_list(value) for key, value in {**common, **table}.items() if key not in of_row
    }
    return Row(conditions=Conditions(**conditions), **{key: table[key] for key in of_row & table.keys()})


def _tuple_for_list(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


def nearest(values: Sequence[float], target: float) -> int:
    """Index of the value nearest to ``target``, by ratio."""
    return min(range(len(values)), key=lambda n: _factor_between(values[n], target))


def _factor_between(first: float, second: float) -> float:
    low, high = sorted((first, second))
    return float("inf") if low <= 0.0 < high else (high / low if low > 0.0 else 1.0)


SETTINGS = tuple(setting.value for setting in Setting)


def usages(axis: Axis, adapter: Engine) -> list[str]:
    """The settings and methods in which an engine is put on an axis."""
    if not axis.methods:
        return list(axis.settings)
    plain = axis.rows[0].conditions
    given = scene(plain, case(plain))
    try:
        methods = adapter.methods(given) if isinstance(adapter, StudiedEngine) else ()
        offered = {method.name: method.effort_unit for method in methods}
    except Exception:  # a cell of every method tells what the adapter raises
        return [*axis.settings, *axis.methods]
    fitting = [name for name in axis.methods if name in offered and axis.unit in ("", offered[name])]
    return [*axis.settings, *fitting]


def cells(chosen: Iterable[Axis], engines: Sequence[str], only: Sequence[str] = (), *, quick: bool) -> list[Cell]:
    """Every cell of these axes; ``only`` keeps the usages of these names."""
    return [
        Cell(axis.name, row.label, value, name, usage)
        for axis in chosen
        for row in axis.chosen_rows(quick=quick)
        for value in axis.chosen_values(row, quick=quick)
        for name in engines
        for usage in usages(axis, engine(name))
        if not only or usage in only
    ]


def find_cell(key: str) -> Cell:
    """The cell of a key; its value may be any number. Raises UnknownNameError, or LinkproofError for another text."""
    parts = key.split("/")
    if len(parts) != 5:
        raise LinkproofError(
            f"expected a cell as AXIS/ROW/VALUE/ENGINE/USAGE, got '{key}'; copy one from a list of cells"
        )
    name, row, value, engine_name, usage = parts
    if name not in axes():
        raise UnknownNameError("axis", name, axes())
    axis = axes()[name]
    axis.row(row)
    known = usages(axis, engine(engine_name))
    if usage not in known:
        raise UnknownNameError(f"usage of '{engine_name}' on axis '{name}'", usage, known)
    try:
        return Cell(name, row, float(value), engine_name, usage)
    except ValueError:
        raise LinkproofError(f"cell '{key}': expected a number as its value, got '{value}'; correct it") from None


def run_cell(cell: Cell) -> CellResult:
    """Make a cell's run here and now, and judge it."""
    begun = time.perf_counter()
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    blank = _blank_result(cell)
    adapter = engine(cell.engine)
    with blamed_on(adapter):
        absent = why_unavailable(adapter)
    if absent is not None:
        return replace(blank, verdict=StressVerdict.UNAVAILABLE, reason=absent)
    try:
        true = _case(conditions)
    except LinkproofError as error:
        reason = f"the closed form has no motion to hold an engine to: {error}"
        return replace(blank, verdict=StressVerdict.UNSUPPORTED, reason=reason)
    given = scene(conditions, true)
    run = _run_usage(adapter, given, cell.usage, conditions)
    # Those of naive would hide a wrong motion.
    limits_of = Setting.BEST if cell.usage == Setting.BEST else Setting.TUNED
    blank = replace(
        blank, seconds=run.seconds, setup_seconds=run.setup_seconds, steps=run.steps, solver_work=run.solver_work
    )
    return replace(judged(blank, true, given, run, limits_of.value), spent=time.perf_counter() - begun)


def lost(loss: Lost, cell: Cell) -> CellResult:
    """A cell whose worker gave no result."""
    return replace(_blank_result(cell), verdict=StressVerdict(loss.outcome.value), reason=loss.reason)


def _blank_result(cell: Cell) -> CellResult:
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    blank = blank_result(cell, conditions.linkage, conditions.motion)
    return replace(blank, differing=conditions.differing)


@lru_cache(maxsize=4)
def _case(conditions: Conditions) -> Case:
    """A case, cached: neighbouring cells share it, and a long released motion takes seconds to integrate."""
    return case(replace(conditions))


def _run_usage(adapter: Engine, given: Scene, usage: str, conditions: Conditions) -> Run:
    """The engine's run of a scene in a setting, or by a method at the conditions' step."""
    if usage in SETTINGS:
        return run_engine(adapter, given, Setting(usage))
    assert isinstance(adapter, StudiedEngine)
    with blamed_on(adapter):
        method = next(method for method in adapter.methods(given) if method.name == usage)
    if conditions.effort:
        method = replace(method, effort=conditions.effort)
    return run_engine(adapter, given, method, conditions.step)
