"""A chart as data drawn by matplotlib, and a figure's files: SVG that follows the reader's colours, PNG on white."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from reports.charts import labels
from reports.charts.layout import EDGE, LEAST, SAMPLE, TICK, ChartLayout, key_width, named_uprights
from reports.charts.scales import Scale
from reports.charts.style import DARK, DOTS_PER_INCH, FAINT, FULL_WIDTH, MUTED, WIDTH, drawn, house_style, ink
from reports.document.chart import Chart, Curve, Panel

Array = NDArray[np.float64]


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
    layout = ChartLayout(chart, size)
    for number in range(len(chart.panels)):
        _draw_panel(found, layout, number, corner)


def edges(chart: Chart) -> tuple[float, float]:
    """Left and right end of the axes of a chart's first panel, as shares of the width."""
    size = _size(chart)
    left, _, width, _ = ChartLayout(chart, size).box(0)
    return left / size[0], (left + width) / size[0]


def _size(chart: Chart) -> tuple[float, float]:
    """Width and height of a chart's figure, in: higher than it asks for where its names take all the room."""
    width = FULL_WIDTH if chart.wide else WIDTH
    layout = ChartLayout(chart, (width, chart.height))
    return width, chart.height + layout.rows * max(0.0, LEAST - layout.height)


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


def _draw_panel(found: Figure, layout: ChartLayout, number: int, corner: tuple[float, float]) -> None:
    panel, (x, y) = layout.chart.panels[number], layout.fitted(number)
    (left, bottom, width, height), (wide, high) = layout.box(number), found.get_size_inches()
    axes = found.add_axes(((corner[0] + left) / wide, (corner[1] + bottom) / high, width / wide, height / high))
    room = (layout.margins[0], layout.width, layout.height)
    axes.set_axis_off()
    axes.set(xscale="log" if x.is_log else "linear", yscale="log" if y.is_log else "linear")
    axes.set(xlim=(x.low, x.high), ylim=(y.low, y.high), autoscale_on=False)
    _draw_words(axes, x, y, room, named=layout.names_x(number))
    _draw_grid(axes, x, y, room, equal=panel.scale == "equal")
    _draw_curves(axes, panel)
    _draw_marks(axes, panel, layout, number)
    labels.write_ends(axes, layout.ends[number], layout.height)
    _draw_heads(axes, panel, layout, number)
    points = np.concatenate([np.zeros((0, 2)), *(np.transpose([curve.x, curve.y]) for curve in panel.curves)])
    labels.write_notes(axes, panel.notes, points, (layout.width, layout.height))


def _draw_words(axes: Axes, x: Scale, y: Scale, box: tuple[float, float, float], *, named: bool) -> None:
    """Ticks' words and labels; ``box`` is the room on the left, the width and the height of the axes, in.

    matplotlib's own axes take longer than all that is drawn in them.
    """
    left, width, height = box
    down, beside = -(TICK + 0.65 * labels.LINE) / height, -TICK / width
    for tick, word in zip(x.ticks, x.words, strict=True) if named else ():
        axes.text(tick, down, word, transform=axes.get_xaxis_transform(), ha="center")
    for tick, word in zip(y.ticks, y.words, strict=True):
        axes.text(beside, tick, word, transform=axes.get_yaxis_transform(), ha="right", va="center")
    if named:
        axes.text(0.5, down - 1.1 * labels.LINE / height, x.label, transform=axes.transAxes, ha="center")
    axes.text((EDGE - left) / width, 0.5, y.label, transform=axes.transAxes, rotation=90.0, va="center")


def _draw_grid(axes: Axes, x: Scale, y: Scale, box: tuple[float, float, float], *, equal: bool) -> None:
    """Grid, strokes of the ticks, lines at zero, frame on the left and below."""
    has_zero = (equal and x.low < 0.0 < x.high, not y.is_log and y.low < 0.0 < y.high)
    for number, scale in enumerate((x, y)):
        stroke = -0.035 / box[2 - number]
        _ruled(axes, scale.ticks, (0.0, 1.0), number, FAINT)
        _ruled(axes, scale.ticks, (stroke, 0.0), number, MUTED)
        _ruled(axes, (0.0,) * has_zero[number], (0.0, 1.0), number, MUTED)
        _ruled(axes, (scale.low,), (0.0, 1.0), number, MUTED)


