"""Results as files: a tidy table in the units of the linkage's file, and one JSON object in SI."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np

from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.linkage_warnings import warnings
from comparisons.datasheet.plain_data import figures, peaks, plain


def csv_table(results: DesignerResults) -> str:
    """Every signal at every instant: a column each, headed by name and unit, the axis first."""
    names = sorted(results.curves.names, key=lambda name: name != results.axis)  # stable: the rest keeps its order
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([f"{name} [{results.unit(name).name}]" for name in names])
    columns = [results.curves.of(results.shown, name) / results.unit(name).size + 0.0 for name in names]
    writer.writerows([f"{value:z.15g}" for value in row] for row in np.column_stack(columns).tolist())
    return text.getvalue()


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
