"""All errors of one mechanism at a glance: a dot per run and quantity, the limits as strokes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from comparisons.judging.records import Record
from comparisons.judging.verdicts import grouped
from reports.document.chart import Chart, Curve, Ink, Mark, Panel
from reports.document.templates import plain
from reports.records.views import SETTINGS, Regime, View, columns, engines, family, worst

# Of the settings naive, tuned, best, as on the page.
MARKERS: Final = ("x", "o", "D")
# Inches of a row and of all else.
ROW, FRAME = 0.22, 1.0
# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR: Final = 1e-16


def errors_chart(view: View, regime: Regime) -> Chart:
    """Every error of a mechanism under a regime: a row per quantity or invariant, within it a lane per engine."""
    records = worst_of_families([record for record in view.of(regime) if record.error_max is not None])
    families = {family(record.quantity) for record in records}
    quantities, invariants = ([name for name in part if name in families] for part in columns(view.results))
    rows, lanes = [*quantities, *invariants], sorted({record.engine for record in records})
    names, standing = engines(view.results), view.standing(regime)

    def dots(places: Sequence[tuple[float, Record]], name: str, ink: Ink, marker: str) -> Curve:
        lane = [0.72 * ((lanes.index(record.engine) + 0.5) / len(lanes) - 0.5) for _, record in places]
        y = [rows.index(family(record.quantity)) + shift for (_, record), shift in zip(places, lane, strict=True)]
        return Curve(np.array([place for place, _ in places]), np.array(y), name, ink, line="", marker=marker)

    limits = [(record.limit, record) for record in records if record.setting == standing and record.limit]
    curves = [dots((), name, names.index(name), "s") for name in lanes]
    for marker, setting in zip(MARKERS, SETTINGS, strict=True):
        mine = [record for record in records if record.setting == setting]
        curves += [dots((), setting, "ink", marker)] if mine else []
        for engine in dict.fromkeys(record.engine for record in mine):
            places = [(max(r.error_max or 0.0, LEAST_ERROR), r) for r in mine if r.engine == engine]
            curves.append(dots(places, "", names.index(engine), marker))
    curves.append(dots(limits, f"limit ({standing})", "limit", "|"))
    marks = (Mark(len(quantities) - 0.5, along="y"),) if invariants else ()
    words = tuple(plain(name) for name in rows)
    panel = Panel(tuple(curves), "largest |error| / peak", "", marks, scale="logx", names="key", rows=words)
    return Chart((panel,), ROW * len(rows) * (1.0 + 0.2 * max(len(lanes) - 1, 0)) + FRAME, wide=True)


def worst_of_families(records: Sequence[Record]) -> list[Record]:
    """One record per run and family of quantities."""
    groups = grouped(((*record.run, family(record.quantity)), record) for record in records)
    return [worst(group) for group in groups.values()]
