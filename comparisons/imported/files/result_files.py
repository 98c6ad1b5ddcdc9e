"""Result files of other tools as tables of columns, whatever their layout."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from analytic.errors import LinkproofError, printable
from comparisons.imported.columns import Column, ResultTable
from comparisons.imported.files import adams_results
from comparisons.imported.files.binary_files import matlab_columns, sheets
from comparisons.imported.files.tables import tables
from comparisons.imported.files.text import ResultText, check_file, read_text

ADAMS: Final = "Adams"
SOLIDWORKS: Final = "SolidWorks Motion"
ROBOTRAN: Final = "Robotran"
MODELICA: Final = "Modelica"
MOST_TABLES: Final = 1000  # of a file
# Tools whose numbers are in SI units where a header says nothing else.
SI_TOOLS: Final = (MODELICA, ROBOTRAN)


def result_tables(path: Path) -> list[ResultTable]:
    """Every table of a file in its order; raises LinkproofError with file and line for what cannot be read."""
    check_file(path, "expected a file of results, such as a CSV")
    kind, name = path.suffix.lower(), printable(str(path))
    every: list[ResultTable] = []
    if kind == ".mat":
        is_trajectory, parts = matlab_columns(path)
        tool = MODELICA if is_trajectory else ""
        every = [ResultTable(name, 1, tool, part) for part in map(_numbered, parts) if len(part) > 1]
    else:
        for file in sheets(path) if kind in (".xlsx", ".xlsm") else (read_text(path),):
            for table in _tables_of(file, path):
                every.append(table)
                if len(every) > MOST_TABLES:
                    raise file.fail(table.line, f"expected at most {MOST_TABLES} tables, got more; export fewer")
    if not every:
        raise LinkproofError(
            f"{name}:1: expected a column of time or crank angle and others beside it, got no two columns of one "
            "length; export both"
        )
    return every


def _tables_of(file: ResultText, path: Path) -> Iterator[ResultTable]:
    """Every table of a text."""
    if not file.text.strip():
        raise file.fail(1, "expected a table of results, got an empty file; export it again")
    if adams_results.is_adams(file.text):
        yield ResultTable(file.name, 1, ADAMS, tuple(adams_results.columns(file)))
        return
    is_robotran = path.suffix.lower() == ".res"
    for line, header, columns in tables(file, headless=path.stem if is_robotran else ""):
        if is_robotran and not header:
            columns[0] = replace(columns[0], header="time")
        tool = ROBOTRAN if is_robotran else _tool(path, header, columns)
        yield from (ResultTable(file.name, line, tool, part) for part in _by_axis(columns, tool) if len(part) > 1)


def _tool(path: Path, header: str, columns: Sequence[Column]) -> str:
    """What wrote a table, by the marks of its header; "" for any table."""
    if path.suffix.lower() == ".tab":
        return ADAMS
    if header.lstrip().startswith('"Time (sec)"'):
        return SOLIDWORKS
    # Modelica tools, FMU and Simscape exports name the column of time so and print no units.
    is_bare = not any(column.unit or set(column.header) & set("()[]/ ") - _indices(column) for column in columns)
    return MODELICA if columns and columns[0].header == "time" and is_bare else ""


def _indices(column: Column) -> set[str]:
    """The brackets of a Modelica array such as ``body.r_0[1]``, which are not those of a unit."""
    return set("[]") if column.header.rpartition("[")[2].rstrip("]").replace(",", "").isdigit() else set()


def _by_axis(columns: Sequence[Column], tool: str) -> Iterator[tuple[Column, ...]]:
    """Columns parted where the first of them, the axis, is written again, be it without a header."""
    part: list[Column] = []
    for column in columns:
        if part and _is_again(column, columns[0], tool):
            yield _numbered(part)
            part = [replace(column, header=columns[0].header)]
        else:
            part.append(column)
    yield _numbered(part)


def _numbered(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Columns of which equal headers are numbered, so that a mapping can name each: ``Torque #2``."""
    counts: Counter[str] = Counter()
    result = []
    for column in columns:
        counts[column.header] += 1
        count = counts[column.header]
        result.append(replace(column, header=f"{column.header} #{count}") if count > 1 else column)
    return tuple(result)


def _is_again(column: Column, first: Column, tool: str) -> bool:
    """Whether a column is the axis of the columns behind it; Adams writes it with no header, also with other times."""
    if column.header == first.header:
        return True
    if not column.header.startswith("column "):
        return False
    grows = (
        len(column.values) > 1 and column.values[0] == first.values[0] and bool(np.all(np.diff(column.values) > 0.0))
    )
    return np.array_equal(column.values, first.values) or (tool == ADAMS and grows)
