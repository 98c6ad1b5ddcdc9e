"""The scales of a panel: limits, round ticks and their words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from analytic.written import fixed
from reports.document.chart import Curve, Mark, Panel

Array = NDArray[np.float64]

MARGIN = 0.07  # of a span, beyond the curves
NOTED = 0.25  # the same where words stand beside the extremes
DIPS, LONG = 0.05, 50  # the share of a long curve that may dip below a logarithmic axis, and how many points are long
FROM_ZERO = 0.4  # an axis starts at zero where the least value is below this share of the largest
STEADY = 1e-6  # a curve that varies by less than this share of its size is flat
UP_TO, DOWN_TO = 1e5, 1e-3  # beyond these a power of ten goes to the label
STEPS = [1.0, 2.0, 2.5, 5.0, 10.0]
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Scale:
    """One axis of a panel: its limits, where its ticks stand, what is written at each and beside them."""

    low: float
    high: float
    ticks: tuple[float, ...]
    words: tuple[str, ...]
    label: str
    is_log: bool = False

    def share(self, value: float) -> float:
        """Where a value stands between the limits, 0 to 1."""
        low, high, place = self.low, self.high, value
        if self.is_log:
            low, high, place = map(math.log10, (low, high, max(value, low)))
        return (place - low) / (high - low)


def power_of_ten(value: float) -> str:
    """10 to a whole power, in plain characters: 10⁻⁵."""
    return f"10{str(round(math.log10(value))).translate(RAISED)}"


def across(panels: Sequence[Panel], ticks: int) -> Scale:
    """The x axis that panels of one column share, with about so many ticks."""
    first, label = panels[0], panels[-1].x_label
    fixed = [p.surface.x for p in panels if p.surface] + [p.hatch.stretches for p in panels if p.hatch]
    values = _finite([*(c.x for p in panels for c in p.curves), [m.place for m in _marks(panels, "x")], *fixed])
    if first.turn:
        step = 60.0 if ticks > 4 else 120.0
        return _worded(0.0, 360.0, np.arange(0.0, 361.0, step), label)
    if first.scale in ("logx", "loglog"):
        return _decades(values, label, ticks)
    lines = bool(fixed) or any(curve.line for panel in panels for curve in panel.curves)
    return _linear(values, label, ticks, _margin(first) if first.scale == "equal" else 0.0 if lines else MARGIN)


def upward(panel: Panel, ticks: int) -> Scale:
    """The y axis of a panel, with about so many ticks."""
    if panel.rows:
        last = len(panel.rows) - 0.5
        return Scale(last, -0.5, tuple(map(float, range(len(panel.rows)))), panel.rows, panel.y_label)
    if panel.surface:
        return tight(panel.surface.y, panel.y_label, ticks)
    if panel.span:
        return _linear(np.array(panel.span), panel.y_label, ticks, _margin(panel))
    levels = [mark.place for mark in _marks([panel], "y")]
    if panel.scale in ("log", "loglog"):
        return _decades(_finite([*map(_above_dips, panel.curves), levels]), panel.y_label, ticks)
    values = _finite([*(curve.y for curve in panel.curves), levels])
    if any(curve.stacked for curve in panel.curves):
        values = np.append(values, 0.0)
    return _linear(values, panel.y_label, ticks, _margin(panel))


def _margin(panel: Panel) -> float:
    """Room beyond the curves of a panel, as a share of their span."""
    return (0.5 * NOTED if panel.scale == "equal" else NOTED) if panel.notes else MARGIN


def _above_dips(curve: Curve) -> Array:
    """The values of a curve on a logarithmic axis that decide its limits: an error that changes sign dips to zero."""
    values = curve.y[np.isfinite(curve.y) & (curve.y > 0.0)]
    if len(values) < LONG or curve.marker:
        return values
    return values[values >= np.quantile(values, DIPS)]


def tight(values: Array, label: str, ticks: int) -> Scale:
    """A linear axis from the least to the largest of the values that are there, with about so many ticks."""
    return _linear(_finite([values]), label, ticks, 0.0)


def to_scale(panel: Panel, both: tuple[Scale, Scale], size: tuple[float, float], ticks: int) -> tuple[Scale, Scale]:
    """Both axes of a panel widened to one scale in a box of so many inches."""
    unit = max((scale.high - scale.low) / inches for scale, inches in zip(both, size, strict=True))
    (left, bottom), (right, top) = (
        [0.5 * (scale.low + scale.high + side * unit * inches) for scale, inches in zip(both, size, strict=True)]
        for side in (-1.0, 1.0)
    )
    return _worded(left, right, ticks, panel.x_label), _worded(bottom, top, ticks, panel.y_label)


def _marks(panels: Sequence[Panel], along: str) -> list[Mark]:
    return [mark for panel in panels for mark in panel.marks if mark.along == along]


def _finite(parts: Iterable[object]) -> Array:
    values: Array = np.concatenate([np.zeros(0), *(np.asarray(part, dtype=float).ravel() for part in parts)])
    return values[np.isfinite(values)]


def _linear(values: Array, label: str, ticks: int, margin: float) -> Scale:
    """Round steps; a flat curve stands in the middle, of a step of its own size."""
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    size = max(abs(low), abs(high))
    if high - low <= STEADY * size or high == low:
        low, high = low - 0.1 * (size or 1.0), high + 0.1 * (size or 1.0)
    else:
        room = margin * (high - low)
        from_zero = margin > 0.0 and 0.0 <= low < FROM_ZERO * high
        low, high = 0.0 if from_zero else low - room, high + room
    return _worded(low, high, ticks, label)


def _worded(low: float, high: float, ticks: int | Array, label: str) -> Scale:
    """Ticks, or about so many, written to the digits of their step; a power of ten common to all goes to the label."""
    slack = 1e-9 * (high - low)
    tried = MaxNLocator(ticks, steps=STEPS).tick_values(low, high) if isinstance(ticks, int) else ticks
    places = np.asarray(tried, dtype=float)
    places = places[(places >= low - slack) & (places <= high + slack)]
    largest = float(np.max(np.abs(places), initial=0.0))
    factor = 1.0
    if largest and not DOWN_TO <= largest < UP_TO:
        factor = 10.0 ** math.floor(math.log10(largest) + 1e-9)
        name, comma, unit = label.rpartition(", ")
        label = f"{name}{comma}{power_of_ten(factor)} {unit}" if comma else f"{label} × {power_of_ten(factor)}"
    step = float(np.min(np.diff(places), initial=np.inf)) / factor
    digits = next((n for n in range(12) if math.isinf(step) or abs(step - round(step, n)) < 1e-6 * step), 12)
    written = tuple(fixed(place / factor, digits).replace("-", "−") for place in places)
    return Scale(low, high, tuple(places), written, label)


def _decades(values: Array, label: str, ticks: int) -> Scale:
    """Whole decades, at most so many of them named."""
    values = values[values > 0.0]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.1, 1.0)
    first, last = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    last = max(last, first + 1)
    step = -(-(last - first) // max(ticks, 1))
    places = tuple(10.0**power for power in range(first, last + 1, step))
    return Scale(10.0**first, 10.0**last, places, tuple(map(power_of_ten, places)), label, is_log=True)
