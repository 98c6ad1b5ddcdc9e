"""Tables of numbers in a text: titles, headers, rows of units and comments told from the rows of numbers themselves."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from analytic.errors import LinkproofError, shortened
from comparisons.imported.columns import Array, Column
from comparisons.imported.files.layout import BLANK, Layout, header_cells, is_number, layout_of
from comparisons.imported.files.printed import LONGEST, parse, resolution
from comparisons.imported.files.text import ResultText
from comparisons.imported.headers.units import parsed

# A line that holds anything but numbers; its first part cannot give back what it took, so a search is linear.
WORDS: Final = re.compile(r"^[0-9eEdD+\-.,;|\t \"]*+[^0-9eEdD+\-.,;|\t \"\n].*$", re.MULTILINE)
COMMENT: Final = re.compile(r"\s*(?:[#%!*]|//)")
NOT_FINITE: Final = re.compile(r"[+-]?(?:nan|n/?a|null|none|inf|infinity|∞|1\.#\w+|#\w+[!/?]?\w*[!?]?)", re.IGNORECASE)
MOST_LINES: Final = 1000  # of a text without numbers that are looked at
CHUNK: Final = 1 << 22  # characters parsed at a time


@dataclass(frozen=True)
class TextLine:
    """A line of a file, counted from 1."""

    number: int
    text: str


@dataclass
class Block:
    """Rows of numbers, from ``line`` on, and the other lines that stand before them."""

    above: list[TextLine]
    line: int
    rows: str


@dataclass
class RawTable:
    """A header and what stands in its columns: values and decimals as they are parsed."""

    header: TextLine
    names: list[str]
    units: list[str]
    layout: Layout
    parts: list[list[tuple[Array, Array]]] = field(default_factory=list)


def tables(file: ResultText, *, headless: str = "") -> Iterator[tuple[TextLine, list[Column]]]:
    """The header's line and the columns of every table of a text; raises LinkproofError with file and line.

    Where a tool writes no headers, ``headless`` begins the names that the columns are given.
    """
    blocks, below = _blocks(file.text)
    if not blocks:
        raise _no_numbers(file, below)
    current: RawTable | None = None
    for block in blocks:
        table = _begin(file, block, current, headless)
        if table is not current and current is not None:
            yield current.header, _columns(file, current)
        _read(file, block, table)
        current = table
    if current is not None:
        _refuse_rows(file, below, current)
        yield current.header, _columns(file, current)


def _blocks(text: str) -> tuple[list[Block], list[TextLine]]:
    """Blocks of rows of numbers with the lines above each, and the lines below the last."""
    blocks: list[Block] = []
    above: list[TextLine] = []
    start, line = 0, 1

    def take(rows: str) -> None:
        nonlocal above
        if rows.strip():
            blocks.append(Block(above, line, rows))
            above = []

    for words in WORDS.finditer(text):
        rows = text[start : words.start()]
        take(rows)
        line += rows.count("\n")
        above.append(TextLine(line, words.group()))
        start = words.end()
    take(text[start:])
    return blocks, above


def _no_numbers(file: ResultText, lines: Sequence[TextLine]) -> LinkproofError:
    """What is wrong with a text without rows of numbers."""
    layout = Layout(",", ".")
    for line in lines[:MOST_LINES]:
        for cells in header_cells(line.text, layout):
            if len(cells) > 1 and any(is_number(cell, layout) for cell in cells):
                return _bad_cell(file, line.number, cells, layout)
    last = lines[-1] if lines else TextLine(1, "")
    return file.fail(
        last.number,
        f"expected rows of numbers below a header, got '{shortened(last.text.strip())}' and none; export the results "
        "with their values",
    )


def _bad_cell(file: ResultText, line: int, cells: Sequence[str], layout: Layout) -> LinkproofError:
    """The first cell of a row that is no finite number."""
    column = next((n for n, cell in enumerate(cells, start=1) if not is_number(cell, layout)), 1)
    cell = cells[column - 1].strip()
    cure = (
        "export that stretch of the run again, or leave the row out" if not cell or NOT_FINITE.fullmatch(cell)
        else "write numbers without signs between thousands" if re.fullmatch(r"[\d.,' ]+", cell)
        else "leave out the row, or the column if it holds texts"
    )  # fmt: skip
    what = f"'{shortened(cell)}'" if cell else "an empty cell"
    return file.fail(line, f"expected a finite number in column {column}, got {what}; {cure}")


def _begin(file: ResultText, block: Block, current: RawTable | None, headless: str) -> RawTable:
    """The table that a block belongs to: one with a header above it, or the current one, which a comment interrupts."""
    rows = block.rows[:CHUNK].split("\n")
    first = next(row for row in rows if row.strip())
    same = current is not None and current.layout.are_numbers(first) == len(current.names)
    layout = current.layout if same and current else layout_of(rows)
    cells = layout.cells(layout.plain(first))
    header = _header(block.above, layout, cells)
    if header is not None:
        _refuse_rows(file, [line for line in block.above if line.number > header.header.number], header)
        return header
    if current is not None:
        _refuse_rows(file, block.above, current)
        if all(COMMENT.match(line.text) for line in block.above):
            return current
    if headless and not block.above:
        return RawTable(
            TextLine(block.line, ""), [f"{headless} {n}" for n in range(len(cells))], [""] * len(cells), layout
        )
    at = block.line + next(n for n, row in enumerate(rows) if row.strip())
    bad = next((cell for cell in cells if cell and not is_number(cell, layout)), None)
    if bad is not None:
        raise _bad_cell(file, at, cells, layout)
    if not block.above:
        raise file.fail(
            at, "expected a header above the numbers, got none; write a line with a name and a unit for each column"
        )
    header_line = block.above[-1]
    widths = [len(cells) for cells in header_cells(header_line.text, layout)] or [1]
    raise file.fail(
        at,
        f"expected as many numbers as headers, got {len(cells)} below the {widths[0]} of line {header_line.number}; "
        "check delimiters and decimal signs: with decimal commas columns are parted by semicolons or tabs",
    )


def _header(above: Sequence[TextLine], layout: Layout, row: Sequence[str]) -> RawTable | None:
    """The last line above a block that has a header for every column, and the row of units below it, if any."""
    above = [line for line in above if not line.text.startswith("sep=")]  # what Excel writes and reads
    fitting = [(line, cells) for line in above if (cells := _fitting(line, layout, row)) is not None]
    if not fitting:
        return None
    line, names = fitting[-1]
    units = [""] * len(row)
    if len(fitting) > 1 and fitting[-2][0].number == line.number - 1 and _are_units(names):
        units = [unit.strip("[](){}") for unit in names]
        line, names = fitting[-2]
    return RawTable(line, names, units, layout)


def _fitting(line: TextLine, layout: Layout, row: Sequence[str]) -> list[str] | None:
    """The headers of a line, one for each cell of a row; None if it has others."""
    least = len(_without_empty_end(row))
    for cells in header_cells(line.text, layout):
        named = _without_empty_end(cells)
        fits = len(cells) == len(row) or least <= len(named) <= len(row)
        if fits and any(named) and not any(is_number(cell, layout) or NOT_FINITE.fullmatch(cell) for cell in named):
            return [*cells, *[""] * len(row)][: len(row)]
    return None


def _without_empty_end(cells: Sequence[str]) -> list[str]:
    return list(cells[: max((n for n, cell in enumerate(cells, start=1) if cell.strip()), default=0)])


def _are_units(cells: Sequence[str]) -> bool:
    named = [cell.strip("[](){}") for cell in cells if cell.strip("[](){}")]
    return bool(named) and all(parsed(cell) for cell in named)


def _refuse_rows(file: ResultText, lines: Sequence[TextLine], table: RawTable) -> None:
    """Refuse a row of a table in which a cell is no number: it is not a header, a title or a comment."""
    for line in lines:
        for cells in header_cells(line.text, table.layout):
            known = [is_number(cell, table.layout) or NOT_FINITE.fullmatch(cell) is not None for cell in cells]
            if len(cells) == len(table.names) and any(known) and not COMMENT.match(line.text):
                raise _bad_cell(file, line.number, cells, table.layout)


def _read(file: ResultText, block: Block, table: RawTable) -> None:
    """Parse the rows of a block into the columns of its table, some thousands at a time."""
    start, line = 0, block.line
    while start < len(block.rows):
        end = block.rows.find("\n", start + CHUNK) + 1 or len(block.rows)
        rows = block.rows[start:end]
        _read_rows(file, rows, line, table)
        line += rows.count("\n")
        start = end


def _read_rows(file: ResultText, text: str, line: int, table: RawTable) -> None:
    layout = table.layout
    text = layout.plain(text)
    if layout.delimiter != BLANK and " " in text and re.search(r"[0-9.] +[0-9.+-]", text):
        _refuse_first(file, text, line, table)
    numbered = [row for row in text.split("\n") if row and not row.isspace()]
    blanks = layout.delimiter == BLANK
    rows = [row.split() for row in numbered] if blanks else [row.split(layout.delimiter) for row in numbered]
    if not rows:
        return
    if len(rows[0]) != len(table.names) or len(set(map(len, rows))) > 1:
        _refuse_first(file, text, line, table)
    bare = blanks or not (" " in text or "\t" in text)
    parts = [_parsed(words if bare else tuple(map(str.strip, words))) for words in zip(*rows, strict=True)]
    ended = [bool(table.parts and len(table.parts[-1][n][0]) < len(table.parts[-1][0][0])) for n in range(len(parts))]
    if any(part is None or (over and len(part[0])) for part, over in zip(parts, ended, strict=True)):
        _refuse_first(file, text, line, table)
    table.parts.append([part for part in parts if part is not None])


def _parsed(words: Sequence[str]) -> tuple[Array, Array] | None:
    """Values and decimals of a column down to where it ends; None if it has other words than numbers before that."""
    count = len(words)
    if "" in words:
        count = len(_without_empty_end(words))
        if "" in words[:count]:
            return None
    if not count:
        return np.zeros(0), np.zeros(0)
    return None if max(map(len, words)) > LONGEST else parse(list(words[:count]))


def _refuse_first(file: ResultText, text: str, line: int, table: RawTable) -> None:
    """Refuse the first row of plain rows that has another number of cells, or a cell that is no number."""
    layout, width = table.layout, len(table.names)
    for number, row in enumerate(text.split("\n"), start=line):
        cells = layout.cells(row)
        if not row.strip():
            continue
        if len(cells) != width:
            raise file.fail(
                number,
                f"expected {width} columns, as the header of line {table.header.number} has, got {len(cells)}; "
                "complete the row, or give every table a header of its own",
            )
        if any(not is_number(cell, Layout(layout.delimiter, ".")) for cell in cells):
            raise _bad_cell(file, number, cells, Layout(layout.delimiter, "."))
    raise file.fail(line, "expected rows of numbers, got columns that end before others go on; export them again")


def _columns(file: ResultText, table: RawTable) -> list[Column]:
    """The columns of a table that hold numbers."""
    if not table.parts:
        raise _no_numbers(file, [table.header])
    columns = []
    for number, (name, unit) in enumerate(zip(table.names, table.units, strict=True)):
        values, decimals = (np.concatenate([part[number][k] for part in table.parts]) for k in (0, 1))
        place = f"{file.name}:{table.header.number} (column {number + 1})"
        if len(values):
            header = name or f"column {number + 1}"
            columns.append(Column(header, unit, values, resolution(values, decimals), place))
    return columns
