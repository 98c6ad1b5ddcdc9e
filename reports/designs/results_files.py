"""Results as files: a tidy table in the units of the linkage's file, and one JSON object in SI."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np

from analytic.written import plain
from comparisons.datasheet.linkage_warnings import warnings
from comparisons.datasheet.sheet import Sheet
from reports.document.chart import Array


def columns(sheet: Sheet) -> dict[str, Array]:
    """Every signal at every instant, (n,), in the file's units, by name and unit, the axis first."""
    names = sorted(sheet.table, key=lambda name: name != sheet.axis)  # stable: the rest keeps its order
    units = {name: sheet.unit(name) for name in names}
    return {f"{name} [{unit.name}]": sheet.table[name] / unit.size + 0.0 for name, unit in units.items()}


def csv_table(sheet: Sheet, decimal: str = ".") -> str:
    """A column each. With a decimal comma semicolons separate them, and a byte-order mark makes Excel read UTF-8.

    The mark is what makes a spreadsheet of a country with decimal commas show ° and φ as they are.
    """
    text, table = io.StringIO(), columns(sheet)
    has_comma = decimal == ","
    writer = csv.writer(text, lineterminator="\n", delimiter=";" if has_comma else ",")
    writer.writerow(table)
    rows = ([f"{value:z.15g}" for value in row] for row in np.column_stack([*table.values()]).tolist())
    writer.writerows([cell.replace(".", decimal) for cell in row] for row in rows)
    return f"\ufeff{text.getvalue()}" if has_comma else text.getvalue()


def json_text(sheet: Sheet) -> str:
    """One object, SI, angles in rad: ``conditions axis units values peaks figures warnings``.

    ``values`` has a list by name, ``peaks`` by name the value and where it is: φ where that is the axis, else the time.
    ``figures`` has the tables of ``comparisons.datasheet.figures``. What is not finite is null.
    """
    document: dict[str, Any] = {
        "conditions": sheet.conditions,
        "axis": sheet.axis,
        "units": sheet.units,
        "values": {name: plain(values) for name, values in sheet.table.items()},
        "peaks": {name: {"value": peak.value, "at": sheet.place_of(peak)} for name, peak in sheet.peaks.items()},
        "figures": {name: [vars(row) for row in rows] for name, rows in sheet.figures.items()},
        "warnings": list(warnings(sheet.linkage)),
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False) + "\n"
