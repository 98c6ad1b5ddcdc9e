"""A chart as data drawn by matplotlib, and a figure's files: SVG that follows the reader's colours, PNG on white."""

from __future__ import annotations

import io
import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator
from numpy.typing import NDArray

from reports.charts import labels, scales
from reports.charts.scales import Scale
from reports.charts.style import DARK, DOTS_PER_INCH, FULL_WIDTH, MUTED, WIDTH, drawn, house_style, ink
from reports.document.chart import Chart, Curve, Mark, Panel

Array = NDArray[np.float64]
# An end of a curve: its place as a share of the panel's height, its name and colour.
End = tuple[float, str, str]

# Inches: around a chart, of a tick with its pad, between panels, of a sample of a line in the key, between its entries.
EDGE, TICK, BETWEEN, SAMPLE, APART = 0.06, 0.08, 0.1, 0.3, 0.2
SPACED = {"x": 0.75, "y": 0.3}  # inches from tick to tick, at least

_COORDINATES = re.compile(r'\b(?:d|x|y|x1|x2|y1|y2|width|height|transform|points)="[^"]*"')
_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_METADATA = re.compile(r"<metadata>.*?</metadata>\s*", re.DOTALL)
_STYLE = re.compile(r"(<style[^>]*>)(.*?)(</style>)", re.DOTALL)


def figure(chart: Chart) -> Figure:
    """The chart, drawn."""
    size = _size(chart)
    return drawn(*size, lambda found: place(found, chart, (0.0, 0.0), size))


def place(found: Figure, chart: Chart, corner: tuple[float, float], size: tuple[float, float]) -> None:
    """Draw the chart into a part of a figure: its lower left corner and its width and height, in."""
    layout = _Layout(chart, size)
    for number in range(len(chart.panels)):
        _draw_panel(found, layout, number, corner)


def edges(chart: Chart) -> tuple[float, float]:
    """Left and right end of the axes of a chart's first panel, as shares of the width."""
    size = _size(chart)
    left, _, width, _ = _Layout(chart, size).box(0)
    return left / size[0], (left + width) / size[0]


def _size(chart: Chart) -> tuple[float, float]:
    return (FULL_WIDTH if chart.wide else WIDTH), chart.height


def svg(drawing: Figure, page: str = "none") -> str:
    """The figure as an SVG file, the same for the same figure; a dark scheme of the reader's turns its colours.

    ``page`` is the colour behind it.
    """
    buffer = io.StringIO()
    with matplotlib.rc_context(house_style()):
        drawing.savefig(buffer, format="svg", facecolor=page, metadata={"Date": None, "Creator": None})
    text = _METADATA.sub("", buffer.getvalue())
    text = _COORDINATES.sub(lambda found: _LONG_NUMBER.sub(r"\1", found[0]), text)
    dark = "" if page != "none" else f"@media (prefers-color-scheme: dark){{{_dark(text)}}}"
    return _STYLE.sub(lambda found: f"{found[1]}{found[2].strip()}{dark}{found[3]}", text, count=1)


def png(drawing: Figure) -> bytes:
    """The figure as a PNG file on white, for papers."""
    buffer = io.BytesIO()
    with matplotlib.rc_context(house_style()):
        drawing.savefig(buffer, format="png", dpi=DOTS_PER_INCH, facecolor="white", metadata={"Software": None})
    return buffer.getvalue()


def _dark(text: str) -> str:
    """Rules that turn the colours a drawing has."""
    return "".join(
        f'[style*="{what}: {light}"]{{{what}:{dark}!important}}'
        for light, dark in DARK.items()
        for what in ("fill", "stroke")
        if f"{what}: {light}" in text
    )


