"""All cells of the stress maps and their borders, in worker processes, kept as they come."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Final

from comparisons.runs.environment import environment
from comparisons.runs.failures import GIB, Lost
from comparisons.runs.journal import Journal
from comparisons.runs.workers import Bounds, run_jobs
from comparisons.stress.axes import Axis, axes
from comparisons.stress.border import COARSE, PRECISE, Border, bisected, borders
from comparisons.stress.cells import Cell, CellResult, cells, from_document, lost, made
from comparisons.stress.long_run import LongRun, long_runs
from comparisons.stress.verdict import StressVerdict

MEMORY: Final = 2 * GIB  # a cell may add
# What a cell may take of a quick map, s, whatever its axis grants; and the usage whose borders a quick map looks for.
QUICK_SECONDS: Final = 4.0
QUICK_BORDERS: Final = "tuned"
DRIVEN: Final = "turns-driven"  # the map of long driven runs

Announce = Callable[[str, int, int], None]


@dataclass(frozen=True)
class StressRequest:
    """What to put under stress; no ``usages`` means every setting and method of each axis."""

    axes: tuple[Axis, ...]
    engines: tuple[str, ...]
    usages: tuple[str, ...] = ()
    quick: bool = False
    processes: int | None = None


@dataclass(frozen=True)
class Stressed:
    """Finished maps: every cell, those of the bisections among them, the borders and the long runs."""

    cells: tuple[CellResult, ...]
    borders: tuple[Border, ...]
    long_runs: tuple[LongRun, ...] = ()

    @property
    def missed(self) -> tuple[CellResult, ...]:
        """Wrong motions that no invariant of ours noticed: there must be none."""
        return tuple(cell for cell in self.cells if cell.verdict is StressVerdict.MISSED)

    def document(self, command: str, *, quick: bool) -> dict[str, Any]:
        """Everything as JSON-ready data."""
        return {
            "format": 1,
            "command": command,
            "environment": environment(),
            "quick": quick,
            "summary": summary(self.cells),
            "cells": [one.document for one in self.cells],
            "borders": [one.document for one in self.borders],
            "long_runs": [asdict(one) for one in self.long_runs],
        }


def summary(found: Iterable[CellResult]) -> dict[str, dict[str, int]]:
    """Number of cells by engine and verdict."""
    counts: dict[str, dict[str, int]] = {}
    for one in found:
        of_engine = counts.setdefault(one.cell.engine, dict.fromkeys((verdict.value for verdict in StressVerdict), 0))
        of_engine[one.verdict.value] += 1
    return counts


def stress(request: StressRequest, announce: Announce = lambda *_: None, journal: Journal | None = None) -> Stressed:
    """Make every cell asked for, then the runs that narrow the borders down; what the journal has is not made again.

    ``announce`` hears a label, how many cells are done and how many are known of.
    """
    maker = _Maker(request, announce, journal, _kept(journal))
    grid = maker.make(cells(request.axes, request.engines, request.usages, quick=request.quick))
    rough = borders(grid)
    if request.quick:
        rough = [one for one in rough if one.inside.cell.usage == QUICK_BORDERS]
    narrow = bisected(rough, maker.make, COARSE if request.quick else PRECISE)
    return Stressed(tuple(maker.done.values()), tuple(narrow), tuple(_long_runs(request)))


def _long_runs(request: StressRequest) -> Iterable[LongRun]:
    """First turn against last on the linkages of the map of long driven runs; too long for a quick look."""
    wanted = [row.conditions.linkage for axis in request.axes if axis.name == DRIVEN for row in axis.rows]
    return () if request.quick else long_runs(request.engines, wanted)


def make_cells(wanted: Sequence[Cell]) -> list[CellResult]:
    """These cells alone, each in a worker process of its own, in their order."""
    return list(_Maker(StressRequest((), ()), lambda *_: None, None, {}).make(wanted))


def _kept(journal: Journal | None) -> dict[str, CellResult]:
    return {} if journal is None else {key: from_document(json.loads(text)) for key, text in journal.kept().items()}


@dataclass
class _Maker:
    """Makes cells that are not made yet, and keeps them."""

    request: StressRequest
    announce: Announce
    journal: Journal | None
    kept: Mapping[str, CellResult]
    done: dict[str, CellResult] = field(default_factory=dict)
    known: int = 0

    def make(self, wanted: Sequence[Cell]) -> list[CellResult]:
        """Results of cells, in their order."""
        self.done |= {cell.key: self.kept[cell.key] for cell in wanted if cell.key in self.kept}
        todo = list({cell.key: cell for cell in wanted if cell.key not in self.done}.values())
        self.known = len(self.done) + len(todo)
        for seconds in sorted({self._seconds(cell) for cell in todo}):
            self._run([cell for cell in todo if self._seconds(cell) == seconds], seconds)
        self.announce("", len(self.done), self.known)
        return [self.done[cell.key] for cell in wanted]

    def _seconds(self, cell: Cell) -> float:
        granted = axes()[cell.axis].seconds
        return min(granted, QUICK_SECONDS) if self.request.quick else granted

    def _run(self, todo: Sequence[Cell], seconds: float) -> None:
        jobs = [(cell,) for cell in todo]
        bounds = Bounds(seconds, MEMORY)
        for number, found in run_jobs(made, jobs, bounds=bounds, processes=self.request.processes):
            cell = todo[number]
            self.announce(cell.key, len(self.done), self.known)
            result = lost(cell, found) if isinstance(found, Lost) else found
            self.done[cell.key] = result
            if self.journal is not None:
                self.journal.keep(cell.key, json.dumps(result.document, default=float).encode())
