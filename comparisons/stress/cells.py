"""Cells of the stress maps: one value of one axis (``axes.toml``) in one row, engine and usage.

A cell can be made again on its own. Each is judged by ``stress.verdict``; ``stress.border`` finds the borders.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.reference.case import Case
from comparisons.runs.failures import Lost, blamed_on
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import run_engine
from comparisons.runs.worker_process import host
from comparisons.stress.axes import Axis, axes
from comparisons.stress.cell_result import Cell, CellResult, StressVerdict, blank_result
from comparisons.stress.scenes import Conditions, case, scene
from comparisons.stress.verdict import judged
from engines.contract import Engine, Run, Setting, StudiedEngine
from engines.registry import why_unavailable
from engines.scene import Scene

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


def made(cell: Cell) -> CellResult:
    """Make a cell's run here and now, and judge it."""
    begun = time.perf_counter()
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    blank = replace(_unmade(cell), host=host())
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
    run = _run(adapter, given, cell.usage, conditions)
    # Those of naive would hide a wrong motion.
    limits_of = Setting.BEST if cell.usage == Setting.BEST else Setting.TUNED
    blank = replace(
        blank, seconds=run.seconds, setup_seconds=run.setup_seconds, steps=run.steps, solver_work=run.solver_work
    )
    return replace(judged(blank, true, given, run, limits_of.value), spent=time.perf_counter() - begun)


def lost(loss: Lost, cell: Cell) -> CellResult:
    """A cell whose worker gave no result."""
    return replace(_unmade(cell), verdict=StressVerdict(loss.outcome.value), reason=loss.reason, host=loss.host)


def _unmade(cell: Cell) -> CellResult:
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    blank = blank_result(cell, conditions.linkage, conditions.motion)
    return replace(blank, differing=conditions.differing)


@lru_cache(maxsize=4)
def _case(conditions: Conditions) -> Case:
    """A case, cached: neighbouring cells share it, and a long released motion takes seconds to integrate."""
    return case(replace(conditions))


def _run(adapter: Engine, given: Scene, usage: str, conditions: Conditions) -> Run:
    if usage in SETTINGS:
        return run_engine(adapter, given, Setting(usage))
    assert isinstance(adapter, StudiedEngine)
    with blamed_on(adapter):
        method = next(method for method in adapter.methods(given) if method.name == usage)
    if conditions.effort:
        method = replace(method, effort=conditions.effort)
    return run_engine(adapter, given, method, conditions.step)
