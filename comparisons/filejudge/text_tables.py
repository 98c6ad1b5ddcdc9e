"""Tables of numbers in a text: rows of numbers below a line of headers, among titles, comments and rows of units.

The delimiter and the decimal sign are those with which most rows are numbers; pandas reads them.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import pandas

from analytic.errors import LinkproofError, printable, shortened
from analytic.files import read_file
from comparisons.filejudge.columns import Array, Column
from comparisons.filejudge.headers import parse_unit

# Bytes of a file, or of what is packed in it, and its numbers: what is read takes less than a GiB of memory.
LARGEST: Final = 1 << 27
EXPECTED: Final = "a file of results, such as a CSV"
MOST_NUMBERS: Final = 10_000_000
BYTE_ORDER_MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),  # before UTF-16, whose mark it begins with
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
# Three letters beyond ASCII in a row: a Cyrillic word in cp1251, while those of cp1252 stand among plain letters.
CYRILLIC: Final = re.compile(rb"[\xa5\xaa\xaf\xb2-\xb4\xba\xbf-\xff]{3}")
CONTROL: Final = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
# Signs that spreadsheets and text processors print for plain ones.
PLAIN_SIGNS: Final = {"−": "-", "–": "-", "\u00a0": " ", "\u202f": " ", "\u2009": " ", "“": '"', "”": '"'}

# A line with anything but numbers; its first part cannot give back what it took, so a search is linear.
TEXT_LINE: Final = re.compile(r"^[0-9eEdD+\-.,;|\t \"]*+[^0-9eEdD+\-.,;|\t \"\n].*$", re.MULTILINE)
# Empty cells at the end of a line, looked for at the beginning of a run of signs only, so that a search is linear.
TRAILING: Final = re.compile(r"(?<![,;|\t ])[,;|\t ]++$", re.MULTILINE)
COMMENT: Final = re.compile(r"\s*(?:[#%!*]+|//+)\s*")
NUMBER: Final = re.compile(r"[+-]?(?=\.?[0-9])([0-9]*+)\.?([0-9]*+)(?:[eEdD]([+-]?[0-9]{1,3}))?")
NOT_FINITE: Final = re.compile(r"[+-]?(?:nan|n/?a|null|none|inf|infinity|∞|1\.#\w+|#\w+[!/?]?\w*[!?]?)", re.IGNORECASE)
BLANK: Final = r"\s+"
# As they are tried: what parts cells, and the decimal sign; with both a comma cells are quoted.
LAYOUTS: Final = (
    *(("\t", "."), (";", "."), (",", "."), ("|", "."), (BLANK, ".")),
    *(("\t", ","), (";", ","), (",", ","), (BLANK, ",")),
)
LAYOUT_ROWS: Final = 50  # rows looked at to tell a layout
RESOLUTION_ROWS: Final = 300  # rows whose digits are counted
LARGEST_NUMBER: Final = 1e100  # of a number: squares of larger ones are beyond all numbers
LONGEST: Final = 60  # characters of a number
MOST_LINES: Final = 20_000  # of text before or behind a table
MOST_COLUMNS: Final = 10_000
LONGEST_ROW: Final = 1 << 18  # characters
MOST_DIGITS: Final = 17  # of a double


@dataclass(frozen=True)
class ResultText:
    """The text of a result file and what messages call the file."""

    name: str
    text: str

    def fail(self, line: int, message: str) -> LinkproofError:
        """The error to raise about a line; ``message`` states the expectation, the content, and the remedy."""
        return LinkproofError(f"{self.name}:{line}: {message}")


def read_text(path: Path, expected: str = EXPECTED, largest: int = LARGEST) -> ResultText:
    """The text of a file; raises LinkproofError if it is not readable text."""
    content, name = read_file(path, expected, largest), printable(str(path))
    encoding = next(
        (encoding for mark, encoding in BYTE_ORDER_MARKS if content.startswith(mark)), None
    ) or _guess_encoding(content)
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise LinkproofError(
            f"{name}:{line}: expected text in {encoding.removesuffix('-sig').upper()}, got other bytes; save it as "
            "UTF-8"
        ) from error
    control = CONTROL.search(text)
    if control:
        line = text.count("\n", 0, control.start()) + 1
        raise LinkproofError(f"{name}:{line}: expected {expected}, got a binary file; export the results as CSV")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if not text.isascii():  # sign by sign is faster than str.translate, by far
        for sign, simple in PLAIN_SIGNS.items():
            text = text.replace(sign, simple)
    return ResultText(name, text)


def _guess_encoding(content: bytes) -> str:
    """The encoding of bytes without a byte order mark: UTF-8, else Windows' of Western or of Cyrillic letters."""
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1251" if CYRILLIC.search(content) else "cp1252"
    return "utf-8"


class _Part(NamedTuple):
    """Lines of a text from one on, counted from 1: rows of numbers, or a line of anything else."""

    line: int
    text: str
    is_rows: bool


