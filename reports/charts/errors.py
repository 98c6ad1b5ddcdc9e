"""All deviations of one mechanism at a glance: a dot per run and quantity, the limits as strokes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from comparisons.judging.records import Record
from reports.charts.style import FAINT, FULL_WIDTH, INK, LIMIT_COLOUR, MUTED, colour, decades, drawn
from reports.records.views import SETTINGS, Regime, View, columns, engines, family, worst

# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR = 1e-16
Filling = Literal["none", "left", "full"]
FILLINGS: tuple[Filling, ...] = ("none", "left", "full")
MARKERS = ("o", "s", "^", "D", "v", "P")
ROW, FRAME = 0.22, 1.0


def errors_figure(view: View, regime: Regime) -> Figure:
    """Every deviation of a mechanism under a regime."""
    quantities, invariants = _rows(view, regime)
    lanes = len({record.engine for record in view.of(regime) if record.error_max is not None})
    height = ROW * (len(quantities) + len(invariants)) * (1.0 + 0.2 * max(lanes - 1, 0)) + FRAME
    edges = {"left": 0.135, "right": 0.985, "top": 1.0 - 0.34 / height, "bottom": 0.42 / height}
    return drawn(FULL_WIDTH, height, lambda figure: draw_errors(figure.subplots(gridspec_kw=edges), view, regime))


def draw_errors(axes: Axes, view: View, regime: Regime) -> None:
    """One row per quantity, one lane per engine within it, the marker's filling for the setting."""
    quantities, invariants = _rows(view, regime)
    rows = [*quantities, *invariants]
    records = worst_of_families([r for r in view.of(regime) if r.error_max is not None])
    lanes = sorted({record.engine for record in records})
    many = len({record.setting for record in records}) > 1

    def height(record: Record) -> float:
        return rows.index(family(record.quantity)) + 0.72 * ((lanes.index(record.engine) + 0.5) / len(lanes) - 0.5)

    _draw_limits(axes, [record for record in records if record.setting == view.standing(regime)], height)
    for _, run in groupby(records, key=lambda record: record.run):
        _draw_run(axes, view, list(run), height, many)
    for row in range(1, len(rows), 2):
        axes.axhspan(row - 0.5, row + 0.5, color=FAINT, alpha=0.35, linewidth=0.0, zorder=0.5)
    if invariants:
        axes.axhline(len(quantities) - 0.5, color=MUTED, linewidth=0.8)
    _scales(axes, rows)
    _key(axes, view, regime, many)


def _scales(axes: Axes, rows: list[str]) -> None:
    """Decades across, the rows' names down."""
    axes.set_xscale("log")
    decades(axes.xaxis, 20)
    axes.set_xlabel("largest |error| / peak")
    axes.grid(visible=False, axis="y")
    axes.set_yticks(range(len(rows)), [name.replace("_", " ") for name in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)


def _rows(view: View, regime: Regime) -> tuple[list[str], list[str]]:
    """The families of quantities and the invariants that a regime has records of."""
    held = {family(record.quantity) for record in view.of(regime)}
    quantities, invariants = columns(view.results)
    return [name for name in quantities if name in held], [name for name in invariants if name in held]


def worst_of_families(records: Sequence[Record]) -> list[Record]:
    """One record per run and family of quantities."""
    groups: dict[tuple[str, ...], list[Record]] = {}
    for record in records:
        groups.setdefault((*record.run, family(record.quantity)), []).append(record)
    return [worst(group) for group in groups.values()]


def _draw_limits(axes: Axes, records: Sequence[Record], height: Callable[[Record], float]) -> None:
    """The limits of these records as strokes."""
    held = [(record.limit, height(record)) for record in records if record.limit is not None]
    places = np.array(held, dtype=float).reshape(-1, 2)
    axes.plot(
        *places.T, linestyle="none", marker="|", markersize=9, markeredgewidth=1.4, color=LIMIT_COLOUR, zorder=2.0
    )


def _draw_run(axes: Axes, view: View, records: Sequence[Record], height: Callable[[Record], float], many: bool) -> None:
    """The deviations of one run as dots."""
    first, names = records[0], engines(view.results)
    axes.plot(
        [max(record.error_max or 0.0, LEAST_ERROR) for record in records],
        [height(record) for record in records],
        linestyle="none",
        marker=MARKERS[names.index(first.engine) % len(MARKERS)],
        markersize=5.4,
        color=colour(first.engine, names),
        markerfacecoloralt="white",
        markeredgewidth=1.0,
        fillstyle=_filling(first.setting, many),
        zorder=3.0,
    )


def _filling(setting: str, many: bool) -> Filling:
    """Empty for naive, half for tuned, full for best: the more care, the fuller."""
    if not many or setting not in SETTINGS:
        return "full"
    return FILLINGS[SETTINGS.index(setting)]


def _key(axes: Axes, view: View, regime: Regime, many: bool) -> None:
    """Engines by colour and shape, settings by filling."""
    shown = {record.engine for record in view.of(regime) if record.error_max is not None}
    names = engines(view.results)
    handles = [
        Line2D([], [], linestyle="none", marker=MARKERS[i % len(MARKERS)], color=colour(name, names), markersize=5.4,
               label=name)
        for i, name in enumerate(names) if name in shown
    ]  # fmt: skip
    if many:
        ran = {record.setting for record in view.of(regime) if record.error_max is not None}
        handles += [
            Line2D([], [], linestyle="none", marker="o", color=INK, markerfacecoloralt="white", markersize=5.4,
                   fillstyle=_filling(s, True), label=s)
            for s in SETTINGS if s in ran
        ]  # fmt: skip
    handles.append(
        Line2D([], [], linestyle="none", marker="|", color=LIMIT_COLOUR, markersize=8, markeredgewidth=1.4,
               label=f"limit ({view.standing(regime)})")
    )  # fmt: skip
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=len(handles), handletextpad=0.2,
                columnspacing=1.4, borderaxespad=0.2)  # fmt: skip
