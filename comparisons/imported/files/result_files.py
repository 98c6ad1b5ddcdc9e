"""Result files of other tools as tables of columns, whatever their layout."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from analytic.errors import LinkproofError, printable
from comparisons.imported.columns import Column, ResultTable
from comparisons.imported.files import adams_results
from comparisons.imported.files.binary_files import fmu_columns, matlab_columns, sheets
from comparisons.imported.files.tables import tables
from comparisons.imported.files.text import ResultText, check_file, read_text

MOST_TABLES: Final = 1000  # of a file
# Modelica tools, FMU and Simscape exports print names of variables, which may be elements of arrays, and no units.
BARE: Final = re.compile(r"[^()\[\]/ ]+(?:\[[\d,]+\])?")


def result_tables(path: Path) -> list[ResultTable]:
    """Every table of a file in its order; raises LinkproofError with file and line for what cannot be read."""
    check_file(path, "expected a file of results, such as a CSV")
    kind, name = path.suffix.lower(), printable(str(path))
    every: list[ResultTable] = []
    if kind == ".mat":
        is_trajectory, parts = matlab_columns(path)
        every = [ResultTable(name, 1, is_trajectory, tuple(part)) for part in parts if len(part) > 1]
    elif kind == ".fmu":
        time, *outputs = fmu_columns(path)
        every = [ResultTable(name, 1, not any(part.unit for part in outputs), (time, *outputs))] if outputs else []
    else:
        for file in sheets(path) if kind in (".xlsx", ".xlsm") else (read_text(path),):
            for table in _tables_of(file):
                every.append(table)
                if len(every) > MOST_TABLES:
                    raise file.fail(table.line, f"expected at most {MOST_TABLES} tables, got more; export fewer")
    if not every:
        raise LinkproofError(
            f"{name}:1: expected a column of time or crank angle and others beside it, got no two columns of one "
            "length; export both"
        )
    return every


def _tables_of(file: ResultText) -> Iterator[ResultTable]:
    """Every table of a text."""
    if not file.text.strip():
        raise file.fail(1, "expected a table of results, got an empty file; export it again")
    if adams_results.is_adams(file.text):
        yield ResultTable(file.name, 1, False, tuple(adams_results.columns(file)))
        return
    for line, columns in tables(file):
        is_si = columns[0].header == "time" and all(BARE.fullmatch(c.header) and not c.unit for c in columns)
        yield from (ResultTable(file.name, line, is_si, tuple(part)) for part in _by_axis(columns) if len(part) > 1)


def _by_axis(columns: Sequence[Column]) -> Iterator[list[Column]]:
    """Columns parted where the first of them, the axis, is written again, be it without a header, as Adams does."""
    part: list[Column] = []
    for column in columns:
        if part and _is_again(column, columns[0]):
            yield part
            part = [replace(column, header=columns[0].header)]
        else:
            part.append(column)
    yield part


def _is_again(column: Column, first: Column) -> bool:
    if column.header or not first.header:
        return bool(first.header) and column.header == first.header
    return bool(column.values[0] == first.values[0] and np.all(np.diff(column.values) > 0.0))


def numbered(every: Iterable[ResultTable]) -> list[ResultTable]:
    """Tables with a header of its own for every column but the axes, so that a mapping can name each: ``Torque #2``."""
    counts: Counter[str] = Counter()
    result = []
    for table in every:
        columns = []
        for number, column in enumerate(table.columns, start=1):
            header = column.header or f"column {number}"
            counts[header] += 1
            again = counts[header] if number > 1 else 1
            columns.append(replace(column, header=header if again == 1 else f"{header} #{again}"))
        result.append(replace(table, columns=tuple(columns)))
    return result
