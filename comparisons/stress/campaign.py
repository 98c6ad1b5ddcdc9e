"""All cells of the stress maps and their borders, run in worker processes and stored in a journal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from analytic.errors import LinkproofError
from comparisons.judging.limits import grouped
from comparisons.runs.environment import environment
from comparisons.runs.run_engine import GIB
from comparisons.runs.study import Announce, Journal, Study, Task
from comparisons.runs.workers import EVERY_CORE, Bounds, Pool
from comparisons.stress.border import COARSE, PRECISE, bisect_borders, borders
from comparisons.stress.cell_result import Cell, CellResult, StressVerdict
from comparisons.stress.cells import Axis, axes, cells, lost, run_cell
from comparisons.stress.saved import Stress

MEMORY: Final = 2 * GIB  # a cell may add
# What a cell may take of a quick map, s, whatever its axis grants; and the usage whose borders a quick map looks for.
QUICK_SECONDS: Final = 4.0
QUICK_BORDERS: Final = "tuned"


@dataclass(frozen=True)
class StressRequest:
    """The cells to run; no ``usages`` means every setting and method of each axis.

    ``command`` repeats it.
    """

    axes: tuple[Axis, ...]
    engines: tuple[str, ...]
    usages: tuple[str, ...] = ()
    quick: bool = False
    pool: Pool = EVERY_CORE
    command: str = ""


def summary(results: Iterable[CellResult]) -> dict[str, dict[str, int]]:
    """Number of cells by engine and verdict."""
    counts: dict[str, dict[str, int]] = {}
    for result in results:
        of_engine = counts.setdefault(
            result.cell.engine, dict.fromkeys((verdict.value for verdict in StressVerdict), 0)
        )
        of_engine[result.verdict.value] += 1
    return counts


def stress(request: StressRequest, announce: Announce = lambda *_: None, journal: Journal | None = None) -> Stress:
    """Make every requested cell, then the runs that narrow the borders down; what the journal has is not made again.

    ``announce`` hears a label, how many cells are done and how many are known of. Raises LinkproofError where there
    is no cell.
    """
    requested = cells(request.axes, request.engines, request.usages, quick=request.quick)
    if not requested:
        usages = ", ".join(request.usages) or "any setting"
        raise LinkproofError(f"no stability run matches {usages}: choose other axes or settings")
    study = _stress_study(announce, journal, request.pool)
    make = partial(_run_cells, study, request)
    grid = make(requested)
    rough = borders(grid)
    if request.quick:
        rough = [border for border in rough if border.usage == QUICK_BORDERS]
    narrow = bisect_borders(rough, make, COARSE if request.quick else PRECISE)
    results, counts = tuple(study.results()), summary(study.results())
    document = {
        "command": request.command,
        "environment": environment(list(counts)),
        "quick": request.quick,
        "summary": counts,
        "borders": [border.document for border in narrow],
    }
    return Stress(document, results)


def make_cells(chosen: Sequence[Cell], pool: Pool = EVERY_CORE) -> list[CellResult]:
    """These cells alone, each in a worker process of its own, in their order."""
    return _run_cells(_stress_study(lambda *_: None, None, pool), StressRequest((), ()), chosen)


def _stress_study(announce: Announce, journal: Journal | None, pool: Pool) -> Study[CellResult]:
    return Study(run_cell, lost, CellResult.written, CellResult.from_row, journal, announce, pool)


def _run_cells(study: Study[CellResult], request: StressRequest, chosen: Sequence[Cell]) -> list[CellResult]:
    """Results of cells, in their order."""
    by_seconds = grouped((_cell_seconds(request, cell), Task(cell.key, (cell,), cell.key)) for cell in chosen)
    study.expect(task for tasks in by_seconds.values() for task in tasks)
    for seconds in sorted(by_seconds):
        for _ in study.make(by_seconds[seconds], Bounds(seconds, MEMORY)):
            pass  # the study has the result
    return [study.result(cell.key) for cell in chosen]


def _cell_seconds(request: StressRequest, cell: Cell) -> float:
    """The time limit of a cell, s."""
    granted = axes()[cell.axis].seconds
    return min(granted, QUICK_SECONDS) if request.quick else granted
