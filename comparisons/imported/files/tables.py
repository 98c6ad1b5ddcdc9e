"""Tables of numbers in a text: titles, headers, rows of units and comments, by what is a row of numbers.

What stands between numbers and before decimals is what makes numbers of most rows; pandas reads them.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Final, NamedTuple

import numpy as np
import pandas

from analytic.errors import LinkproofError, shortened
from comparisons.imported.columns import Array, Column
from comparisons.imported.files.text import ResultText
from comparisons.imported.headers.units import parsed

# A line that holds anything but numbers; its first part cannot give back what it took, so a search is linear.
WORDS: Final = re.compile(r"^[0-9eEdD+\-.,;|\t \"]*+[^0-9eEdD+\-.,;|\t \"\n].*$", re.MULTILINE)
COMMENT: Final = re.compile(r"\s*(?:[#%!*]+|//+)\s*")
NUMBER: Final = re.compile(r"[+-]?(?=\.?[0-9])([0-9]*+)\.?([0-9]*+)(?:[eEdD]([+-]?[0-9]{1,3}))?")
NOT_FINITE: Final = re.compile(r"[+-]?(?:nan|n/?a|null|none|inf|infinity|∞|1\.#\w+|#\w+[!/?]?\w*[!?]?)", re.IGNORECASE)
BLANK: Final = r"\s+"
# As they are tried: what parts cells, and the decimal sign; with both a comma cells are quoted.
LAYOUTS: Final = (
    *(("\t", "."), (";", "."), (",", "."), ("|", "."), (BLANK, ".")),
    *(("\t", ","), (";", ","), (",", ","), (BLANK, ",")),
)
SAMPLE: Final = 50  # rows looked at to tell a layout
CHUNK: Final = 1 << 22  # characters parsed at a time
DIGITS_OF: Final = 300  # rows of a chunk whose digits are counted
LARGEST: Final = 1e100  # of a number: squares of larger ones are beyond all numbers
LONGEST: Final = 60  # characters of a number
MOST_LINES: Final = 20_000  # of text before or behind a table
MOST_COLUMNS: Final = 10_000
LONGEST_ROW: Final = 1 << 18  # characters
MOST_DIGITS: Final = 17  # of a double: more say nothing


@dataclass(frozen=True)
class Layout:
    """What parts the cells of a row, and the decimal sign."""

    delimiter: str
    decimal: str

    def cells(self, row: str) -> list[str]:
        """The cells of a row, numbers with a decimal point."""
        if self.delimiter == BLANK:
            cells = row.replace('"', "").split()
        else:
            cells = [cell.strip() for cell in _parted(row, self.delimiter)]
        return [cell.replace(",", ".") for cell in cells] if self.decimal == "," else cells

    def width(self, row: str) -> int:
        """How many cells a row of numbers has, some of which may be empty; 0 for another row."""
        cells = self.cells(row)
        numbers = sum(map(is_number, cells))
        return len(cells) if numbers > 1 and numbers + cells.count("") == len(cells) else 0


def is_number(cell: str) -> bool:
    """Whether a cell is a finite number with a decimal point."""
    plain = cell.replace("d", "e").replace("D", "e")
    return len(cell) <= LONGEST and bool(NUMBER.fullmatch(cell)) and abs(float(plain)) < LARGEST


def _parted(row: str, delimiter: str) -> list[str]:
    try:
        return next(csv.reader([row], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:  # a cell that is too long
        return row.split(delimiter)


def _layout(rows: Sequence[str]) -> Layout:
    """The layout in which most of the first rows are numbers, as many in each as in the first."""

    def fit(layout: Layout) -> int:
        widths = [layout.width(row) for row in rows]
        return widths.count(next(filter(None, widths), -1))

    return max((Layout(*signs) for signs in LAYOUTS), key=fit)


class _Part(NamedTuple):
    """Lines of a text from one on, counted from 1: rows of numbers, or a line of anything else."""

    line: int
    text: str
    is_rows: bool


@dataclass
class _Table:
    """A header, on a line counted from 1, and what stands in its columns: values and some words as printed."""

    file: ResultText
    line: int
    names: list[str]
    units: list[str]
    layout: Layout
    text: str = ""  # of the header
    values: list[Array] = field(default_factory=list)
    words: list[list[str]] = field(default_factory=list)

    def read(self, rows: str, line: int) -> None:
        """Parse rows of numbers, which begin on a line, some thousands at a time."""
        start = 0
        while start < len(rows):
            end = rows.find("\n", start + CHUNK) + 1 or len(rows)
            self._parse(rows[start:end], line)
            line += rows.count("\n", start, end)
            start = end

    def _parse(self, rows: str, line: int) -> None:
        lines = [row for row in rows.split("\n") if row and not row.isspace()]
        if not lines:
            return
        signs = {"sep": self.layout.delimiter, "decimal": self.layout.decimal, "names": range(len(self.names))}
        if "D" in rows or "d" in rows:  # as Fortran writes exponents
            rows = rows.replace("D", "e").replace("d", "e")
        if len(self.layout.cells(lines[0])) != len(self.names):
            raise self._bad_row(rows, line)
        try:
            data = io.BytesIO(rows.encode())
            frame = pandas.read_csv(data, header=None, dtype=float, index_col=False, skipinitialspace=True, **signs)
        except (ValueError, OverflowError):  # of pandas' own, all of them
            raise self._bad_row(rows, line) from None
        numbers = frame.to_numpy()
        if len(numbers) != len(lines) or not (np.abs(numbers[~np.isnan(numbers)]) < LARGEST).all():
            raise self._bad_row(rows, line)
        before = self.values[-1][-1:] if self.values else numbers[:1]
        is_open = np.isnan(np.vstack([before, numbers]))
        if (is_open[:-1] & ~is_open[1:]).any():  # a number below an empty cell
            raise self._bad_row(rows, line)
        self.values.append(numbers)
        self.words += [self.layout.cells(row) for row in lines[:: max(1, len(lines) // DIGITS_OF)]]

    def _bad_row(self, rows: str, line: int) -> LinkproofError:
        """What is wrong with the first row that has another number of cells, or a cell that is no number."""
        for number, row in enumerate(rows.split("\n"), start=line):
            cells = self.layout.cells(row)
            if row.strip() and len(cells) != len(self.names):
                return self.file.fail(
                    number,
                    f"expected {len(self.names)} columns, as the header of line {self.line} has, got {len(cells)}; "
                    "complete the row, or give every table a header of its own",
                )
            if row.strip() and not all(map(is_number, cells)):
                return bad_cell(self.file, number, cells)
        return self.file.fail(line, "expected rows of numbers, got columns that end before others; export them again")

    def columns(self) -> Iterator[Column]:
        """The columns that hold numbers."""
        every = np.concatenate(self.values)
        for number, words in enumerate(zip_longest(*self.words, fillvalue="")):
            values = every[~np.isnan(every[:, number]), number]
            if len(values):
                place = f"{self.file.name}:{self.line} (column {number + 1})"
                header = self.names[number] or f"column {number + 1}"
                yield Column(header, self.units[number], values, resolution(values, words), place)


def resolution(values: Array, words: Sequence[str]) -> Array:
    """Half a unit of the last digit of each number of a column (n,), some of which are printed as ``words``.

    Where trailing zeros are left out, as by ``%g``, a short number is as sharp as the column's other numbers: it has
    their decimals or their number of digits, whichever is coarser.
    """
    printed = [match.groups("") for word in words if (match := NUMBER.fullmatch(word))]
    decimals = max((len(part) - int(exponent or 0) for _, part, exponent in printed), default=MOST_DIGITS)
    digits = max((len((whole + part).lstrip("0")) for whole, part, _ in printed), default=MOST_DIGITS)
    with np.errstate(divide="ignore"):
        magnitude = np.where(values == 0.0, -np.inf, np.floor(np.log10(np.abs(values))))
    last = np.minimum(decimals, np.clip(digits, 1, MOST_DIGITS) - magnitude - 1.0)
    return np.asarray(0.5 * 10.0 ** -np.clip(last, -300, 300))


def tables(file: ResultText, *, headless: str = "") -> Iterator[tuple[int, str, list[Column]]]:
    """The header of every table of a text, its line first, and its columns; raises LinkproofError with file and line.

    Where a tool writes no headers, ``headless`` begins the names that the columns are given.
    """
    above: list[_Part] = []  # what are no rows of numbers
    table: _Table | None = None
    for part in _parts(file.text):
        if not part.is_rows:
            above.append(part)
            if len(above) > MOST_LINES:
                raise file.fail(part.line, f"expected rows of numbers, got {MOST_LINES} lines of text; leave them out")
            continue
        current = _begin(file, above, part, table, headless)
        if table is not None and current is not table:
            yield table.line, table.text, [*table.columns()]
        table, above = current, []
        table.read(part.text, part.line)
    if table is None:
        for delimiter in ",;\t":
            _refuse_rows(file, above[:1000], Layout(delimiter, "."))
        number, text, _ = above[-1] if above else _Part(1, "", False)
        raise file.fail(
            number,
            f"expected rows of numbers below a header, got '{shortened(text.strip())}' and none; export the results "
            "with their values",
        )
    _refuse_rows(file, above, table.layout, len(table.names))
    yield table.line, table.text, [*table.columns()]


def _parts(text: str) -> Iterator[_Part]:
    """Blocks of rows of numbers and the lines between them."""
    start, line = 0, 1
    for words in WORDS.finditer(text):
        rows = text[start : words.start()]
        if rows.strip():
            yield _Part(line, rows, True)
        line += rows.count("\n")
        yield _Part(line, words.group(), False)
        start = words.end()
    if text[start:].strip():
        yield _Part(line, text[start:], True)


def _begin(file: ResultText, above: Sequence[_Part], rows: _Part, table: _Table | None, headless: str) -> _Table:
    """The table that rows belong to: one with a header above it, or the one before, which a comment interrupts."""
    first = [row for row in rows.text[:LONGEST_ROW].rpartition("\n")[0].split("\n") if row.strip()][:SAMPLE]
    first = first or [rows.text.strip("\n").partition("\n")[0]]
    at = rows.line + rows.text[: rows.text.index(first[0])].count("\n")
    if max(first[0].count(sign) for sign in ",;\t| ") > MOST_COLUMNS or len(first[0]) > LONGEST_ROW:
        raise file.fail(at, f"expected at most {MOST_COLUMNS} columns, got more; export fewer, or a row an instant")
    is_same = table is not None and table.layout.width(first[0]) == len(table.names)
    layout = table.layout if table is not None and is_same else _layout(first)
    row, at = layout.cells(first[0]), rows.line + rows.text[: rows.text.index(first[0])].count("\n")
    if len(row) > MOST_COLUMNS:
        raise file.fail(
            at, f"expected at most {MOST_COLUMNS} columns, got {len(row)}; export fewer, or a row an instant"
        )
    new = _header(file, [one for one in above if not one.text.startswith("sep=")], layout, row)  # Excel's own line
    if new is not None:
        _refuse_rows(file, [one for one in above if one.line > new.line], layout, len(row))
        return new
    if table is not None:
        _refuse_rows(file, above, table.layout, len(table.names))
        if all(COMMENT.match(one.text) for one in above):
            return table
    if headless and not above:
        return _Table(file, rows.line, [f"{headless} {n}" for n in range(len(row))], [""] * len(row), layout)
    if any(cell and not is_number(cell) for cell in row):
        raise bad_cell(file, at, row)
    if not above:
        raise file.fail(
            at, "expected a header above the numbers, got none; write a line with a name and a unit for each column"
        )
    count = len(next(_header_cells(above[-1].text, layout), " "))
    raise file.fail(
        at,
        f"expected as many numbers as headers, got {len(row)} below the {count} of line {above[-1].line}; check "
        "delimiters and decimal signs: with decimal commas columns are parted by semicolons or tabs",
    )


def _header(file: ResultText, above: Sequence[_Part], layout: Layout, row: Sequence[str]) -> _Table | None:
    """The last line above a block that has a header for every column, and the row of units below it, if any."""
    least, fitting = len(_without_empty_end(row)), []
    for line, text, _ in above:
        for cells in _header_cells(text, layout):
            named = _without_empty_end(cells)
            fits = named and (len(cells) == len(row) or least <= len(named) <= len(row))
            if fits and not any(is_number(cell) or NOT_FINITE.fullmatch(cell) for cell in named):
                fitting.append((line, [*cells, *[""] * len(row)][: len(row)], text))
                break
    if not fitting:
        return None
    line, names, text = fitting[-1]
    units = [cell.strip("[](){} ") for cell in names]
    if len(fitting) > 1 and fitting[-2][0] == line - 1 and any(units) and all(parsed(u) for u in units if u):
        line, names, text = fitting[-2]
    else:
        units = [""] * len(row)
    return _Table(file, line, names, units, layout, text)


def _header_cells(line: str, layout: Layout) -> Iterator[list[str]]:
    """The ways to take a line of headers apart, the likeliest first; a sign of a comment is left out."""
    line = COMMENT.sub("", line, count=1) if COMMENT.match(line) else line
    for delimiter in dict.fromkeys((layout.delimiter, "\t", ";", ",")):
        if delimiter != BLANK and delimiter in line:
            yield [" ".join(cell.split()) for cell in _parted(line, delimiter)]
    if layout.delimiter in (BLANK, "\t"):
        yield re.split(r"\s{2,}|\t+", line.strip())
        yield [" ".join((quoted or bare).split()) for quoted, bare in re.findall(r'"([^"]*)"|(\S+)', line)]


def _without_empty_end(cells: Sequence[str]) -> Sequence[str]:
    return cells[: max((n for n, cell in enumerate(cells, start=1) if cell.strip()), default=0)]


def _refuse_rows(file: ResultText, lines: Sequence[_Part], layout: Layout, width: int = 0) -> None:
    """Refuse a row in which a cell is no number, of a table of some width: it is no header, title or comment."""
    for number, text, _ in lines:
        cells = layout.cells(text)
        known = any(is_number(cell) or NOT_FINITE.fullmatch(cell) for cell in cells)
        if known and (len(cells) == width or len(cells) > 1 > width) and not COMMENT.match(text):
            raise bad_cell(file, number, cells)


def bad_cell(file: ResultText, line: int, cells: Sequence[str]) -> LinkproofError:
    """What is wrong with the first cell of a row that is no finite number."""
    column = next((n for n, cell in enumerate(cells, start=1) if not is_number(cell)), 1)
    cell = cells[column - 1].strip()
    cure = (
        "export that stretch of the run again, or leave the row out" if not cell or NOT_FINITE.fullmatch(cell)
        else "write numbers without signs between thousands" if re.fullmatch(r"[\d.,' ]+", cell)
        else "leave out the row, or the column if it holds texts"
    )  # fmt: skip
    what = f"'{shortened(cell)}'" if cell else "an empty cell"
    return file.fail(line, f"expected a finite number in column {column}, got {what}; {cure}")
