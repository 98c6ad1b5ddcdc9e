"""Cells of the stress maps: one value of one axis (``axes.toml``) in one row, engine and usage.

A cell can be made again on its own. Each is judged by ``stress.verdict``; ``stress.border`` finds the borders.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import lru_cache
from typing import Any, Final

from pydantic import TypeAdapter

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.reference.case import Case
from comparisons.runs.failures import Lost, blamed_on
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import run_engine
from comparisons.runs.worker_process import host
from comparisons.stress.axes import Axis, axes
from comparisons.stress.scenes import Conditions, case, scene
from comparisons.stress.verdict import Judgement, StressVerdict, judged
from engines.contract import Engine, Outcome, Run, Setting, StudiedEngine
from engines.registry import why_unavailable
from engines.scene import Scene

SETTINGS = tuple(setting.value for setting in Setting)


@dataclass(frozen=True)
class Cell:
    """One run of a map; ``usage`` is a setting or the name of a method."""

    axis: str
    row: str
    value: float
    engine: str
    usage: str

    @property
    def key(self) -> str:
        """The cell in words that a command understands."""
        return "/".join((self.axis, self.row, f"{self.value:.6g}", self.engine, self.usage))

    @property
    def command(self) -> str:
        """What makes it again."""
        return f"linkproof stress '{self.key}'"

    @property
    def line(self) -> tuple[str, str, str, str]:
        """What it shares with the cells of other values."""
        return (self.axis, self.row, self.engine, self.usage)


@dataclass(frozen=True)
class CellResult:
    """A cell with what came of it. ``conditions`` is what differs from a plain run-up of the linkage.

    ``seconds`` is the stepping alone, ``spent`` everything: reference, set-up, stepping, judging.
    ``host`` names the machine of a cluster that it was made on.
    """

    cell: Cell
    mechanism: str
    outcome: str
    judgement: Judgement
    conditions: Mapping[str, Any]
    seconds: float = 0.0
    spent: float = 0.0
    steps: int = 0
    solver_work: int = 0
    host: str = ""

    @property
    def verdict(self) -> StressVerdict:
        """What the cell shows."""
        return self.judgement.verdict

    @property
    def document(self) -> dict[str, Any]:
        """The result as JSON-ready data."""
        told = asdict(self)
        return {**told.pop("cell"), **told.pop("judgement"), **told, "command": self.cell.command}


RESULT: Final = TypeAdapter(CellResult)


def from_document(row: Mapping[str, Any]) -> CellResult:
    """A result back from its JSON data; raises KeyError or ValueError for anything else."""
    _ = [row[field.name] for kind in (Cell, Judgement) for field in fields(kind)]  # a default says nothing of a cell
    return RESULT.validate_python({**row, "cell": row, "judgement": row})


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
    blank = replace(_unmade(cell), conditions=conditions.differing, host=host())
    adapter = engine(cell.engine)
    with blamed_on(adapter):
        absent = why_unavailable(adapter)
    if absent is not None:
        return replace(blank, judgement=Judgement(StressVerdict.UNAVAILABLE, absent), outcome="unavailable")
    try:
        true = _case(conditions)
    except LinkproofError as error:
        nothing = Judgement(StressVerdict.UNSUPPORTED, f"the closed form has no motion to hold an engine to: {error}")
        return replace(blank, judgement=nothing, outcome=Outcome.UNSUPPORTED.value)
    given = scene(conditions, true)
    run = _run(adapter, given, cell.usage, conditions)
    # Those of naive would hide a wrong motion.
    limits_of = Setting.BEST if cell.usage == Setting.BEST else Setting.TUNED
    return replace(
        blank,
        outcome=run.outcome.value,
        judgement=judged(true, given, run, limits_of.value),
        seconds=run.seconds,
        spent=time.perf_counter() - begun,
        steps=run.steps,
        solver_work=run.solver_work,
    )


def lost(loss: Lost, cell: Cell) -> CellResult:
    """A cell whose worker gave no result."""
    judgement = Judgement(StressVerdict(loss.outcome.value), loss.reason)
    return replace(_unmade(cell), judgement=judgement, outcome=loss.outcome.value, host=loss.host)


def _unmade(cell: Cell) -> CellResult:
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    nothing = Judgement(StressVerdict.UNAVAILABLE)
    return CellResult(cell, conditions.linkage, Outcome.UNAVAILABLE.value, nothing, conditions.differing)


@lru_cache(maxsize=4)
def _case(conditions: Conditions) -> Case:
    """Kept, since neighbouring cells share it and a long released motion takes seconds to integrate."""
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
