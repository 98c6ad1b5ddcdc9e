"""Result files of a tool that cannot be called, as signals of the linkage."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from analytic.description.linkage import Linkage
from comparisons.imported.columns import Column, ImportedResults, ImportedSignal

UNITS: Final = {
    "s": 1.0, "N*m": 1.0, "N*mm": 1e-3, "deg": np.pi / 180, "rad": 1.0, "rad/s": 1.0, "rad/s^2": 1.0, "W": 1.0,
    "J": 1.0, "m": 1.0, "mm": 1e-3, "m/s": 1.0, "m/s^2": 1.0, "N": 1.0, "kg*m^2": 1.0, "": 1.0,
}  # fmt: skip


def read_results(paths: Sequence[Path], linkage: Linkage, mapping: Path | None = None) -> ImportedResults:
    """The signals in result files; headers are names of signals with units in brackets, the first column the axis."""
    signals: list[ImportedSignal] = []
    for path in paths:
        axis, *others = _columns(path)
        for column in others:
            name = column.header.partition(" [")[0]
            scale, along = UNITS[column.unit], UNITS[axis.unit]
            signals.append(
                ImportedSignal(
                    name, "time" if axis.header.startswith("time") else "phi", axis.values * along,
                    column.values * scale, column.resolution * scale, column, axis.resolution * along,
                )
            )  # fmt: skip
    return ImportedResults(tuple(signals), (), {}, "")


def _columns(path: Path) -> list[Column]:
    headers, *rows = csv.reader(path.read_text(encoding="utf-8-sig").splitlines())
    columns = []
    for number, (header, texts) in enumerate(zip(headers, zip(*rows, strict=True), strict=True), start=1):
        unit = header.partition("[")[2].rstrip("]")
        values = np.array(texts, dtype=float)
        columns.append(Column(header, unit, values, np.zeros(len(values)), f"{path}:1 (column {number})"))
    return columns
