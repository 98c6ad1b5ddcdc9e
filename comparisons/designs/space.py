"""Spaces of designs: the grid of several ranges, or a list; their values are in the units of the linkage's file.

The designs of a grid are numbered in C order, its last axis fastest.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, shortened
from comparisons.designs.parameters import Parameter, parameter

Array = NDArray[np.float64]

MOST: Final = 2 * 10**7  # values of an axis, and figures of all designs together: they are in memory
ONE_BY_ONE: Final = "design"  # the dimension of a list
RANGE_FORM: Final = "NAME=FIRST:LAST:COUNT, such as rod.B.x=170:180:1000"


@dataclass(frozen=True)
class DesignSpace:
    """The grid of every combination of the ``columns``, the values of each parameter; or their rows, a list."""

    parameters: tuple[Parameter, ...]
    columns: tuple[Array, ...]
    is_list: bool = False

    def __post_init__(self) -> None:
        names = [number.name for number in self.parameters]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise LinkproofError(f"expected every parameter once, got {twice} twice: leave one of the two out")

    @property
    def shape(self) -> tuple[int, ...]:
        """Designs along each dimension."""
        return (len(self.columns[0]),) if self.is_list else tuple(map(len, self.columns))

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions: the parameters of a grid."""
        return (ONE_BY_ONE,) if self.is_list else tuple(number.name for number in self.parameters)

    @property
    def ends(self) -> Array:
        """Least and largest value of every parameter, (parameters, 2), in the file's units."""
        return np.array([[np.min(values), np.max(values)] for values in self.columns])

    @property
    def count(self) -> int:
        """Number of designs."""
        return math.prod(self.shape)

    def file_values(self, first: int, last: int) -> Array:
        """Values of the designs from number ``first`` up to ``last``, (parameters, designs), in the file's units."""
        if self.is_list:
            return np.stack([values[first:last] for values in self.columns])
        places = np.unravel_index(np.arange(first, last), self.shape)
        return np.stack([axis[place] for axis, place in zip(self.columns, places, strict=True)])

    def block(self, first: int, last: int) -> dict[str, Array]:
        """SI values (designs,) of the designs from number ``first`` up to ``last``, by parameter."""
        values = self.file_values(first, last)
        return {number.name: row * number.unit.size for number, row in zip(self.parameters, values, strict=True)}


def parameter_range(linkage: Linkage, text: str) -> tuple[Parameter, Array]:
    """The parameter and its values, in equal steps, that ``--vary rod.B.x=170:180:1000`` means.

    Raises UnknownNameError for an unknown parameter or unit, LinkproofError for a malformed range.
    """
    name, equals, ends = text.partition("=")
    words = ends.split(":")
    if not equals or len(words) != 3:
        raise LinkproofError(f"--vary: expected {RANGE_FORM}, got '{text}'; correct it")
    number = parameter(linkage, name.strip())
    first, last = (number.in_file(word) for word in words[:2])
    count = int(words[2]) if re.fullmatch(r"\s*\d{1,18}\s*", words[2], re.ASCII) else 0
    if not 1 <= count <= MOST:
        raise LinkproofError(
            f"--vary {name}: expected a number of values from 1 to {MOST:.0e}, got '{words[2]}'; write {RANGE_FORM}"
        )
    if (count == 1) != (first == last) or not math.isfinite(last - first):
        raise LinkproofError(
            f"--vary {name}: expected {'two values that differ' if count > 1 else 'a single value, twice'} for "
            f"{count} value{'s' if count > 1 else ''}, got {words[0]} and {words[1]}; correct the range or the count"
        )
    return number, np.linspace(first, last, count)


# Designs as a table in a CSV file: a column per parameter, a row per design.

OTHER_MARKS: Final = {";": "semicolons", "\t": "tabs"}  # of spreadsheets


def read_table(path: Path, linkage: Linkage) -> DesignSpace:
    """The table of a file, whose first line names parameters: ``rod.B.x`` or ``rod.B.x [cm]``.

    Raises UnknownNameError for an unknown column or unit, LinkproofError for a file that cannot be read and
    rows that are no designs.
    """
    import pandas  # noqa: PLC0415 - half a second that only a table pays for

    start = f"--table '{path}': expected"
    read = partial(
        pandas.read_csv, path, header=None, index_col=False, dtype=str, keep_default_na=False, skip_blank_lines=False,
        encoding="utf-8-sig",
    )  # fmt: skip
    try:
        columns = _read_head(start, read(nrows=1).iloc[0].tolist(), linkage)
        cells = read().fillna("")
    except OSError as error:
        raise LinkproofError(f"{start} a file, got {error.strerror}; correct the path") from error
    except UnicodeDecodeError as error:
        raise LinkproofError(f"{start} text in UTF-8, got other bytes; save it as CSV") from error
    except pandas.errors.EmptyDataError as error:
        raise LinkproofError(f"{start} a head that names parameters, got an empty file; add it") from error
    except pandas.errors.ParserError as error:
        why = str(error).removeprefix("Error tokenizing data. C error: ").strip()
        raise LinkproofError(f"{start} a cell per column in every row, got other rows: {why}; correct it") from error
    rows = cells.iloc[1:].apply(lambda column: column.str.strip())
    rows = rows[(rows != "").any(axis=1)]  # lines without a design count for nothing
    if rows.empty:
        raise LinkproofError(f"{start} a head that names parameters and a row per design below, got none; add some")
    wrong = np.argwhere(~np.isfinite(rows.apply(pandas.to_numeric, errors="coerce").to_numpy(dtype=float)))
    if len(wrong):
        row, column = wrong[0]
        got = f"'{shortened(rows.iat[row, column])}'" if rows.iat[row, column] else "nothing"
        raise LinkproofError(
            f"{start} a finite number in line {rows.index[row] + 1}, column {columns[column][0].name}, got {got}; "
            "correct it"
        )
    exact = rows.to_numpy(dtype=object).astype(float)  # to_numeric is off by a last digit here and there
    values = exact.T * np.array([size for _, size in columns])[:, None]
    return DesignSpace(tuple(number for number, _ in columns), tuple(values), is_list=True)


def _read_head(start: str, names: list[str], linkage: Linkage) -> list[tuple[Parameter, float]]:
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