@dataclass(frozen=True)
class _Layout:
    """Where every panel of a chart stands, in: found from its words alone, so that none of them touches another."""

    chart: Chart
    size: tuple[float, float]

    @property
    def columns(self) -> int:
        return min(self.chart.columns, len(self.chart.panels))

    @property
    def rows(self) -> int:
        return -(-len(self.chart.panels) // self.columns)

    def column(self, number: int) -> list[Panel]:
        return list(self.chart.panels[number % self.columns :: self.columns])

    def shares_x(self, number: int) -> bool:
        """Whether a panel has the x axis of those below and above it."""
        column = self.column(number)
        return len({panel.scale == "loglog" for panel in column}) == 1 and column[0].scale != "equal"

    def names_x(self, number: int) -> bool:
        """Whether words stand below a panel: it is the last of its column, or has an axis of its own."""
        return not self.shares_x(number) or number + self.columns >= len(self.chart.panels)

    @cached_property
    def scales(self) -> list[tuple[Scale, Scale]]:
        wide, tall = self.size[0] / self.columns - 0.9, self.size[1] / self.rows - 0.5
        found = []
        for number, panel in enumerate(self.chart.panels):
            group = self.column(number) if self.shares_x(number) else [panel]
            x = scales.across(group, max(2, int(wide / SPACED["x"])))
            found.append((x, scales.upward(panel, max(2, int(tall / SPACED["y"])))))
        return found

    @cached_property
    def ends(self) -> list[list[End]]:
        """The names at the right of every panel: of its curves, unless they stand in the key, and of its levels."""
        return [_ends(panel, y, with_curves=not self.has_key(n))
                for n, (panel, (_, y)) in enumerate(zip(self.chart.panels, self.scales, strict=True))]  # fmt: skip

    def has_key(self, number: int) -> bool:
        """Whether the curves' names stand above the panel: as asked for, or where there are too many for the end."""
        panel = self.chart.panels[number]
        names = [labels.wrapped(curve.name) for curve in panel.curves if curve.name]
        tall = self.size[1] / self.rows - 0.4
        return panel.names == "key" or (panel.names == "ends" and sum(map(labels.height, names)) > tall)

    @cached_property
    def margins(self) -> list[tuple[float, float]]:
        """Room on the left and right of the axes of every column."""
        found = []
        for column in range(self.columns):
            numbers = range(column, len(self.chart.panels), self.columns)
            ticks = [max(map(labels.width, self.scales[n][1].words), default=0.0) for n in numbers]
            named = any(self.scales[n][1].label for n in numbers)
            left = EDGE + TICK + max(ticks) + (labels.LINE + 0.05 if named else 0.0)
            names = [labels.width(end[1]) + labels.GAP for n in numbers for end in self.ends[n]]
            last = (
                max(labels.width(self.scales[n][0].words[-1]) for n in numbers) if self.scales[column][0].words else 0
            )
            found.append((left, EDGE + max([0.5 * last, *names])))
        return found

    @property
    def width(self) -> float:
        """Of the axes of a panel."""
        return (self.size[0] - sum(map(sum, self.margins)) - BETWEEN * (self.columns - 1)) / self.columns

    @cached_property
    def keys(self) -> list[list[list[Curve]]]:
        """The rows of every panel's key."""
        return [_key_rows(panel, self.width) if self.has_key(n) else [] for n, panel in enumerate(self.chart.panels)]

    @cached_property
    def uprights(self) -> list[list[int]]:
        """The row above a panel in which each of its named uprights has its name."""
        return [labels.rows_above([self.upright(n, mark.place, mark.name) for mark in _uprights(panel)])
                for n, panel in enumerate(self.chart.panels)]  # fmt: skip

    def upright(self, number: int, place: float, name: str) -> tuple[float, float]:
        """Left and right end of an upright's name above a panel, in, kept within the panel."""
        half = 0.5 * labels.width(name)
        middle = float(np.clip(self.width * self.scales[number][0].share(place), half, max(self.width - half, half)))
        return middle - half, middle + half

    def above(self, number: int) -> float:
        """Room above a panel."""
        named = max(self.uprights[number], default=-1) + 1
        rows = named + len(self.keys[number]) + bool(self.chart.panels[number].title)
        return EDGE + labels.LINE * (0.5 + rows)

    def below(self, number: int) -> float:
        """Room below a panel."""
        if not self.names_x(number):
            return 0.0
        return TICK + labels.LINE * (1.35 + bool(self.scales[number][0].label)) + (0.04 if self.rows > 1 else 0.0)

    @cached_property
    def heights(self) -> list[tuple[float, float]]:
        """Room above and below the axes of every row."""
        rows = [range(r * self.columns, min((r + 1) * self.columns, len(self.chart.panels))) for r in range(self.rows)]
        return [(max(map(self.above, row)), max(map(self.below, row))) for row in rows]

    @property
    def height(self) -> float:
        """Of the axes of a panel, in."""
        return (self.size[1] - EDGE - sum(map(sum, self.heights))) / self.rows

    def box(self, number: int) -> tuple[float, float, float, float]:
        """Left, bottom, width and height of a panel's axes, in."""
        row, column = divmod(number, self.columns)
        left = sum(map(sum, self.margins[:column])) + column * (self.width + BETWEEN) + self.margins[column][0]
        top = sum(map(sum, self.heights[:row])) + row * self.height + self.heights[row][0]
        return left, self.size[1] - top - self.height, self.width, self.height


def _uprights(panel: Panel) -> list[Mark]:
    return sorted((mark for mark in panel.marks if mark.along == "x" and mark.name), key=lambda mark: mark.place)


def _ends(panel: Panel, y: Scale, *, with_curves: bool) -> list[End]:
    found = []
    if with_curves and panel.names == "ends":
        below = np.zeros(1)
        for curve in panel.curves:
            height = _last(curve.y) if not curve.stacked else 0.5 * (_last(curve.y) + _last(below))
            below = curve.y
            found += [(y.share(height), labels.wrapped(curve.name), ink(curve.ink))] if curve.name else []
    levels = [mark for mark in panel.marks if mark.along == "y" and mark.name]
    return found + [(y.share(mark.place), labels.wrapped(mark.name), ink(mark.ink)) for mark in levels]


def _last(values: Array) -> float:
    return float(next((value for value in values[::-1] if np.isfinite(value)), 0.0))


def _key_rows(panel: Panel, width: float) -> list[list[Curve]]:
    """Curves with a name, each once, in rows that fit."""
    rows: list[list[Curve]] = [[]]
    left = width
    for curve in {curve.name: curve for curve in panel.curves if curve.name}.values():
        needed = SAMPLE + labels.width(curve.name) + APART
        if needed > left and rows[-1]:
            rows.append([])
            left = width
        rows[-1].append(curve)
        left -= needed
    return rows if rows[0] else []


def _draw_panel(found: Figure, layout: _Layout, number: int, corner: tuple[float, float]) -> None:
    panel, (x, y) = layout.chart.panels[number], layout.scales[number]
    (left, bottom, width, height), (wide, high) = layout.box(number), found.get_size_inches()
    axes = found.add_axes(((corner[0] + left) / wide, (corner[1] + bottom) / high, width / wide, height / high))
    if panel.scale == "equal":
        ticks = max(2, int(layout.width / SPACED["x"]))
        x, y = scales.to_scale(panel, (x, y), (layout.width, layout.height), ticks)
    _draw_scales(axes, x, y, named=layout.names_x(number), equal=panel.scale == "equal")
    _draw_curves(axes, panel)
    _draw_marks(axes, panel, layout, number)
    labels.write_ends(axes, layout.ends[number], layout.height)
    _draw_heads(axes, panel, layout, number)
    _draw_notes(axes, panel, (x, y), (layout.width, layout.height))


def _draw_scales(axes: Axes, x: Scale, y: Scale, *, named: bool, equal: bool) -> None:
    axes.set(xscale="log" if x.is_log else "linear", yscale="log" if y.is_log else "linear")
    axes.set(xlim=(x.low, x.high), ylim=(y.low, y.high), autoscale_on=False)
    for axis, scale, words in ((axes.xaxis, x, x.words if named else [""] * len(x.words)), (axes.yaxis, y, y.words)):
        axis.set_major_locator(FixedLocator(scale.ticks))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FixedFormatter(list(words)))
    if named:
        axes.set_xlabel(x.label, labelpad=2.0)
    axes.set_ylabel(y.label, labelpad=3.0)
    if not y.is_log and y.low < 0.0 < y.high:
        axes.axhline(0.0, color=MUTED, linewidth=0.6, zorder=1.5)
    if equal and x.low < 0.0 < x.high:
        axes.axvline(0.0, color=MUTED, linewidth=0.6, zorder=1.5)


