"""How the rows of a table of numbers are written: what stands between the cells, and the decimal sign."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from comparisons.imported.files import printed

BLANK: Final = " "
# As they are tried: a delimiter and a decimal sign.
LAYOUTS: Final = (("\t", "."), (";", "."), (",", "."), ("|", "."), (BLANK, "."), ("\t", ","), (";", ","), (BLANK, ","))
SAMPLE: Final = 50  # rows looked at to tell a layout
QUOTED: Final = re.compile(r'"([^"\n]*)"')
# A number with a comma in it, in a row whose cells are quoted and parted by commas.
QUOTED_COMMA: Final = re.compile(r'"[^"\n,]*\d,\d[^"\n,]*"')


@dataclass(frozen=True)
class Layout:
    """A delimiter, BLANK for any run of blanks, and a decimal sign."""

    delimiter: str
    decimal: str

    def plain(self, rows: str) -> str:
        """Rows of numbers without quotes and with decimal points."""
        if '"' in rows:
            commas = self.delimiter == "," and QUOTED_COMMA.search(rows)
            rows = QUOTED.sub(lambda cell: cell[1].replace(",", "."), rows) if commas else rows.replace('"', "")
        return rows.replace(",", ".") if self.decimal == "," else rows

    def cells(self, row: str) -> list[str]:
        """The cells of a plain row of numbers."""
        return row.split() if self.delimiter == BLANK else [cell.strip() for cell in row.split(self.delimiter)]

    def are_numbers(self, row: str) -> int:
        """How many cells a row of numbers has, some of which may be empty; 0 for another row."""
        cells = self.cells(self.plain(row))
        numbers = sum(printed.NUMBER.fullmatch(cell) is not None for cell in cells)
        return len(cells) if numbers > 1 and all(not cell or printed.NUMBER.fullmatch(cell) for cell in cells) else 0


def layout_of(rows: Sequence[str]) -> Layout:
    """The layout in which most of the first rows of a table are numbers, as many in each as in the first."""
    sample = [row for row in rows if row.strip()][:SAMPLE]

    def fit(layout: Layout) -> int:
        widths = [layout.are_numbers(row) for row in sample]
        width = next((width for width in widths if width), 0)
        return sum(other == width for other in widths) if width else 0

    return max((Layout(*signs) for signs in LAYOUTS), key=fit)


def header_cells(line: str, layout: Layout) -> Iterator[list[str]]:
    """The ways to take a line of headers apart, the likeliest first; a sign of a comment is left out."""
    line = re.sub(r"^\s*(?:[#%!]+|//+|\*+)\s*", "", line)
    for delimiter in dict.fromkeys((layout.delimiter, "\t", ";", ",")):
        if delimiter != BLANK and delimiter in line:
            yield [" ".join(cell.split()) for cell in _quoted_cells(line, delimiter)]
    if layout.delimiter in (BLANK, "\t"):
        yield re.split(r"\s{2,}|\t+", line.strip())
        yield [" ".join(quoted or bare for quoted, bare in [match]) for match in re.findall(r'"([^"]*)"|(\S+)', line)]


def _quoted_cells(line: str, delimiter: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:  # a cell that is too long
        return line.split(delimiter)


def is_number(cell: str, layout: Layout) -> bool:
    """Whether a cell of a line is a finite number."""
    return printed.is_number(layout.plain(cell).strip())
