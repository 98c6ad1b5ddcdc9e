"""Results as files: a tidy table in the units of the linkage's file, and one JSON object in SI."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.linkage_warnings import warnings
from comparisons.datasheet.plain_data import figures, peaks, plain

Array = NDArray[np.float64]


def columns(results: DesignerResults) -> dict[str, Array]:
    """Every signal at every instant, (n,), in the file's units, by name and unit, the axis first."""
    names = sorted(results.curves.names, key=lambda name: name != results.axis)  # stable: the rest keeps its order
    units = {name: results.unit(name) for name in names}
    return {
        f"{name} [{unit.name}]": results.curves.of(results.shown, name) / unit.size + 0.0
        for name, unit in units.items()
    }


def csv_table(results: DesignerResults, decimal: str = ".") -> str:
    """A column each. With a decimal comma semicolons separate them, and a byte-order mark tells Excel that it is UTF-8.

    The mark is what makes a spreadsheet of a country with decimal commas show ° and φ as they are.
    """
    text, table = io.StringIO(), columns(results)
    has_comma = decimal == ","
    writer = csv.writer(text, lineterminator="\n", delimiter=";" if has_comma else ",")
    writer.writerow(table)
    rows = ([f"{value:z.15g}" for value in row] for row in np.column_stack([*table.values()]).tolist())
    writer.writerows([cell.replace(".", decimal) for cell in row] for row in rows)
    return f"\ufeff{text.getvalue()}" if has_comma else text.getvalue()


def json_text(results: DesignerResults) -> str:
    """One object, SI, angles in rad: ``conditions axis units values peaks figures warnings``.

    ``values`` has a list by name, ``peaks`` and ``figures`` are those of ``comparisons.datasheet.plain_data``; where φ
    is the axis a place is φ, else the time. What is not finite is null.
    """
    curves = results.curves
    document: dict[str, Any] = {
        "conditions": results.conditions,
        "axis": results.axis,
        "units": {name: curves.unit(name) for name in curves.names},
        "values": {name: plain(curves.of(results.shown, name)) for name in curves.names},
        "peaks": peaks(results, curves.names),
        "figures": figures(results),
        "warnings": list(warnings(results.linkage)),
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False) + "\n"
