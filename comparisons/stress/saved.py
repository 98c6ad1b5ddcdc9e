"""A stress test saved and read back, with its cells in the order of the table of axes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from pydantic import TypeAdapter
from typing_extensions import TypedDict

from comparisons.judging.limits import grouped
from comparisons.runs.study_folder import load_study, save_study, study_errors
from comparisons.stress.border import Border
from comparisons.stress.cell_result import Cell, CellResult, StressVerdict
from comparisons.stress.cells import axes

KIND: Final = "stress"
Line = tuple[str, str, str, str]  # axis, row, engine, usage


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
    with study_errors(folder, KIND):
        _ = stress.columns
        if not stress.results:
            raise ValueError("it has no cell")
    return stress
