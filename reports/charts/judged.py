"""A file's curves against the closed form, the difference below, the worst place, and what a cause leaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from comparisons.judging.limits import grouped
from comparisons.judging.records import Record
from reports.document.chart import Chart, Curve, Ink, Mark, Panel
from reports.document.templates import plain
from reports.records.views import SETTINGS, Regime, View, columns, engines, family, worst

MOST: Final = 3  # curves of one picture
HEIGHT: Final = 4.4  # inches: of the two panels of a curve
LOOKS: Final[Mapping[str, Curve]] = {
    "closed form": Curve(name="closed form", ink="reference", width=3.4),
    "file": Curve(name="file", width=1.2),
    "without the cause": Curve(name="without the cause", ink=2, line="--", width=1.2),
}


@dataclass(frozen=True)
class JudgedCurve:
    """A signal of a file at some of its times, s: its values in a ``unit``, those of the closed form, the worst time.

    ``without`` are the file's values without the ``cause`` that is named, None where none is, or where either of two
    values is right. All are plain lists, so that a report's folder can save them.
    """

    name: str
    unit: str
    time: list[float]
    file: list[float]
    truth: list[float]
    worst: float
    error: str
    cause: str = ""
    without: list[float | None] | None = None

    @property
    def caption(self) -> str:
        """The caption of the picture, in one sentence."""
        removed = f", and without its likely cause: {self.cause}" if self.cause else ""
        return f"{self.name} of the file and of the closed form, and their difference, {self.error}{removed}."


def judged_chart(curves: Sequence[JudgedCurve], head: tuple[str, ...] = ()) -> Chart:
    """The curves side by side, each over its difference from the closed form."""
    drawn = curves[:MOST]
    panels = [_panel(curve, of_difference=below) for below in (False, True) for curve in drawn]
    key = tuple(LOOKS.values())[: 3 if any(curve.cause for curve in drawn) else 2]
    return Chart(tuple(panels), HEIGHT, columns=len(drawn), wide=True, head=head, key=key)


def _panel(curve: JudgedCurve, *, of_difference: bool) -> Panel:
    """The curves, or what they differ from the closed form by, with the worst place marked."""
    time, truth = np.array(curve.time), np.array(curve.truth)
    shown = {"closed form": truth, "file": np.array(curve.file)}
    if curve.without is not None:
        shown["without the cause"] = np.array(curve.without, dtype=float)
    if of_difference:
        shown = {name: values - truth for name, values in shown.items() if name != "closed form"}
    curves = tuple(replace(LOOKS[name], x=time, y=values, name="") for name, values in shown.items())
    mark = Mark(curve.worst, name="" if of_difference else f"worst at {curve.worst:.5g} s", ink="limit")
    label, title = (f"difference, {curve.unit}", "") if of_difference else (curve.unit, curve.name)
    return Panel(curves, "time, s", label, (mark,), names="", title=title)


# All errors of one mechanism at a glance: a dot per run and quantity, the limits as strokes.


# Of the settings naive, tuned, best, as on the page.
MARKERS: Final = ("x", "o", "D")
# Inches of a row and of all else.
ROW, FRAME = 0.22, 1.0
# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR: Final = 1e-16


def errors_chart(view: View, regime: Regime) -> Chart:
    """Every error of a mechanism under a regime: a row per quantity or invariant, within it a lane per engine."""
    known = [record for record in view.of(regime) if record.error_max is not None]
    groups = grouped(((*record.run, family(record.quantity)), record) for record in known)
    records = [worst(group) for group in groups.values()]
    families = {family(record.quantity) for record in records}
    quantities, invariants = ([name for name in part if name in families] for part in columns(view.results))
    rows, lanes = [*quantities, *invariants], sorted({record.engine for record in records})
    names, shown_setting = engines(view.results), view.shown_setting(regime)

    def dots(places: Sequence[tuple[float, Record]], name: str, ink: Ink, marker: str) -> Curve:
        lane = [0.72 * ((lanes.index(record.engine) + 0.5) / len(lanes) - 0.5) for _, record in places]
        y = [rows.index(family(record.quantity)) + shift for (_, record), shift in zip(places, lane, strict=True)]
        return Curve(np.array([place for place, _ in places]), np.array(y), name, ink, line="", marker=marker)

    limits = [(record.limit, record) for record in records if record.setting == shown_setting and record.limit]
    curves = [dots((), name, names.index(name), "s") for name in lanes]
    for marker, setting in zip(MARKERS, SETTINGS, strict=True):
        mine = [record for record in records if record.setting == setting]
        curves += [dots((), setting, "ink", marker)] if mine else []
        for engine in dict.fromkeys(record.engine for record in mine):
            places = [(max(r.error_max or 0.0, LEAST_ERROR), r) for r in mine if r.engine == engine]
            curves.append(dots(places, "", names.index(engine), marker))
    curves.append(dots(limits, f"limit ({shown_setting})", "limit", "|"))
    marks = (Mark(len(quantities) - 0.5, along="y"),) if invariants else ()
    words = tuple(plain(name) for name in rows)
    panel = Panel(tuple(curves), "largest |error| / peak", "", marks, scale="logx", names="key", rows=words)
    return Chart((panel,), ROW * len(rows) * (1.0 + 0.2 * max(len(lanes) - 1, 0)) + FRAME, wide=True)
