"""All cells of the stress maps and their borders: run in worker processes, stored, and read back."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final, NamedTuple

from pydantic import TypeAdapter
from typing_extensions import TypedDict

from comparisons.trials.judging.limits import grouped
from comparisons.trials.runs.environment import environment
from comparisons.trials.runs.run_engine import GIB, RunBounds
from comparisons.trials.runs.store import Runs, load_study, save_study, store_errors
from comparisons.trials.runs.workers import EVERY_CORE, Announce, Pool, Task, TaskList
from comparisons.trials.stress.cells import Cell, StressVerdict, axes, cell_at, lost, run_cell

PRECISE: Final = 1.1  # ratio of the two values that bracket a border
COARSE: Final = 3.0
# A value of zero bounds a logarithm at this share of the smallest other one: a border below it is the same as 0.
NEXT_TO_ZERO: Final = 1e-3
SMALLEST: Final = 1e-15  # a border between this and zero is not narrowed down
# Where these begin is a property of the machine, and every run that looks for it costs all that a cell may.
BOUNDED: Final = (StressVerdict.TIMED_OUT, StressVerdict.CRASHED)

KIND: Final = "stress"
Line = tuple[str, str, str, str]  # axis, row, engine, usage

MEMORY: Final = 2 * GIB  # a cell may add
# What a cell may take of a quick map, s, whatever its axis grants; and the usage whose borders a quick map looks for.
QUICK_SECONDS: Final = 4.0
QUICK_BORDERS: Final = "tuned"


class Border(NamedTuple):
    """A border on a line of a map: the last run within the limit, and the first that is not."""

    inside: Cell
    outside: Cell

    @property
    def ends(self) -> tuple[float, float]:
        """The lower and the higher of the two values."""
        low, high = sorted((self.inside.value, self.outside.value))
        return low, high

    @property
    def middle(self) -> float:
        """The value between both, by the geometric mean, to the six digits that a cell's name has.

        Instead of a lower end that is not positive it takes ``NEXT_TO_ZERO`` of the higher one.
        """
        low, high = self.ends
        return float(f"{math.sqrt((low if low > 0.0 else NEXT_TO_ZERO * high) * high):.6g}")

    @property
    def between(self) -> Cell:
        """The cell to run next, not yet run: that of the middle value."""
        axis, row, engine, usage = self.inside.line
        return cell_at(axes()[axis], row, self.middle, engine, usage)

    def is_wide(self, precision: float) -> bool:
        """Whether a cell between both values is worth a run: their ratio is over ``precision``.

        Where the lower one is not positive, the higher one has to be over ``SMALLEST``. None is worth it on an axis
        that is not to be narrowed, or where the outside timed out or crashed.
        """
        low, high = self.ends
        worth = axes()[self.inside.axis].narrow and self.outside.verdict not in BOUNDED
        return worth and (high > precision * low if low > 0.0 else high > SMALLEST)

    @property
    def document(self) -> dict[str, Any]:
        """The border as JSON-ready data: its line, its three values, the verdict outside, and both cells' commands."""
        place = dict(zip(("axis", "row", "engine", "usage"), self.inside.line, strict=True))
        values = {"inside": self.inside.value, "outside": self.outside.value, "value": self.middle}
        commands = {"inside_command": self.inside.command, "outside_command": self.outside.command}
        return {**place, **values, "verdict": self.outside.verdict, **commands}


def borders(results: Iterable[Cell], *, quick: bool = False) -> list[Border]:
    """On every line, on either side of its easy value, the border to the first run that is not within limit.

    There is none where the easiest value is not within limit, or where nothing fails. ``results`` are cells that were
    run; with ``quick`` lines of ``QUICK_BORDERS`` alone count.
    """
    lines = grouped((result.line, result) for result in results if not quick or result.setting == QUICK_BORDERS)
    return [border for line in lines.values() for border in _line_borders(line)]


def _line_borders(line: Iterable[Cell]) -> Iterator[Border]:
    """Yield the first border on either side of a line's easy value, where there is one; cells may come in any order.

    Each side begins with the cell nearest to that value, by ratio, and has no border if this is not within limit.
    """
    rising = sorted(line, key=lambda result: result.value)
    good = axes()[rising[0].axis].good
    start = min(range(len(rising)), key=lambda number: _factor_between(rising[number].value, good))
    for side in (rising[start:], rising[start::-1]):
        within = list(itertools.takewhile(lambda result: result.verdict is StressVerdict.WITHIN, side))
        if within and len(within) < len(side):
            yield Border(within[-1], side[len(within)])


def _factor_between(first: float, second: float) -> float:
    """The ratio of the larger value to the smaller; infinite if one of them is not positive, 1 if neither is."""
    low, high = sorted((first, second))
    return math.inf if low <= 0.0 < high else (high / low if low > 0.0 else 1.0)


class SavedStress(TypedDict):
    """The document of a stress test, all but its cells."""

    command: str
    quick: bool
    environment: Mapping[str, str]


FORM: Final[TypeAdapter[Any]] = TypeAdapter(SavedStress)


