"""All cells of the stress maps and their borders: run in worker processes, stored, and read back."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Final

from pydantic import TypeAdapter
from typing_extensions import TypedDict

from analytic.errors import LinkproofError
from comparisons.judging.limits import grouped
from comparisons.runs.environment import environment
from comparisons.runs.run_engine import GIB
from comparisons.runs.store import Runs, load_study, save_study, store_errors
from comparisons.runs.study import Announce, Study, Task
from comparisons.runs.workers import EVERY_CORE, Bounds, Pool
from comparisons.stress.cells import Axis, axes, cells, lost, nearest, run_cell
from comparisons.stress.verdict import Cell, CellResult, StressVerdict

PRECISE: Final = 1.1  # ratio of the two values that bracket a border
COARSE: Final = 3.0
# A value of zero bounds a logarithm at this share of the smallest other one: a border below it is the same as 0.
NEXT_TO_ZERO: Final = 1e-3
SMALLEST: Final = 1e-15  # a border between this and zero is not narrowed down
# There is no border where the easiest value is not within limit, or where nothing fails.
GOOD: Final = (StressVerdict.WITHIN,)
# Where these begin is a property of the machine, and every run that looks for it costs all that a cell may.
BOUNDED: Final = (StressVerdict.TIMED_OUT, StressVerdict.CRASHED)

KIND: Final = "stress"
Line = tuple[str, str, str, str]  # axis, row, engine, usage

MEMORY: Final = 2 * GIB  # a cell may add
# What a cell may take of a quick map, s, whatever its axis grants; and the usage whose borders a quick map looks for.
QUICK_SECONDS: Final = 4.0
QUICK_BORDERS: Final = "tuned"


@dataclass(frozen=True)
class Border:
    """A border on a line of a map: the last value ``inside`` the limit, the first ``outside``, the verdict there."""

    axis: str
    row: str
    engine: str
    usage: str
    inside: float
    outside: float
    verdict: StressVerdict

    @property
    def line(self) -> tuple[str, str, str, str]:
        """Axis, row, engine and usage of the cells on both sides of the border."""
        return (self.axis, self.row, self.engine, self.usage)

    @property
    def ratio(self) -> float:
        """By what factor the two values differ; infinite next to zero."""
        low, high = sorted((self.inside, self.outside))
        return high / low if low > 0.0 else math.inf

    @property
    def middle(self) -> float:
        """The value between the two, halfway by ratio, to the digits that a cell's name has."""
        low, high = sorted((self.inside, self.outside))
        return float(f"{math.sqrt((low if low > 0.0 else NEXT_TO_ZERO * high) * high):.6g}")

    def cell(self, value: float) -> Cell:
        """The cell of the border's line at a value of its axis."""
        return Cell(self.axis, self.row, value, self.engine, self.usage)

    def narrowed(self, result: CellResult) -> Border:
        """The border between closer values, after a run at a value between its two."""
        if result.verdict in GOOD:
            return replace(self, inside=result.cell.value)
        return replace(self, outside=result.cell.value, verdict=result.verdict)

    @property
    def document(self) -> dict[str, Any]:
        """The border as JSON-ready data."""
        commands = {f"{end}_command": self.cell(getattr(self, end)).command for end in ("inside", "outside")}
        return {**asdict(self), "value": self.middle, **commands}


def borders(results: Iterable[CellResult]) -> list[Border]:
    """On every line of every map, the first run beyond the easy value on either side that is not within limit."""
    ordered = sorted(results, key=lambda result: (*result.cell.line, result.cell.value))
    lines = itertools.groupby(ordered, key=lambda result: result.cell.line)
    return [border for _, line in lines for border in _line_borders(list(line))]


def _line_borders(line: Sequence[CellResult]) -> Iterator[Border]:
    """The first border on either side of a line's easy value."""
    start = nearest([result.cell.value for result in line], axes()[line[0].cell.axis].good)
    for side in (line[start:], line[start::-1]):
        for inside, outside in itertools.pairwise(side):
            if inside.verdict not in GOOD:
                break
            if outside.verdict not in GOOD:
                yield Border(*inside.cell.line, inside.cell.value, outside.cell.value, outside.verdict)
                break


def bisect_borders(
    rough: Sequence[Border], make: Callable[[Sequence[Cell]], Sequence[CellResult]], precision: float = PRECISE
) -> list[Border]:
    """Borders narrowed until the values of each differ by a factor ``precision`` at most; ``make`` runs many cells."""
    narrow = list(rough)
    while wide := [number for number, border in enumerate(narrow) if _is_wide(border, precision)]:
        middles = [narrow[number].cell(narrow[number].middle) for number in wide]
        for number, result in zip(wide, make(middles), strict=True):
            narrow[number] = narrow[number].narrowed(result)
    return narrow


def _is_wide(border: Border, precision: float) -> bool:
    """Whether to halve it once more; a border next to zero is not followed for ever."""
    low, high = sorted((border.inside, border.outside))
    worth = axes()[border.axis].narrow and border.verdict not in BOUNDED
    return worth and border.ratio > precision and (low > 0.0 or high > SMALLEST)


class SavedStress(TypedDict):
    """The document of a stress test, all but its cells."""

    command: str
    quick: bool
    environment: Mapping[str, str]
    borders: list[Border]


