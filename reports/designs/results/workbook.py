"""Results as a workbook: a sheet of every signal and a sheet of the key figures, in the units of the linkage's file."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence

import numpy as np
from openpyxl import Workbook
from openpyxl.cell import WriteOnlyCell

from analytic.errors import printable
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.figures import stroke
from comparisons.datasheet.plain_data import finite
from comparisons.datasheet.units import FileUnit, file_unit
from reports.designs.results.files import columns

Cell = str | float | None


def workbook(results: DesignerResults) -> bytes:
    """The bytes of an .xlsx file: numbers are numbers, empty where they have no bound, and no name is a formula."""
    table = columns(results)
    angle = results.unit("phi").name
    head = ("figure", "signal", "value", "unit", f"at φ [{angle}]", "at time [s]")
    sheets = {
        "curves": [[*table], *np.column_stack([*table.values()]).tolist()],
        "key figures": [head, *_key_figures(results)],
    }
    book, data = Workbook(write_only=True), io.BytesIO()
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        sheet.freeze_panes = "B2"
        for row in rows:
            sheet.append([_text(sheet, cell) if isinstance(cell, str) else _number(cell) for cell in row])
    book.save(data)
    return data.getvalue()


def _text(sheet: object, text: str) -> WriteOnlyCell:
    """A name as text, which would be a formula if it began with =."""
    cell = WriteOnlyCell(sheet, printable(text))
    cell.data_type = "s"
    return cell


def _number(value: float | None) -> float | None:
    return None if value is None else finite(value)


def _key_figures(results: DesignerResults) -> Iterator[Sequence[Cell]]:
    """What the tables of the terminal say, a row for each number."""

    def row(what: str, name: str, value: float, unit: FileUnit, time: float | None) -> Sequence[Cell]:
        return (what, name, value / unit.size, unit.name, None if time is None else results.shown_angle(time), time)

    for point in results.drive:
        yield row(point.what, "Mkr", point.torque, results.unit("Mkr"), point.time)
        yield row(point.what, "omega", point.speed, results.speed_unit, point.time)
        yield row(point.what, "Peq", point.power, results.unit("Peq"), point.time)
    for peak in results.forces:
        what = f"{peak.joint} on {peak.link}"
        yield row(what, "force", peak.force, file_unit("N", results.linkage), peak.time)
        yield row(what, "direction", peak.direction, file_unit("rad", results.linkage), peak.time)
    if results.forces:
        moment = results.curves.peaks(["shaking_moment"])["shaking_moment"]
        yield row(
            f"about {results.moment_centre}",
            "shaking_moment",
            moment.value,
            results.unit("shaking_moment"),
            moment.time,
        )
    for one in (*results.transmission, *results.output):
        yield row(one.what, one.signal.partition(":")[0], one.value, results.unit(one.signal), one.time)
    if results.output:
        yield row("stroke", "S", stroke(results.output), results.unit("S"), None)