def _ruled(axes: Axes, places: Sequence[float], ends: tuple[float, float], number: int, colour: str) -> None:
    """Lines at places of the x axis (``number`` 0) or the y axis between two shares of the other, as one."""
    points = np.repeat(places, 3), np.tile([*ends, np.nan], len(places))
    transform = axes.get_yaxis_transform() if number else axes.get_xaxis_transform()
    layer = 1.0 if colour == FAINT else 1.5
    line = Line2D(*points[:: -1 if number else 1], color=colour, linewidth=0.6, zorder=layer, clip_on=False)
    line.set_transform(transform)
    axes.add_artist(line)


def _draw_curves(axes: Axes, panel: Panel) -> None:
    below: Array | float = 0.0
    for curve in panel.curves:
        colour = ink(curve.ink)
        if curve.stacked:
            axes.fill_between(curve.x, below, curve.y, color=colour, alpha=0.75, linewidth=0.0)
            below = curve.y
        axes.add_artist(_line(curve, curve.x, curve.y, clip_on=not curve.marker))


def _line(curve: Curve, x: Array | Sequence[float], y: Array | Sequence[float], **more: Any) -> Line2D:  # noqa: ANN401  matplotlib's own
    broad = 1.0 if curve.ink == "reference" else 0.0
    line: Any = curve.line or "none"
    return Line2D(x, y, color=ink(curve.ink), linestyle=line, linewidth=curve.width,
                  marker=curve.marker or "none", markersize=4.5, zorder=3.0 - broad, **more)  # fmt: skip


def _draw_marks(axes: Axes, panel: Panel, layout: ChartLayout, number: int) -> None:
    """Lines across the panel; the names of uprights stand above it."""
    for mark in panel.marks:
        line = axes.axvline if mark.along == "x" else axes.axhline
        style: Any = "-" if mark.ink == "faint" else (0, (5, 2))
        line(mark.place, color=ink(mark.ink), linewidth=0.9, linestyle=style, zorder=1.4 if style == "-" else 2.0)
    for mark, row in zip(named_uprights(panel), layout.uprights[number], strict=True):
        left, right = layout.upright(number, mark.place, mark.name)
        _above(axes, 0.5 * (left + right), row, mark.name, layout, ha="center", color=ink(mark.ink))


def _above(axes: Axes, left: float, row: int, text: str, layout: ChartLayout, **style: Any) -> None:  # noqa: ANN401
    """Words in a row above the axes, from ``left``, in."""
    place = 1.0 + (0.4 * labels.LINE + row * labels.LINE) / layout.height
    axes.text(left / layout.width, place, text, transform=axes.transAxes, va="bottom", **style)


def _draw_heads(axes: Axes, panel: Panel, layout: ChartLayout, number: int) -> None:
    """The key above the names of the uprights, the title on top."""
    first = max(layout.uprights[number], default=-1) + 1
    rows = layout.keys[number][::-1]
    wide = max((key_width(curve) for row in rows for curve in row), default=0.0)
    for row, curves in enumerate(rows, start=first):
        middle = 1.0 + (0.85 + row) * labels.LINE / layout.height
        for left, curve in zip(wide * np.arange(len(curves)), curves, strict=True):
            sample = np.array([left, left + SAMPLE - 0.06]) / layout.width
            axes.add_artist(_line(curve, sample, [middle] * 2, transform=axes.transAxes, clip_on=False, markevery=[1]))
            _above(axes, left + SAMPLE, row, curve.name, layout)
    if panel.title:
        _above(axes, 0.0, first + len(rows), panel.title, layout, weight="bold")
