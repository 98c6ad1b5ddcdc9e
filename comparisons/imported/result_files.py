"""Result files of other tools as tables of columns, whatever their layout."""

from __future__ import annotations

import io
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final
from xml.etree import ElementTree

import numpy as np

from analytic.errors import LinkproofError, printable
from comparisons.imported.binary_files import matlab_columns, read_workbook
from comparisons.imported.columns import Column, ResultTable
from comparisons.imported.encodings import ResultText, check_file, read_text
from comparisons.imported.text_tables import read_tables

# Adams result files (``.res``): XML of schema xrf 2.0, as Adams/Solver and the solver in SolidWorks Motion write it.
#
# ``StepMap`` lists entities with their components, each with ``id`` and ``unitsValue``; a ``Step`` holds one instant,
# its numbers in the order of the ids.


STEPS_WITHOUT_INSTANT: Final = ("input", "output")  # types of steps that are no instants of the motion


def is_adams(text: str) -> bool:
    """Whether a text is an Adams result file."""
    return text.lstrip().startswith("<") and "<Results" in text[:2000]


def adams_columns(file: ResultText) -> list[Column]:
    """A column for each component; raises LinkproofError with the file, and the step as the line."""
    names: dict[int, tuple[str, str]] = {}  # header and unit by id
    steps: list[str] = []
    entity = ""
    content = re.sub(r"^\s*<\?xml[^>]*\?>", "", file.text, count=1).encode("utf-8", "replace")
    try:
        for event, element in ElementTree.iterparse(io.BytesIO(content), ("start", "end")):
            tag = element.tag.rpartition("}")[2]
            if event == "start" and tag == "Entity":
                entity = printable(element.get("name", "")).removesuffix("_XFORM")
            elif event == "start" and tag == "Component":
                name = printable(element.get("name", ""))
                header = name if entity.lower() == name.lower() else f"{entity}.{name}"
                names[int(element.get("id", "")[:9])] = (header, element.get("unitsValue", ""))
            elif event == "end" and tag == "Step":
                if element.get("type") not in STEPS_WITHOUT_INSTANT:
                    steps.append("\t".join((element.text or "").split()))
                element.clear()
    except ElementTree.ParseError as error:
        raise file.fail(error.position[0], f"expected valid XML of Adams, got {error.msg}; export it again") from error
    except ValueError as error:
        raise file.fail(1, f"expected a number for the id of '{entity}', got another; export it again") from error
    blocks = [*read_tables(ResultText(f"{file.name}[steps]", "\n".join(steps)))]
    if len(blocks) > 1 or len(blocks[0][1]) != len(names):
        raise file.fail(1, f"expected {len(names)} numbers in every step, got another count; export the results again")
    every = zip(blocks[0][1], sorted(names.items()), strict=True)
    return [replace(column, header=header, unit=unit) for column, (_, (header, unit)) in every]


MOST_TABLES: Final = 1000  # of a file
# Modelica tools, FMU and Simscape exports print names of variables, which may be elements of arrays, and no units.
MODELICA_NAME: Final = re.compile(r"[^()\[\]/ ]+(?:\[[\d,]+\])?")


def result_tables(path: Path) -> list[ResultTable]:
    """Every table of a file in its order; raises LinkproofError with file and line for what cannot be read."""
    check_file(path, "expected a file of results, such as a CSV")
    kind, name = path.suffix.lower(), printable(str(path))
    every: list[ResultTable] = []
    if kind == ".fmu":
        raise LinkproofError(
            f"{name}: expected a file of results, got an FMU, which judge does not run; make its results a CSV with "
            "'fmpy simulate FILE --output-file out.csv'"
        )
    if kind == ".mat":
        is_trajectory, parts = matlab_columns(path)
        every = [ResultTable(name, 1, is_trajectory, tuple(part)) for part in parts if len(part) > 1]
    else:
        for file in read_workbook(path) if kind in (".xlsx", ".xlsm") else (read_text(path),):
            for table in _read_tables(file):
                every.append(table)
                if len(every) > MOST_TABLES:
                    raise file.fail(table.line, f"expected at most {MOST_TABLES} tables, got more; export fewer")
    if not every:
        raise LinkproofError(
            f"{name}:1: expected a column of time or crank angle and others beside it, got no two columns of one "
            "length; export both"
        )
    return every


def _read_tables(file: ResultText) -> Iterator[ResultTable]:
    """Every table of a text."""
    if not file.text.strip():
        raise file.fail(1, "expected a table of results, got an empty file; export it again")
    if is_adams(file.text):
        yield ResultTable(file.name, 1, False, tuple(adams_columns(file)))
        return
    for line, columns in read_tables(file):
        is_si = columns[0].header == "time" and all(MODELICA_NAME.fullmatch(c.header) and not c.unit for c in columns)
        yield from (
            ResultTable(file.name, line, is_si, tuple(part)) for part in _split_at_axis(columns) if len(part) > 1
        )


def _split_at_axis(columns: Sequence[Column]) -> Iterator[list[Column]]:
    """Columns parted where the first of them, the axis, is written again, be it without a header, as Adams does."""
    part: list[Column] = []
    for column in columns:
        if part and _repeats_axis(column, columns[0]):
            yield part
            part = [replace(column, header=columns[0].header)]
        else:
            part.append(column)
    yield part


def _repeats_axis(column: Column, first: Column) -> bool:
    """Whether a column is the first one, the axis, again."""
    if column.header or not first.header:
        return bool(first.header) and column.header == first.header
    return bool(column.values[0] == first.values[0] and np.all(np.diff(column.values) > 0.0))


def number_headers(every: Iterable[ResultTable]) -> list[ResultTable]:
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
