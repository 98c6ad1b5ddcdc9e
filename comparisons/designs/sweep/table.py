"""Designs as a table in a CSV file: a column per parameter, a row per design, read in blocks however long it is."""

from __future__ import annotations

import csv
import hashlib
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import IO, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, shortened
from comparisons.designs.parameters import Parameter, parameter
from comparisons.designs.sweep.space import DesignSpace, Listed

Array = NDArray[np.float64]

BLOCK: Final = 50_000  # rows
OTHER_MARKS: Final = {";": "semicolons", "\t": "tabs"}  # of spreadsheets


@dataclass(frozen=True)
class TableFile(DesignSpace):
    """The designs of a file.

    ``sizes`` are those of the columns' units in the linkage's; ``blocks`` are the number of the first design of every
    so many lines, and its place in the file; ``extent`` are the ``ends``, ``digest`` tells the file from any other.
    """

    path: Path
    sizes: Array
    rows: int
    blocks: tuple[tuple[int, int], ...]
    extent: Array
    digest: str = field(default="", compare=False)
    _last: dict[tuple[int, int], Array] = field(default_factory=dict, compare=False, repr=False)  # what was read last

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of designs."""
        return (self.rows,)

    @property
    def ends(self) -> Array:
        """Least and largest value of every column."""
        return self.extent

    def part(self, first: int, last: int) -> Listed:
        """These designs alone, without the file."""
        return Listed(self.parameters, self.shown(first, last), first)

    def shown(self, first: int, last: int) -> Array:
        """Values of a range of designs, (parameters, designs)."""
        if (first, last) not in self._last:
            self._last.clear()
            self._last[first, last] = self._read(first, last)
        return self._last[first, last]

    def _read(self, first: int, last: int) -> Array:
        start, place = self.blocks[bisect_right(self.blocks, first, key=lambda block: block[0]) - 1]
        found = []
        with self.path.open("rb") as file:
            file.seek(place)
            while start < last and (lines := list(islice(file, BLOCK))):
                values = _values(self.path, lines, start, self.sizes)
                found.append(values[:, max(first - start, 0) : last - start])
                start += values.shape[1]
        return np.concatenate(found, axis=1)


def table_file(path: Path, linkage: Linkage) -> TableFile:
    """The table of a file, whose first line names parameters: ``rod.B.x`` or ``rod.B.x [cm]``.

    Every row is looked at once. Raises UnknownNameError for a column or a unit that there is not, LinkproofError for a
    file that cannot be read and rows that are no designs.
    """
    try:
        with path.open("rb") as file:
            return _read(path, file, linkage)
    except OSError as error:
        raise LinkproofError(f"--table '{path}': expected a file, got {error.strerror}; correct the path") from error
    except UnicodeDecodeError as error:
        raise LinkproofError(f"--table '{path}': expected text in UTF-8, got other bytes; save it as CSV") from error


def _read(path: Path, file: IO[bytes], linkage: Linkage) -> TableFile:
    digest = hashlib.sha256(head := file.readline())
    columns, sizes = _columns(path, head.decode("utf-8-sig"), linkage)
    blocks, rows, ends = [], 0, []
    for place, lines in _pieces(file):
        values = _values(path, lines, rows, sizes)
        if values.size:
            blocks.append((rows, place))
            ends += [np.min(values, axis=1), np.max(values, axis=1)]
        rows += values.shape[1]
        digest.update(b"".join(lines))
        ends = [np.min(ends, axis=0), np.max(ends, axis=0)] if ends else []
    if not rows:
        raise LinkproofError(f"--table '{path}': expected a row per design below its head, got none; add some")
    return TableFile(columns, path, sizes, rows, tuple(blocks), np.stack(ends, axis=1), digest.hexdigest())


def _pieces(file: IO[bytes]) -> Iterator[tuple[int, list[bytes]]]:
    while True:
        place = file.tell()
        lines = list(islice(file, BLOCK))
        if not lines:
            return
        yield place, lines


def _columns(path: Path, head: str, linkage: Linkage) -> tuple[tuple[Parameter, ...], Array]:
    try:
        names = next(csv.reader([head]), [])
    except csv.Error as error:
        raise LinkproofError(f"--table '{path}': expected parameters' names in the first line, got no such line; "
                             "save it as CSV in UTF-8") from error  # fmt: skip
    if len(names) == 1 and (other := next((word for mark, word in OTHER_MARKS.items() if mark in head.strip()), None)):
        raise LinkproofError(
            f"--table '{path}': expected commas between columns, and points in numbers, got {other}; save it so"
        )
    if not any(name.strip() for name in names):
        raise LinkproofError(f"--table '{path}': expected a head that names parameters, got an empty line; add it")
    columns, sizes = [], []
    for number, cell in enumerate(names, start=1):
        if not cell.strip():
            raise LinkproofError(f"--table '{path}': expected a parameter's name over every column, got nothing over "
                                 f"column {number}; add it, or leave the column out")  # fmt: skip
        name, bracket, unit = cell.strip().partition("[")
        found = parameter(linkage, name.strip())
        columns.append(found)
        sizes.append(found.si(f"1 {unit.strip().removesuffix(']').strip()}") / found.unit.size if bracket else 1.0)
    return tuple(columns), np.array(sizes)


def _values(path: Path, lines: list[bytes], start: int, sizes: Array) -> Array:
    """The numbers of these lines in the file's units, (columns, rows); the first is that of design ``start``."""
    text = [line for line in lines if line.strip()]
    if not text:
        return np.empty((len(sizes), 0))
    try:
        rows = np.loadtxt([line.decode() for line in text], delimiter=",", ndmin=2, comments=None)
        if rows.shape[1] == len(sizes) and np.all(np.isfinite(rows)):
            return np.asarray(rows.T * sizes[:, None])
    except ValueError:
        pass
    number, line = next((n, line) for n, line in enumerate(text) if not _is_row(line, len(sizes)))
    raise LinkproofError(
        f"--table '{path}': expected {_numbers(len(sizes))} in every row, got "
        f"'{shortened(line.decode(errors='replace').strip())}' for design {start + number}; correct it"
    )


def _numbers(count: int) -> str:
    return "1 finite number" if count == 1 else f"{count} finite numbers with commas between them"


def _is_row(line: bytes, columns: int) -> bool:
    try:
        values = [float(cell) for cell in line.decode().split(",")]
    except ValueError:
        return False
    return len(values) == columns and bool(np.all(np.isfinite(values)))
