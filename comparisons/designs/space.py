"""Spaces of designs: the grid of several ranges, or a list; designs are numbered, and a grid's are made when needed.

The designs of a grid are numbered in C order, its last axis fastest. Values are in the units of the linkage's file.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, shortened
from comparisons.designs.parameters import Parameter, parameter

if TYPE_CHECKING:
    import pandas


Array = NDArray[np.float64]

MOST: Final = 10**12  # designs: half a day's work for a thousand cores
LONGEST: Final = 10**7  # values of an axis, which are in memory
ONE_BY_ONE: Final = "design"  # the dimension of a list
RANGE_FORM: Final = "NAME=FIRST:LAST:COUNT, such as rod.B.x=170:180:1000"


@dataclass(frozen=True)
class DesignSpace(ABC):
    """Designs by number: the values of their ``parameters`` in the units of the file.

    ``columns`` are of every parameter the values of its axis, or those of all designs of a list.
    """

    parameters: tuple[Parameter, ...]
    columns: tuple[Array, ...]

    def __post_init__(self) -> None:
        names = [number.name for number in self.parameters]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise LinkproofError(f"expected every parameter once, got {twice} twice: leave one of the two out")

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """Designs along each dimension."""

    @property
    @abstractmethod
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions."""

    @abstractmethod
    def file_values(self, first: int, last: int) -> Array:
        """Values of the designs from number ``first`` up to ``last``, (parameters, designs), in the file's units."""

    def subset(self, first: int, last: int) -> DesignSpace:
        """The space of some designs under their numbers, small enough to be sent to another process."""
        return self

    @property
    def ends(self) -> Array:
        """Least and largest value of every parameter, (parameters, 2), in the file's units."""
        return np.array([[np.min(values), np.max(values)] for values in self.columns])

    @property
    def count(self) -> int:
        """Number of designs."""
        return math.prod(self.shape)

    def block(self, first: int, last: int) -> dict[str, Array]:
        """SI values (designs,) of the designs from number ``first`` up to ``last``, by parameter."""
        values = self.file_values(first, last)
        return {number.name: row * number.unit.size for number, row in zip(self.parameters, values, strict=True)}


@dataclass(frozen=True)
class Grid(DesignSpace):
    """Every combination of the values of its axes."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.count > MOST:
            raise LinkproofError(
                f"expected {MOST:.0e} designs at most, got {' × '.join(map(str, self.shape))}: give fewer steps"
            )

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of every axis."""
        return tuple(map(len, self.columns))

    @property
    def dimensions(self) -> tuple[str, ...]:
        """The axes, by their parameters."""
        return tuple(number.name for number in self.parameters)

    def file_values(self, first: int, last: int) -> Array:
        """Values of the designs ``first`` up to ``last``, (parameters, designs), in the file's units."""
        places = np.unravel_index(np.arange(first, last), self.shape)
        return np.stack([axis[place] for axis, place in zip(self.columns, places, strict=True)])


@dataclass(frozen=True)
class Listed(DesignSpace):
    """Designs one by one, of which the first has the number ``start``."""

    start: int = 0

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of designs."""
        return (len(self.columns[0]),)

    @property
    def dimensions(self) -> tuple[str, ...]:
        """One, of all designs."""
        return (ONE_BY_ONE,)

    def file_values(self, first: int, last: int) -> Array:
        """Values of the designs ``first`` up to ``last``, (parameters, designs), in the file's units."""
        return np.stack([values[first - self.start : last - self.start] for values in self.columns])

    def subset(self, first: int, last: int) -> Listed:
        """A list of some designs under their numbers."""
        return Listed(self.parameters, tuple(self.file_values(first, last)), first)


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
    if not 1 <= count <= LONGEST:
        raise LinkproofError(
            f"--vary {name}: expected a number of values from 1 to {LONGEST:.0e}, got '{words[2]}'; write {RANGE_FORM}"
        )
    if (count == 1) != (first == last) or not math.isfinite(last - first):
        raise LinkproofError(
            f"--vary {name}: expected {'two values that differ' if count > 1 else 'a single value, twice'} for "
            f"{count} value{'s' if count > 1 else ''}, got {words[0]} and {words[1]}; correct the range or the count"
        )
    return number, np.linspace(first, last, count)


# Designs as a table in a CSV file: a column per parameter, a row per design.

ROWS_AT_ONCE: Final = 100_000  # read at once
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
        columns = _read_head(start, head.iloc[0].tolist() if len(head) else [], linkage)
        chunks = pandas.read_csv(
            path, skiprows=1, names=range(len(columns) + 1), chunksize=ROWS_AT_ONCE, encoding="utf-8-sig", **plain
        )
        with chunks:
            parts = [_read_rows(start, chunk, columns) for chunk in chunks]
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


def _read_rows(start: str, chunk: pandas.DataFrame, columns: list[tuple[Parameter, float]]) -> Array:
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
