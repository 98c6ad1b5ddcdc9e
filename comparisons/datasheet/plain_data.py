"""A designer's figures as plain data, as JSON has them; SI, angles in rad, nothing in place of what is not finite."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from comparisons.datasheet.curves import TIME
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.figures import DrivePoint, Extreme, ForcePeak, stroke
from comparisons.datasheet.sheet import SheetFigures, SheetPeak

Array = NDArray[np.float64]


def figures(results: DesignerResults) -> SheetFigures:
    """What the table of a designer says: ``drive``, ``forces``, ``transmission``, ``output`` and, m, ``stroke``."""
    parts: Mapping[str, Sequence[DrivePoint | ForcePeak | Extreme]] = {
        "drive": results.drive,
        "forces": results.forces,
        "transmission": results.transmission,
        "output": results.output,
    }
    told = {key: [{**one._asdict(), "at": place(results, one.time)} for one in part] for key, part in parts.items()}
    ends = {"stroke": finite(stroke(results.output))} if results.output else {}
    return cast("SheetFigures", {key: _defined(value) for key, value in told.items()} | ends)


def peaks(results: DesignerResults, names: Iterable[str]) -> Mapping[str, SheetPeak]:
    """By name the value of the largest magnitude, of a transmission angle the least, and its place."""
    found = results.curves.peaks(names)
    return {name: {"value": finite(peak.value), "at": place(results, peak.time)} for name, peak in found.items()}


def place(results: DesignerResults, time: float | None) -> float | None:
    """An instant on the axis: φ, rad, or the time, s."""
    if time is None or results.axis == TIME:
        return time
    return float(results.case.motion.angle(np.array([time]))[0])


def plain(values: Array) -> list[float | None]:
    """Numbers as a list."""
    return values.tolist() if np.all(np.isfinite(values)) else [finite(value) for value in values.tolist()]


def finite(value: float) -> float | None:
    """A number, or nothing."""
    return value if math.isfinite(value) else None


def _defined(value: Any) -> Any:  # noqa: ANN401 - plain data
    """Plain data with None in place of an undefined number, such as a joint's force at a change point."""
    if isinstance(value, list):
        return [_defined(one) for one in value]
    if isinstance(value, dict):
        return {key: _defined(one) for key, one in value.items()}
    return finite(value) if isinstance(value, float) else value