@dataclass(frozen=True)
class Stress:
    """A finished stress test: its document as saved, its cells, and those that narrow a border down among them."""

    document: Mapping[str, Any]
    cells: Sequence[Cell]

    @property
    def as_dict(self) -> dict[str, Any]:
        """The document with counts by engine and verdict, borders, and all cells, JSON-ready, as a new dictionary.

        They are under "summary", "borders" and "cells".
        """
        return {
            **self.document,
            "summary": {engine: dict(self.count(engine)) for engine in self.engines},
            "borders": [border.document for border in self.borders],
            "cells": [result.data for result in self.results],
        }

    @property
    def results(self) -> Sequence[Cell]:
        """Every cell with its result, line by line, by rising value."""
        return [cell for line in self.lines.values() for cell in line]

    @cached_property
    def borders(self) -> list[Border]:
        """All borders; of a quick map those of ``QUICK_BORDERS``."""
        return borders(self.results, quick=self.document["quick"])

    @cached_property
    def lines(self) -> Mapping[Line, Sequence[Cell]]:
        """The cells by their line (axis, row, engine, setting), in the order of their values."""
        lines = grouped((cell.line, cell) for cell in self.cells)
        return {line: sorted(cells, key=lambda cell: cell.value) for line, cells in lines.items()}

    @cached_property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes that have cells, each once, in the order of the cells."""
        return tuple(dict.fromkeys(result.axis for result in self.results))

    @cached_property
    def columns(self) -> Mapping[str, Sequence[float]]:
        """The listed values of each axis that were run, by axis; all its values if none of the listed ones was."""
        seen = grouped((result.axis, result.value) for result in self.results)
        columns = {}
        for name, values in seen.items():
            listed = axes()[name].quick if self.document["quick"] else axes()[name].values
            columns[name] = [value for value in listed if value in values] or list(dict.fromkeys(values))
        return columns

    @cached_property
    def engines(self) -> tuple[str, ...]:
        """Names of the engines, sorted: not every axis has all of them."""
        return tuple(sorted({result.engine for result in self.results}))

    def of(self, *verdicts: StressVerdict) -> tuple[Cell, ...]:
        """The cells with one of these verdicts, line by line."""
        return tuple(result for result in self.results if result.verdict in verdicts)

    def count(self, engine: str = "", axis: str = "") -> Counter[StressVerdict]:
        """The number of cells with each verdict, of one engine, of one axis or of both; of all by default."""
        chosen = (each for each in self.results if engine in ("", each.engine) and axis in ("", each.axis))
        return Counter(result.verdict for result in chosen)


def save(folder: Path, stress: Stress) -> None:
    """Write a stress test into a folder, replacing an earlier one; raises LinkproofError where it cannot be written."""
    save_study(folder, KIND, stress.document, ((result.key, *result.written()) for result in stress.results))


def load(folder: Path) -> Stress:
    """Read a stress test back; no engine is imported.

    Raises LinkproofError if it is missing, damaged or without a cell.
    """
    stress = Stress(*load_study(folder, KIND, FORM, Cell.from_row))
    with store_errors(folder, KIND):
        _ = stress.columns
        if not stress.results:
            raise ValueError("it has no cell")
    return stress


def stress(
    chosen: Sequence[Cell],
    command: str = "",
    *,
    quick: bool = False,
    narrow: bool = True,
    announce: Announce = lambda *_: None,
    finished: Runs | None = None,
    pool: Pool = EVERY_CORE,
) -> Stress:
    """Run these cells, then those that ``narrow`` the borders down; ``finished`` runs are not made again.

    New runs are added to those. ``announce`` hears a label, how many cells are done and how many are known of.
    ``command`` repeats the test. A ``quick`` one has coarser borders and less time for a cell. ``pool`` makes the runs.
    Raises LinkproofError where no worker can start.
    """
    study = TaskList(run_cell, lost, Cell.written, Cell.from_row, finished, announce, pool)
    precision = COARSE if quick else PRECISE
    results, todo = list[Cell](), chosen
    while todo:
        results += _run_cells(study, todo, quick=quick)
        found = borders(results, quick=quick) if narrow else []
        todo = [border.between for border in found if border.is_wide(precision)]
    engines = sorted({cell.engine for cell in results})
    return Stress({"command": command, "environment": environment(engines), "quick": quick}, results)


def _run_cells(study: TaskList[Cell], chosen: Sequence[Cell], *, quick: bool) -> list[Cell]:
    """Run cells, those with equal time limits together, shortest first; returns the results in the cells' order.

    ``study`` keeps them, and makes none that it has. Raises LinkproofError where no worker can start.
    """
    by_seconds = grouped((_cell_seconds(cell, quick=quick), Task(cell.key, (cell,), cell.key)) for cell in chosen)
    study.expect(task for tasks in by_seconds.values() for task in tasks)
    for seconds, alike in sorted(by_seconds.items()):
        study.complete(alike, RunBounds(seconds, MEMORY))
    return [study.result(cell.key) for cell in chosen]


def _cell_seconds(cell: Cell, *, quick: bool) -> float:
    """The time limit of a cell, s: its axis' or, in a quick map, QUICK_SECONDS where this is less."""
    return min(axes()[cell.axis].seconds, QUICK_SECONDS if quick else math.inf)