FORM: Final[TypeAdapter[Any]] = TypeAdapter(SavedStress)
_BORDERS: Final = TypeAdapter(tuple[Border, ...])


@dataclass(frozen=True)
class Stress:
    """A finished stress test: its document as saved, its cells, and those of the bisections among them."""

    document: Mapping[str, Any]
    cells: Sequence[CellResult]

    @property
    def as_dict(self) -> dict[str, Any]:
        """The document and all cells, JSON-ready."""
        return {**self.document, "cells": [result.data for result in self.results]}

    @cached_property
    def results(self) -> tuple[CellResult, ...]:
        """Every cell in the order of the maps, whichever process was done first."""
        return tuple(sorted(self.cells, key=lambda result: _table_position(result.cell)))

    @cached_property
    def borders(self) -> tuple[Border, ...]:
        """All borders."""
        return _BORDERS.validate_python(self.document["borders"])

    @cached_property
    def lines(self) -> Mapping[Line, Sequence[CellResult]]:
        """The cells of each line."""
        return grouped((result.cell.line, result) for result in self.results)

    @cached_property
    def line_borders(self) -> Mapping[Line, Sequence[Border]]:
        """The borders of each line that has any."""
        return grouped((border.line, border) for border in self.borders)

    @cached_property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes, in the order of their table."""
        return tuple(dict.fromkeys(result.cell.axis for result in self.results))

    @cached_property
    def columns(self) -> Mapping[str, tuple[float, ...]]:
        """Each axis' listed values that were run, without those of the bisection; all if none of them is listed."""
        quick, seen = (
            self.document["quick"],
            dict.fromkeys((result.cell.axis, result.cell.value) for result in self.results),
        )
        return {
            axis: tuple(value for value in (known.quick if quick else known.values) if (axis, value) in seen)
            or tuple(value for name, value in seen if name == axis)
            for axis, known in axes().items()
            if axis in self.axes
        }

    @cached_property
    def engines(self) -> tuple[str, ...]:
        """Names of the engines, sorted: not every axis has all of them."""
        return tuple(sorted({result.cell.engine for result in self.results}))

    def of(self, *verdicts: StressVerdict) -> tuple[CellResult, ...]:
        """The cells of these verdicts."""
        return tuple(result for result in self.results if result.verdict in verdicts)

    def count(self, engine: str = "", axis: str = "") -> Counter[StressVerdict]:
        """How many cells of an engine, of an axis or of all came to each verdict."""
        return Counter(
            result.verdict for result in self.results
            if engine in ("", result.cell.engine) and axis in ("", result.cell.axis)
        )  # fmt: skip


def _table_position(cell: Cell) -> tuple[object, ...]:
    """A cell's position in the table of axes, for sorting; a row or usage that the table no longer has comes last."""
    axis = axes()[cell.axis]
    rows, usages = [row.label for row in axis.rows], (*axis.settings, *axis.methods)
    falling = axis.values[0] > axis.values[-1]
    return (list(axes()).index(cell.axis), _place_among(rows, cell.row), cell.engine, _place_among(usages, cell.usage),
            -cell.value if falling else cell.value)  # fmt: skip


def _place_among(names: Sequence[str], name: str) -> int:
    return names.index(name) if name in names else len(names)


def save(folder: Path, stress: Stress) -> None:
    """Write a stress test into a folder."""
    save_study(folder, KIND, stress.document, ((result.key, *result.written()) for result in stress.results))


def load(folder: Path) -> Stress:
    """Read a stress test back; no engine is imported. Raises LinkproofError if it is missing or damaged."""
    stress = Stress(*load_study(folder, KIND, FORM, CellResult.from_row))
    with store_errors(folder, KIND):
        _ = stress.columns
        if not stress.results:
            raise ValueError("it has no cell")
    return stress


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

    @cached_property
    def cells(self) -> list[Cell]:
        """The cells; raises LinkproofError where there is none."""
        found = cells(self.axes, self.engines, self.usages, quick=self.quick)
        if not found:
            usages = ", ".join(self.usages) or "any setting"
            raise LinkproofError(f"no stability run matches {usages}: choose other axes or settings")
        return found


def summary(results: Iterable[CellResult]) -> dict[str, dict[str, int]]:
    """Number of cells by engine and verdict."""
    counts: dict[str, dict[str, int]] = {}
    for result in results:
        of_engine = counts.setdefault(
            result.cell.engine, dict.fromkeys((verdict.value for verdict in StressVerdict), 0)
        )
        of_engine[result.verdict.value] += 1
    return counts


def stress(request: StressRequest, announce: Announce = lambda *_: None, finished: Runs | None = None) -> Stress:
    """Make every requested cell, then the runs that narrow the borders down; ``finished`` runs are not made again.

    ``announce`` hears a label, how many cells are done and how many are known of. Raises LinkproofError where there
    is no cell.
    """
    study = _stress_study(announce, finished, request.pool)
    make = partial(_run_cells, study, request)
    grid = make(request.cells)
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


def _stress_study(announce: Announce, finished: Runs | None, pool: Pool) -> Study[CellResult]:
    return Study(run_cell, lost, CellResult.written, CellResult.from_row, finished, announce, pool)


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
