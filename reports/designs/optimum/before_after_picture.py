"""Curves of a linkage before and after its numbers were changed, with their peaks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.errors import printable
from reports.charts import draw
from reports.document import numbers
from reports.document.chart import Chart, Curve, Note, Panel

Array = NDArray[np.float64]

FIRST: Final = ("Mkr",)
PANEL, FRAME = 1.9, 0.6  # in, height of a panel, of the words below the last
TURN: Final = 360.0


class Change(NamedTuple):
    """A signal over the driver's places (n,), degrees or a length, before and after (n,), and the unit of both."""

    places: Array
    before: Array
    after: Array
    unit: str


def before_after_figure(
    signals: Mapping[str, Change], *head: str, axis: str = "crank angle φ, °", most: int = 9
) -> Figure:
    """A panel per signal, the drive's torque first; of each the largest magnitude before and after is marked."""
    names = sorted(signals, key=lambda name: name not in FIRST)
    more = f"The first {most} of {len(names)} signals are drawn." if len(names) > most else ""
    panels = tuple(_panel(name, signals[name], axis) for name in names[:most])
    key = (Curve(np.zeros(0), np.zeros(0), "before", "muted", "--"), Curve(np.zeros(0), np.zeros(0), "after", 0))
    lines = tuple(line for line in (*head, more) if line)
    return draw.figure(Chart(panels, PANEL * len(panels) + FRAME, wide=True, head=lines, key=key))


def _panel(name: str, change: Change, axis: str) -> Panel:
    curves: list[Curve] = []
    notes, sentences = [], []
    for values, ink, line in ((change.before, "muted", "--"), (change.after, 0, "-")):
        curves.append(Curve(change.places, values, "", ink, line))
        size = np.where(np.isfinite(values), np.abs(values), -1.0)
        place = int(np.argmax(size)) if len(size) else -1
        if place < 0 or size[place] < 0.0:
            sentences.append(numbers.ABSENT)
            continue
        x, y = float(change.places[place]), float(values[place])
        curves.append(Curve(np.array([x]), np.array([y]), "", ink, "", marker="o"))
        sentences.append(numbers.figure(y))
        notes.append(Note(x, y, sentences[-1]))
    turn = axis.endswith("°") and abs(float(np.ptp(change.places)) - TURN) < 0.1 * TURN and change.places[0] > -1.0
    unit = printable(change.unit)
    title = f"{printable(name)}: peak {' → '.join(sentences)} {unit}".rstrip()
    label = ", ".join(filter(None, ("value", unit)))
    return Panel(tuple(curves), axis, label, (), tuple(notes), turn=bool(turn), names="", title=title)
