"""All errors of one mechanism at a glance: a dot per run and quantity, the limits as strokes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from comparisons.judging.records import Record
from reports.charts.labels import width
from reports.charts.scales import power_of_ten
from reports.charts.style import FAINT, FULL_WIDTH, INK, LIMIT_COLOUR, MUTED, colour, drawn
from reports.document.templates import plain
from reports.records.views import SETTINGS, Regime, View, columns, engines, family, worst

MARKERS = ("o", "s", "^", "D", "v", "P")
# The more care, the fuller: naive, tuned, best.
FILLINGS: tuple[Literal["none", "left", "full"], ...] = ("none", "left", "full")
# Inches of a row and of all else.
ROW, FRAME = 0.22, 1.0
# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR = 1e-16


def errors_figure(view: View, regime: Regime) -> Figure:
    """Every error of a mechanism under a regime: a row per quantity or invariant, within it a lane per engine."""
    records = worst_of_families([record for record in view.of(regime) if record.error_max is not None])
    held = {family(record.quantity) for record in records}
    quantities, invariants = ([name for name in part if name in held] for part in columns(view.results))
    lanes = sorted({record.engine for record in records})
    height = ROW * len(held) * (1.0 + 0.2 * max(len(lanes) - 1, 0)) + FRAME
    left = max(width(plain(name)) for name in held) + 0.15
    edges = {"left": left / FULL_WIDTH, "right": 0.985, "top": 1.0 - 0.34 / height, "bottom": 0.42 / height}

    def draw(figure: Figure) -> None:
        axes = figure.subplots(gridspec_kw=edges)
        _draw_rows(axes, quantities, invariants)
        _draw_dots(axes, view, regime, records, rows=[*quantities, *invariants], lanes=lanes)

    return drawn(FULL_WIDTH, height, draw)


def worst_of_families(records: Sequence[Record]) -> list[Record]:
    """One record per run and family of quantities."""
    groups: dict[tuple[str, ...], list[Record]] = {}
    for record in records:
        groups.setdefault((*record.run, family(record.quantity)), []).append(record)
    return [worst(group) for group in groups.values()]


def _draw_rows(axes: Axes, quantities: Sequence[str], invariants: Sequence[str]) -> None:
    """Decades across, the rows' names down, a line between quantities and invariants."""
    rows = [*quantities, *invariants]
    axes.set_xscale("log")
    axes.set_xlabel("largest |error| / peak")
    axes.grid(visible=False, axis="y")
    axes.set_yticks(range(len(rows)), [plain(name) for name in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    for row in range(1, len(rows), 2):
        axes.axhspan(row - 0.5, row + 0.5, color=FAINT, alpha=0.35, linewidth=0.0, zorder=0.5)
    if invariants:
        axes.axhline(len(quantities) - 0.5, color=MUTED, linewidth=0.8)


def _draw_dots(
    axes: Axes, view: View, regime: Regime, records: Sequence[Record], *, rows: Sequence[str], lanes: Sequence[str]
) -> None:
    """Every error, the limits of the setting that stands for the engines, and above them what is what."""
    names, standing = engines(view.results), view.standing(regime)
    settings = [name for name in SETTINGS if any(record.setting == name for record in records)]

    def height(record: Record) -> float:
        return rows.index(family(record.quantity)) + 0.72 * ((lanes.index(record.engine) + 0.5) / len(lanes) - 0.5)

    def dot(engine: str) -> dict[str, Any]:
        return {"marker": MARKERS[names.index(engine) % len(MARKERS)], "color": colour(engine, names)}

    def filled(setting: str) -> dict[str, Any]:
        return {"fillstyle": FILLINGS[SETTINGS.index(setting)] if len(settings) > 1 else "full"}

    common: dict[str, Any] = {"linestyle": "none", "markersize": 5.4, "markerfacecoloralt": "white"}
    stroke: dict[str, Any] = {
        "linestyle": "none",
        "marker": "|",
        "color": LIMIT_COLOUR,
        "markersize": 9,
        "markeredgewidth": 1.4,
    }
    held = [(record.limit, height(record)) for record in records if record.setting == standing and record.limit]
    axes.plot(*zip(*held, strict=True) if held else ((), ()), **stroke, zorder=2.0)
    for (engine, setting), run in groupby(records, key=lambda record: (record.engine, record.setting)):
        dots = [(max(record.error_max or 0.0, LEAST_ERROR), height(record)) for record in run]
        axes.plot(*zip(*dots, strict=True), **common, **dot(engine), **filled(setting), markeredgewidth=1.0, zorder=3.0)
    axes.xaxis.set_major_locator(LogLocator(base=10.0, numticks=20))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: power_of_ten(value)))
    axes.xaxis.set_minor_locator(NullLocator())
    key = [Line2D([], [], **common, **dot(name), label=name) for name in lanes]
    if len(settings) > 1:
        key += [Line2D([], [], **common, marker="o", color=INK, **filled(name), label=name) for name in settings]
    key.append(Line2D([], [], **stroke, label=f"limit ({standing})"))
    axes.legend(handles=key, loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=len(key), handletextpad=0.2,
                columnspacing=1.4, borderaxespad=0.2)  # fmt: skip
