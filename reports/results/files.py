"""Results as files: a tidy table in the units of the linkage's file, and one JSON object in SI."""

from __future__ import annotations

import csv
import io
import json
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from comparisons.datasheet.curves import TIME
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.figures import stroke

Array = NDArray[np.float64]


def csv_table(results: DesignerResults) -> str:
    """Every signal at every instant: a column each, headed by name and unit, the axis first."""
    names = sorted(results.curves.names, key=lambda name: name != results.axis)  # stable: the rest keeps its order
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([f"{name} [{results.unit(name).name}]" for name in names])
    columns = [results.curves.of(results.shown, name) / results.unit(name).size + 0.0 for name in names]
    writer.writerows([f"{value:.15g}" for value in row] for row in np.column_stack(columns).tolist())
    return text.getvalue()


def json_text(results: DesignerResults) -> str:
    """One object: ``conditions``, ``axis``, ``units``, ``values``, ``peaks`` and ``figures``; SI, angles in rad.

    ``values`` has a list by name, ``peaks`` by name the value of the largest magnitude (of a transmission angle the one
    farthest from π/2) and where it is: φ where that is the axis, else the time. What is not finite is null.
    """
    curves = results.curves
    document: dict[str, Any] = {
        "conditions": results.conditions,
        "axis": results.axis,
        "units": {name: curves.unit(name) for name in curves.names},
        "values": {name: _plain(curves.of(results.shown, name)) for name in curves.names},
        "peaks": {
            name: {"value": _finite(peak.value), "at": place(results, peak.time)}
            for name, peak in curves.peaks(curves.names).items()
        },
        "figures": figures(results),
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False) + "\n"


def figures(results: DesignerResults) -> dict[str, Any]:
    """What the table of a designer says, as plain data in SI."""
    drive = [{**one._asdict(), "at": place(results, one.time)} for one in results.drive]
    forces = [{**one._asdict(), "at": place(results, one.time)} for one in results.forces]
    found = {
        "drive": drive,
        "forces": forces,
        "transmission": [{**one._asdict(), "at": place(results, one.time)} for one in results.transmission],
        "output": [{**one._asdict(), "at": place(results, one.time)} for one in results.output],
    }
    told = found | ({"stroke": stroke(results.output)} if results.output else {})
    return {key: _defined(value) for key, value in told.items()}


def _defined(value: Any) -> Any:  # noqa: ANN401 - plain data
    """Plain data with nothing in place of a number that is none, as of a joint's force at a change point."""
    if isinstance(value, list):
        return [_defined(one) for one in value]
    if isinstance(value, dict):
        return {key: _defined(one) for key, one in value.items()}
    return _finite(value) if isinstance(value, float) else value


def place(results: DesignerResults, time: float | None) -> float | None:
    """An instant on the axis: φ, rad, or the time, s."""
    if time is None or results.axis == TIME:
        return time
    return float(results.case.motion.angle(np.array([time]))[0])


def _plain(values: Array) -> list[float | None]:
    return values.tolist() if np.all(np.isfinite(values)) else [_finite(value) for value in values.tolist()]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
