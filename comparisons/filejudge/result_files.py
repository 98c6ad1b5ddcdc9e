"""Result files of other tools as tables of columns, whatever their layout: texts, workbooks, MATLAB files, Modelica's.

OpenModelica and Dymola write matrices ``Aclass``, ``name``, ``dataInfo``, ``data_1`` (what is constant), ``data_2``, as
they are or transposed (``Aclass[3]`` says which): ``dataInfo`` has for each name the matrix and the row, with a sign.
"""

from __future__ import annotations

import io
import math
import os
import re
import subprocess
import sys
import zipfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError, printable
from analytic.files import check_file, read_file
from comparisons.filejudge.columns import Column, ResultTable
from comparisons.filejudge.text_tables import (
    EXPECTED,
    LARGEST,
    LARGEST_NUMBER,
    MOST_NUMBERS,
    ResultText,
    read_tables,
    read_text,
)

TRAJECTORY: Final = ("Aclass", "name", "dataInfo", "data_2")
# The script that writes the arrays of a file to arrays.npz, in a process of its own, which a damaged file may crash.
MATLAB_READER: Final = Path(__file__).with_name("read_matlab.py")
LONGEST_RUN: Final = 60.0  # s, of the script
MOST_WORDS: Final = 500  # characters of what is wrong

# Adams result files (``.res``): XML of schema xrf 2.0, as Adams/Solver and the solver in SolidWorks Motion write it.
#
# ``StepMap`` lists entities with their components, each with ``id`` and ``unitsValue``; a ``Step`` holds one instant,
# its numbers in the order of the ids.


STEPS_WITHOUT_INSTANT: Final = ("input", "output")  # types of steps that are no instants of the motion


def read_workbook(path: Path) -> Iterator[ResultText]:
    """The sheets of a workbook as tables parted by tabs; raises LinkproofError for what cannot be read."""
    try:
        from openpyxl import load_workbook  # noqa: PLC0415 - an extra
    except ImportError:
        raise LinkproofError(
            f"{path}: expected openpyxl to read a workbook, got none installed; pip install 'linkproof[xlsx]', or "
            "export the results as CSV"
        ) from None
    content = io.BytesIO(read_file(path, EXPECTED, LARGEST))
    try:
        with zipfile.ZipFile(content) as parts:
            size = sum(part.file_size for part in parts.infolist())
        for sheet in load_workbook(content, read_only=True, data_only=True).worksheets:
            lines, numbers = [], 0
            for row in sheet.iter_rows(values_only=True):
                lines.append("\t".join("" if cell is None else " ".join(str(cell).split()) for cell in row))
                numbers = max(numbers, sum(isinstance(cell, int | float) for cell in row))
                size += len(lines[-1])  # of empty cells, too
                if size > LARGEST:
                    raise ValueError(f"more than {LARGEST >> 20} MB of cells")
            if numbers > 1:  # no sheet of notes
                yield ResultText(f"{printable(str(path))}[{printable(sheet.title)}]", "\n".join(lines))
    except Exception as error:  # errors of damaged zip, XML and cells have no common class
        raise _reading_error(path, "a workbook", error) from error


def _reading_error(path: Path, kind: str, error: Exception) -> LinkproofError:
    """The error to raise about a file that a reader refused."""
    reason = str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}"
    return LinkproofError(
        f"{path}: expected a file of results, got {kind} that cannot be read ({reason}); export the results as CSV"
    )


def _read_arrays(path: Path) -> dict[str, Any]:
    """The arrays, by name, of a MATLAB file; raises ValueError with the last words of the script that reads it."""
    with TemporaryDirectory() as folder:  # removed with everything that the script writes
        command = [sys.executable, "-P", str(MATLAB_READER), str(path.resolve()), str(MOST_NUMBERS)]
        try:
            done = subprocess.run(
                command, cwd=folder, env={**os.environ, "TMPDIR": folder}, timeout=LONGEST_RUN, check=False,
                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise ValueError(f"it takes more than {LONGEST_RUN:.0f} s") from None
        words = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        result = Path(folder, "arrays.npz")
        if done.returncode or not result.exists():
            raise ValueError(printable(words[-MOST_WORDS:]) if done.returncode > 0 and words else "it crashes")
        with np.load(result) as arrays:
            return dict(arrays)


def _column(path: Path, name: str, unit: str, array: NDArray[Any]) -> Column:
    """A column as sharp as its numbers are; raises LinkproofError for numbers that are not finite."""
    values = array.astype(float)
    if not (np.abs(values) < LARGEST_NUMBER).all():
        raise LinkproofError(f"{path}: expected finite numbers of '{printable(name)}', got others; export it again")
    sharp = np.finfo(array.dtype if array.dtype.kind == "f" else float).eps * np.abs(values)
    return Column(name, unit, values, sharp, f"{path} ({printable(name)})")


def matlab_columns(path: Path) -> tuple[bool, list[list[Column]]]:
    """Whether a MATLAB file is a trajectory of Modelica, and the columns of every length in it.

    Raises LinkproofError for one that cannot be read.
    """
    check_file(path, EXPECTED, LARGEST)
    try:
        data = {name[1:]: array for name, array in _read_arrays(path).items()}
        is_trajectory = all(name in data for name in TRAJECTORY)
        arrays = dict(_modelica_curves(data) if is_trajectory else _matlab_curves(data))
    except Exception as error:  # errors of damaged matrices have no common class
        raise _reading_error(path, "a MATLAB file", error) from error
    tables: dict[int, list[Column]] = {}
    for name, array in arrays.items():
        tables.setdefault(len(array), []).append(_column(path, name, "", array))
    return is_trajectory, list(tables.values())


def _modelica_curves(data: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Names and values of all that varies, the time first."""
    is_transposed = "".join(data["Aclass"][3]).strip("\0 ") == "binTrans"
    names, info, values = (data[key].T if is_transposed else data[key] for key in TRAJECTORY[1:])
    for name, (matrix, place, *_) in zip(names, info.astype(int), strict=True):
        if matrix in (0, 2) and place:
            yield "".join(name).strip("\0 "), math.copysign(1.0, place) * values[:, abs(place) - 1]


def _matlab_curves(data: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Names and values of vectors and of the columns of matrices."""
    for name, array in data.items():
        every = array if array.shape[0] == 1 else array.T
        if array.dtype.kind in "fiu" and array.size > 1:
            for number, values in enumerate(every, start=1):
                yield f"{name}({number})" if len(every) > 1 else name, values


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
