"""Designs as a table in a CSV file: a column per parameter, a row per design."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, shortened
from comparisons.designs.parameters import Parameter, parameter
from comparisons.designs.sweep.space import Listed

if TYPE_CHECKING:
    import pandas

Array = NDArray[np.float64]

ROWS: Final = 100_000  # read at once
OTHER_MARKS: Final = {";": "semicolons", "\t": "tabs"}  # of spreadsheets


def read_table(path: Path, linkage: Linkage) -> Listed:
    """The table of a file, whose first line names parameters: ``rod.B.x`` or ``rod.B.x [cm]``.

    Raises UnknownNameError for an unknown column or unit, LinkproofError for a file that cannot be read and
    rows that are no designs.
    """
    import pandas  # noqa: PLC0415 - half a second that only a table pays for

    start = f"--table '{path}': expected"
    plain = {"header": None, "index_col": False, "dtype": str, "keep_default_na": False, "skip_blank_lines": False}
    try:
        head = pandas.read_csv(path, nrows=1, encoding="utf-8-sig", **plain)
        columns = _columns(start, head.iloc[0].tolist() if len(head) else [], linkage)
        chunks = pandas.read_csv(
            path, skiprows=1, names=range(len(columns) + 1), chunksize=ROWS, encoding="utf-8-sig", **plain
        )
        with chunks:
            parts = [_values(start, chunk, columns) for chunk in chunks]
    except OSError as error:
        raise LinkproofError(f"{start} a file, got {error.strerror}; correct the path") from error
    except UnicodeDecodeError as error:
        raise LinkproofError(f"{start} text in UTF-8, got other bytes; save it as CSV") from error
    except pandas.errors.EmptyDataError:
        parts = []
    except pandas.errors.ParserError as error:
        why = str(error).removeprefix("Error tokenizing data. C error: ").strip()
        raise LinkproofError(f"{start} a cell per column in every row, got other rows: {why}; correct it") from error
    values = np.concatenate(parts or [np.empty((1, 0))], axis=1)
    if not values.size:
        raise LinkproofError(f"{start} a head that names parameters and a row per design below, got none; add some")
    return Listed(tuple(number for number, _ in columns), tuple(values))


def _columns(start: str, names: list[str], linkage: Linkage) -> list[tuple[Parameter, float]]:
    """The parameters of a head, each with the size of its column's unit in that of the linkage's file."""
    if len(names) == 1 and (other := next((word for mark, word in OTHER_MARKS.items() if mark in names[0]), None)):
        raise LinkproofError(f"{start} commas between columns, and points in numbers, got {other}; save it so")
    if not any(name.strip() for name in names):
        raise LinkproofError(f"{start} a head that names parameters, got an empty line; add it")
    columns = []
    for number, cell in enumerate(names, start=1):
        if not cell.strip():
            raise LinkproofError(
                f"{start} a parameter's name over every column, got nothing over column {number}; add it, or leave the "
                "column out"
            )
        name, bracket, unit = cell.strip().partition("[")
        entry = parameter(linkage, name.strip())
        size = entry.si(f"1 {unit.strip().removesuffix(']').strip()}") / entry.unit.size if bracket else 1.0
        columns.append((entry, size))
    return columns


def _values(start: str, chunk: pandas.DataFrame, columns: list[tuple[Parameter, float]]) -> Array:
    """The numbers of some rows in the file's units, (columns, rows); raises LinkproofError for a cell without one."""
    import pandas  # noqa: PLC0415

    cells = chunk.fillna("").apply(lambda column: column.str.strip())
    cells = cells[(cells != "").any(axis=1)]  # lines without a design count for nothing
    numbers = cells.iloc[:, :-1].apply(pandas.to_numeric, errors="coerce").to_numpy(dtype=float)
    wrong = np.column_stack([~np.isfinite(numbers), cells.iloc[:, -1] != ""])
    if np.any(wrong):
        row, column = np.argwhere(wrong)[0]
        is_named, got = column < len(columns), cells.iat[row, column]
        where = f"column {columns[column][0].name}" if is_named else f"column {column + 1}, which has no name"
        what = f"'{shortened(got)}'" if got else "nothing"
        raise LinkproofError(
            f"{start} {'a finite number' if is_named else 'nothing'} in line {cells.index[row] + 2}, {where}, got "
            f"{what}; correct it"
        )
    exact = cells.iloc[:, :-1].to_numpy(dtype=object).astype(float)  # to_numeric is off by a last digit here and there
    return np.asarray(exact.T * np.array([size for _, size in columns])[:, None])
