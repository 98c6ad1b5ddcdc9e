"""A sweep as a table of its designs, in the units of the linkage's file."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import Final

import numpy as np

from analytic.written import csv_text
from comparisons.designs.sweep.saved_sweep import SavedSweep

ROWS: Final = 10_000  # made into text at once


def csv_rows(saved: SavedSweep) -> Iterator[str]:
    """A line per design, block by block, a column per parameter and figure, headed by name and unit."""
    request, head = saved.request, io.StringIO()
    columns = [
        *(parameter.shown for parameter in request.space.parameters),
        *(figure.shown for figure in request.figures),
    ]
    csv.writer(head, lineterminator="\n").writerow(map(csv_text, columns))
    yield head.getvalue()
    row = ",".join(["%.15g"] * len(columns)) + "\n"
    for number in range(len(request.blocks)):
        values = np.concatenate([request.space.shown(*request.block(number)), saved.read(number)]).T + 0.0  # no -0
        for start in range(0, len(values), ROWS):
            rows = values[start : start + ROWS]
            yield row * len(rows) % tuple(rows.ravel().tolist())