def _draw_curves(axes: Axes, panel: Panel) -> None:
    below: Array | float = 0.0
    for curve in panel.curves:
        colour = ink(curve.ink)
        if curve.stacked:
            axes.fill_between(curve.x, below, curve.y, color=colour, alpha=0.75, linewidth=0.0)
            below = curve.y
        axes.add_line(_line(curve, curve.x, curve.y, clip_on=not curve.marker))


def _line(curve: Curve, x: Array | Sequence[float], y: Array | Sequence[float], **more: Any) -> Line2D:  # noqa: ANN401  matplotlib's own
    broad = 1.0 if curve.ink == "reference" else 0.0
    line: Any = curve.line or "none"
    return Line2D(x, y, color=ink(curve.ink), linestyle=line, linewidth=curve.width,
                  marker=curve.marker or "none", markersize=4.5, zorder=3.0 - broad, **more)  # fmt: skip


def _draw_marks(axes: Axes, panel: Panel, layout: _Layout, number: int) -> None:
    """Lines across the panel; the names of uprights stand above it."""
    for mark in panel.marks:
        line = axes.axvline if mark.along == "x" else axes.axhline
        style: Any = "-" if mark.ink == "faint" else (0, (5, 2))
        line(mark.place, color=ink(mark.ink), linewidth=0.9, linestyle=style, zorder=1.4 if style == "-" else 2.0)
    for mark, row in zip(_uprights(panel), layout.uprights[number], strict=True):
        left, right = layout.upright(number, mark.place, mark.name)
        _above(axes, 0.5 * (left + right), row, mark.name, layout, ha="center", color=ink(mark.ink))