class _Header(NamedTuple):
    """The name and the unit of every column, "" for none, on a line counted from 1."""

    line: int
    names: Sequence[str]
    units: Sequence[str]


@dataclass(frozen=True)
class Layout:
    """The delimiter of the cells of a row, and the decimal sign."""

    delimiter: str
    decimal: str

    def cells(self, row: str) -> list[str]:
        """The cells of a row, numbers with a decimal point."""
        cells = row.replace('"', "").split() if self.delimiter == BLANK else _split_cells(row, self.delimiter)
        return [cell.replace(",", ".") for cell in cells] if self.decimal == "," else cells

    def width(self, row: str) -> int:
        """How many cells a row of numbers has, some of which may be empty; 0 for another row."""
        cells = self.cells(row)
        numbers = sum(map(is_number, cells))
        return len(cells) if numbers > 1 and numbers + cells.count("") == len(cells) else 0


def is_number(cell: str) -> bool:
    """Whether a cell is a finite number with a decimal point."""
    plain = cell.replace("d", "e").replace("D", "e")
    return len(cell) <= LONGEST and bool(NUMBER.fullmatch(cell)) and abs(float(plain)) < LARGEST_NUMBER


def _split_cells(row: str, delimiter: str) -> list[str]:
    """The cells of a row between delimiters, quotes taken away."""
    try:
        cells = next(csv.reader([row], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:  # a cell that is too long
        cells = row.split(delimiter)
    return [" ".join(cell.split()) for cell in cells]


def _find_layout(rows: Sequence[str]) -> Layout:
    """The layout in which most of the first rows are numbers, as many in each as in the first."""

    def fit(layout: Layout) -> int:
        widths = [layout.width(row) for row in rows]
        return widths.count(next(filter(None, widths), -1))

    return max((Layout(*signs) for signs in LAYOUTS), key=fit)


def read_tables(file: ResultText) -> Iterator[tuple[int, list[Column]]]:
    """The line of the header of every table of a text, and its columns; raises LinkproofError with file and line.

    A table without a header, which only numbers alone are, has columns without names.
    """
    above: list[_Part] = []  # lines since the last rows of numbers
    numbers, layout, width = 0, Layout(",", "."), 0
    for part in _split_blocks(TRAILING.sub("", file.text)):
        if not part.is_rows:
            above.append(part)
            if len(above) > MOST_LINES:
                raise file.fail(part.line, f"expected rows of numbers, got {MOST_LINES} lines of text; leave them out")
            continue
        first = [row for row in part.text[:LONGEST_ROW].split("\n") if row.strip()][:LAYOUT_ROWS]
        if max(first[0].count(sign) for sign in ",;\t| ") >= MOST_COLUMNS or len(first[0]) == LONGEST_ROW:
            raise file.fail(
                part.line, f"expected at most {MOST_COLUMNS} columns, got more; export fewer, or a row an instant"
            )
        layout = _find_layout(first)
        row = layout.cells(first[0])
        nothing = [""] * len(row)
        header = _Header(part.line, nothing, nothing)
        if above or width:
            header = _find_header(file, above, layout, row, part.line)
        above, width = [], len(row)
        numbers += width * part.text.count("\n")
        if numbers > MOST_NUMBERS:
            raise file.fail(part.line, f"expected at most {MOST_NUMBERS} numbers, got more; export a coarser step")
        yield header.line, [*_read_columns(file, part, layout, header)]
    _refuse_spoilt_rows(file, above[:1000], layout, width)
    if not width:
        number, text, _ = above[-1] if above else _Part(1, "", False)
        raise file.fail(
            number,
            f"expected rows of numbers below a header, got '{shortened(text.strip())}' and none; export the results "
            "with their values",
        )


def _split_blocks(text: str) -> Iterator[_Part]:
    """Blocks of rows of numbers and the lines between them."""
    start, line = 0, 1
    for words in chain(TEXT_LINE.finditer(text), [None]):
        end = words.start() if words else len(text)
        first = start + len(text[start:end]) - len(text[start:end].lstrip("\n"))
        line += first - start
        if first < end:
            yield _Part(line, text[first:end], True)
            line += text.count("\n", first, end)
        if words is not None and not words.group().startswith("sep="):  # Excel's own line
            yield _Part(line, words.group()[:LONGEST_ROW], False)
        start = words.end() if words else end


def _find_header(file: ResultText, above: Sequence[_Part], layout: Layout, row: Sequence[str], at: int) -> _Header:
    """The last line above a block of rows that has a header for every column, and the row of units below it, if any."""
    fitting = []
    for line, text, _ in above:
        for cells in _header_cells(text, layout):
            if len(cells) == len(row) and not any(is_number(cell) or NOT_FINITE.fullmatch(cell) for cell in cells):
                fitting.append(_Header(line, cells, [""] * len(row)))
                break
    _refuse_spoilt_rows(file, [part for part in above if not fitting or part.line > fitting[-1].line], layout, len(row))
    if not fitting:
        raise file.fail(
            above[-1].line,
            f"expected a header for each of the {len(row)} columns of line {at}, got '{shortened(above[-1].text)}'; "
            "check delimiters and decimal signs (with decimal commas columns are parted by semicolons or tabs), or "
            "leave this line out",
        )
    units = [cell.strip("[](){} ") for cell in fitting[-1].names]
    if fitting[-2:-1] and fitting[-2].line == fitting[-1].line - 1 and all(parse_unit(u) for u in units if u):
        return fitting[-2]._replace(units=units)
    return fitting[-1]


def _header_cells(line: str, layout: Layout) -> Iterator[list[str]]:
    """The ways to take a line of headers apart, the likeliest first; a sign of a comment is left out."""
    line = COMMENT.sub("", line, count=1) if COMMENT.match(line) else line
    for delimiter in dict.fromkeys((layout.delimiter, "\t", ";", ",")):
        if delimiter != BLANK and delimiter in line:
            yield _split_cells(line, delimiter)
    if layout.delimiter in (BLANK, "\t"):
        yield re.split(r"\s{2,}|\t+", line.strip())
        yield [" ".join((quoted or bare).split()) for quoted, bare in re.findall(r'"([^"]*)"|(\S+)', line)]


def _read_columns(file: ResultText, rows: _Part, layout: Layout, header: _Header) -> Iterator[Column]:
    """The columns of a block of rows; one that is empty throughout, as between tables side by side, is left out."""
    data = rows.text.replace("D", "e").replace("d", "e").encode()  # Fortran writes exponents with a D
    width = len(header.names)
    count = sum(not row.isspace() for row in io.BytesIO(data))
    lines = (row.decode() for row in io.BytesIO(data) if not row.isspace())
    printed = [layout.cells(row) for row in islice(lines, 0, None, max(1, count // RESOLUTION_ROWS))]
    gaps = [not cell for cell in printed[0]]
    signs = {"sep": layout.delimiter, "decimal": layout.decimal, "names": range(width)}
    try:
        frame = pandas.read_csv(
            io.BytesIO(data), header=None, dtype=float, index_col=False, skipinitialspace=True, **signs
        )
        numbers = frame.to_numpy()
        is_read = len(numbers) == count and bool((np.isnan(numbers) == gaps).all())
        is_read &= bool(np.abs(numbers[:, np.logical_not(gaps)]).max() < LARGEST_NUMBER)
    except (ValueError, OverflowError):  # of pandas' own, all of them
        is_read = False
    if not is_read:
        raise _row_error(file, rows, layout, header)
    for number, words in enumerate(zip(*printed, strict=True)):
        if not gaps[number]:
            values, place = frame[number].to_numpy(), f"{file.name}:{header.line} (column {number + 1})"
            yield Column(header.names[number], header.units[number], values, resolution(values, words), place)


def _row_error(file: ResultText, rows: _Part, layout: Layout, header: _Header) -> LinkproofError:
    """The message about the first row with another number of cells, or with a cell that is not a number."""
    gaps = None
    for number, row in enumerate(io.BytesIO(rows.text.encode()), start=rows.line):
        cells = layout.cells(row.decode())
        if row.isspace():
            continue
        if len(cells) != len(header.names):
            return file.fail(
                number,
                f"expected {len(header.names)} columns, as the header of line {header.line} has, got {len(cells)}; "
                "complete the row, or give every table a header of its own",
            )
        gaps = [not cell for cell in cells] if gaps is None else gaps
        if any(is_number(cell) is is_gap for cell, is_gap in zip(cells, gaps, strict=True)):
            return cell_error(file, number, cells)
    return file.fail(rows.line, "expected rows of numbers, got others; export the results again")


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


def _refuse_spoilt_rows(file: ResultText, lines: Sequence[_Part], layout: Layout, width: int) -> None:
    """Raise LinkproofError for a line of text that is a row of numbers with one cell that is not a number.

    It has a number in some cell and ``width`` cells or, with ``width`` 0 (no table yet), more than one; comments pass.
    """
    for number, text, _ in lines:
        cells = layout.cells(text)
        known = any(is_number(cell) or NOT_FINITE.fullmatch(cell) for cell in cells)
        if known and (len(cells) == width or len(cells) > 1 > width) and not COMMENT.match(text):
            raise cell_error(file, number, cells)


def cell_error(file: ResultText, line: int, cells: Sequence[str]) -> LinkproofError:
    """The message about the first cell of a row that is not a finite number, or not empty as in other rows."""
    column = next((n for n, cell in enumerate(cells, start=1) if not is_number(cell)), 1)
    cell = cells[column - 1]
    cure = (
        "write numbers without signs between thousands" if re.fullmatch(r"[\d.,' ]+", cell)
        else "export that stretch of the run again, or leave the row or the column out"
    )  # fmt: skip
    what = f"'{shortened(cell)}'" if cell else "an empty cell"
    return file.fail(line, f"expected a finite number in column {column}, got {what}; {cure}")
