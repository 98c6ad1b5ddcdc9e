"""A tolerance study as data, in the units of the linkage's file: JSON and a table of results times parameters."""

from __future__ import annotations

import csv
import io
from typing import Any, Final

from analytic.written import csv_text, finite, plain
from comparisons.designs.tolerance.tolerance_study import ToleranceStudy

HEAD: Final = (
    *("result", "result unit", "nominal", "parameter", "parameter unit", "plus_minus", "distribution", "derivative"),
    *("derivative is", "contribution", "share of variance", "at lower limit", "at upper limit"),
)


def document(study: ToleranceStudy) -> dict[str, Any]:
    """Everything but the random designs themselves; what is not finite is null."""
    request = study.request
    return {
        "mechanism": request.mechanism.linkage.name,
        "variant": request.mechanism.linkage.variant,
        "conditions": request.conditions,
        "samples": request.samples,
        "seed": request.seed,
        "assembled": study.assembled,
        "derivatives": study.how,
        "results": {figure.name: _result(study, row) for row, figure in enumerate(request.figures)},
    }


def _result(study: ToleranceStudy, row: int) -> dict[str, Any]:
    unit = study.request.figures[row].unit
    return {
        "units": unit.name,
        "nominal": float(study.nominal[row] / unit.size),
        "tolerances": [
            dict(zip(("parameter", "units", *HEAD[5:8], *HEAD[9:]), cells, strict=True)) for cells in _cells(study, row)
        ],
        "worst case": {
            "linear": finite(float(study.worst[row] / unit.size)),
            "corners": plain(study.corners[row] / unit.size),
            "every corner": study.has_all_corners,
            "corners that do not assemble": study.lost_corners,
        },
        "linear standard deviation": finite(float(study.deviations[row] / unit.size)),
        "random": {
            "mean": float(study.mean[row] / unit.size),
            "standard deviation": float(study.deviation[row] / unit.size),
            "quantiles": plain(study.quantiles[row] / unit.size),
        },
    }


def _cells(study: ToleranceStudy, row: int) -> list[list[Any]]:
    """Of every tolerance the cells of its row, from its name on, less what the derivative is."""
    unit = study.request.figures[row].unit
    return [
        [
            *(
                tolerance.name,
                tolerance.parameter.unit.name,
                tolerance.plus_minus / tolerance.parameter.unit.size,
                str(tolerance.distribution),
            ),
            finite(float(study.derivatives[row, column] * tolerance.parameter.unit.size / unit.size)),
            finite(float(study.contributions[row, column] / unit.size)),
            finite(float(study.shares[row, column])),
            *plain(study.changes[row, column] / unit.size),
        ]
        for column, tolerance in enumerate(study.request.tolerances)
    ]


def csv_table(study: ToleranceStudy) -> str:
    """A row per result and parameter."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEAD)
    for row, figure in enumerate(study.request.figures):
        nominal = float(study.nominal[row] / figure.unit.size)
        for cells in _cells(study, row):
            row_cells = [figure.name, figure.unit.name, nominal, *cells[:5], study.how, *cells[5:]]
            writer.writerow(csv_text(cell) if isinstance(cell, str) else cell for cell in row_cells)
    return text.getvalue()
