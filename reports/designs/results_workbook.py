"""Results as a workbook: a sheet of every signal and a sheet of the key figures, in the units of the linkage's file."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence

import numpy as np
from openpyxl import Workbook
from openpyxl.cell import WriteOnlyCell

from analytic.description.written import finite
from analytic.errors import printable
from comparisons.designer.sheet import Sheet

Cell = str | float | None


def workbook(sheet: Sheet) -> bytes:
    """The bytes of an .xlsx file: numbers are numbers, empty where they are not finite, and no name is a formula."""
    table = sheet.columns
    head = ("figure", "signal", "value", "unit", f"at φ [{sheet.unit('phi').name}]", "at time [s]", "at open end")
    pages = {
        "curves": [[*table], *np.column_stack([*table.values()]).tolist()],
        "key figures": [head, *_key_figures(sheet)],
    }
    book, data = Workbook(write_only=True), io.BytesIO()
    for title, rows in pages.items():
        page = book.create_sheet(title)
        page.freeze_panes = "B2"
        for row in rows:
            page.append([_text(page, cell) if isinstance(cell, str) else _number(cell) for cell in row])
    book.save(data)
    return data.getvalue()


def _text(page: object, text: str) -> WriteOnlyCell:
    """A cell with a name as text, which otherwise would be a formula if it began with =; ``page`` is its sheet."""
    cell = WriteOnlyCell(page, printable(text))
    cell.data_type = "s"
    return cell


def _number(value: float | None) -> float | None:
    """A number for a cell; None, an empty cell, if it is not finite."""
    return None if value is None else finite(value)


def _key_figures(sheet: Sheet) -> Iterator[Sequence[Cell]]:
    """Yield the rows of the key figures, as in the terminal's tables, a row for each number.

    Its cells are what, signal, value, unit, φ, time, s, and "yes" at an open end; all else in the file's units.
    """
    for figure in (row for rows in sheet.figures.values() for row in rows):
        what = f"{figure.what} on {figure.on}" if figure.on else figure.what
        phi = None if figure.phi is None else sheet.angle(figure.phi)
        yield (
            what,
            figure.signal,
            sheet.shown_value(figure),
            sheet.unit_of(figure).name,
            phi,
            figure.time,
            "yes" if figure.at_open_end else None,
        )