def _above(axes: Axes, left: float, row: int, text: str, layout: _Layout, **style: Any) -> None:  # noqa: ANN401
    """Words in a row above the axes, from ``left``, in."""
    place = 1.0 + (0.4 * labels.LINE + row * labels.LINE) / layout.height
    axes.text(left / layout.width, place, text, transform=axes.transAxes, va="bottom", **style)


def _draw_heads(axes: Axes, panel: Panel, layout: _Layout, number: int) -> None:
    """The key above the names of the uprights, the title on top."""
    first = max(layout.uprights[number], default=-1) + 1
    rows = layout.keys[number][::-1]
    for row, curves in enumerate(rows, start=first):
        left, middle = 0.0, 1.0 + (0.4 + row + 0.45) * labels.LINE / layout.height
        for curve in curves:
            sample = np.array([left, left + SAMPLE - 0.06]) / layout.width
            axes.add_artist(_line(curve, sample, [middle] * 2, transform=axes.transAxes, clip_on=False, markevery=[1]))
            _above(axes, left + SAMPLE, row, curve.name, layout)
            left += SAMPLE + labels.width(curve.name) + APART
    if panel.title:
        _above(axes, 0.0, first + len(rows), panel.title, layout, weight="bold")


def _draw_notes(axes: Axes, panel: Panel, both: tuple[Scale, Scale], box: tuple[float, float]) -> None:
    x, y = both
    notes = [(x.share(note.x), y.share(note.y), note.text) for note in panel.notes]
    if not notes:
        return
    every = [list(zip(map(x.share, curve.x), map(y.share, curve.y), strict=True)) for curve in panel.curves]
    spots = np.array(list(itertools.chain.from_iterable(every)) or [(-1.0, -1.0)])
    labels.write_notes(axes, [note for note in notes if np.isfinite(note[:2]).all()], spots, box)
