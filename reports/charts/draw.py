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

from reports.charts import labels, surfaces
from reports.charts.layout import EDGE, LEAST, SAMPLE, TICK, ChartLayout, in_rows, key_width, named_uprights
from reports.charts.scales import Scale
from reports.charts.style import DARK, DOTS_PER_INCH, FAINT, FULL_WIDTH, MUTED, WIDTH, drawn, house_style, ink
from reports.document.chart import Chart, Curve, Hatch, Panel

Array = NDArray[np.float64]

BAR = 3.0  # points, of lines that are bars

_COORDINATES = re.compile(r'\b(?:d|x|y|x1|x2|y1|y2|width|height|transform|points)="[^"]*"')
_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_METADATA = re.compile(r"<metadata>.*?</metadata>\s*", re.DOTALL)
_STYLE = re.compile(r"(<style[^>]*>)(.*?)(</style>)", re.DOTALL)


def figure(chart: Chart, width: float | None = None) -> Figure:
    """The chart, drawn in the page's width for it or in so many inches."""
    size = _size(chart, width or _width(chart))
    return drawn(*size, lambda found: place(found, chart, (0.0, 0.0), size))


def place(found: Figure, chart: Chart, corner: tuple[float, float], size: tuple[float, float]) -> None:
    """Draw the chart into a part of a figure: its lower left corner and its width and height, in."""
    layout = ChartLayout(chart, (size[0], size[1] - head_room(chart, size[0])))
    for number in range(len(chart.panels)):
        _draw_panel(found, layout, number, corner)
    draw_head(found, chart, (corner[0], corner[1] + layout.size[1]), size[0])


def edges(chart: Chart) -> tuple[float, float]:
    """Left and right end of the axes of a chart's first panel, as shares of the width."""
    size = _size(chart, _width(chart))
    left, _, width, _ = ChartLayout(chart, size).box(0)
    return left / size[0], (left + width) / size[0]


def _width(chart: Chart) -> float:
    return FULL_WIDTH if chart.wide else WIDTH


def _size(chart: Chart, width: float) -> tuple[float, float]:
    """Width and height of a chart's figure, in: higher than it asks for where its names take all the room."""
    height = head_room(chart, width) + chart.height
    if not chart.panels:
        return width, height
    layout = ChartLayout(chart, (width, chart.height))
    return width, height + layout.rows * max(0.0, LEAST - layout.height)


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


def png(drawing: Figure, dots: int = DOTS_PER_INCH) -> bytes:
    """The figure as a PNG file on white, for papers, so many dots to the inch."""
    return _saved(drawing, "png", ("Software",), dpi=dots)


def pdf(drawing: Figure) -> bytes:
    """The figure as a PDF file on white, for papers: lines as lines, its fonts within it."""
    return _saved(drawing, "pdf", ("CreationDate", "Creator", "Producer"))


def _saved(drawing: Figure, kind: str, changing: Sequence[str], **more: Any) -> bytes:  # noqa: ANN401
    """A figure as a file of a kind, without what would be ``changing`` from one time to the next."""
    buffer = io.BytesIO()
    with matplotlib.rc_context(house_style()):
        drawing.savefig(buffer, format=kind, facecolor="white", metadata=dict.fromkeys(changing), **more)
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
    if panel.hatch:
        for low, high in panel.hatch.stretches:
            surfaces.hatched(axes, (low, 0.0, high - low, 1.0), axes.get_xaxis_transform())
    if panel.surface:
        surfaces.draw_surface(axes, panel.surface, layout.width)
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
        line = 0.1 + max(labels.lines(x.label), 1)
        axes.text(0.5, down - line * labels.LINE / height, x.label, transform=axes.transAxes, ha="center")
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
    if curve.width >= BAR:
        more["solid_capstyle"] = "butt"
    return Line2D(x, y, color=ink(curve.ink), linestyle=line, linewidth=curve.width,
                  marker=curve.marker or "none", markersize=curve.size, zorder=3.0 - broad, **more)  # fmt: skip


def _draw_marks(axes: Axes, panel: Panel, layout: ChartLayout, number: int) -> None:
    """Lines across the panel; the names of uprights stand above it."""
    for mark in panel.marks:
        line = axes.axvline if mark.along == "x" else axes.axhline
        style: Any = "-" if mark.ink == "faint" else (0, (5, 2))
        line(mark.place, color=ink(mark.ink), linewidth=0.9, linestyle=style, zorder=1.4 if style == "-" else 2.0)
    for mark, row in zip(named_uprights(panel), layout.uprights[number], strict=True):
        left, right = layout.upright(number, mark.place, mark.name)
        box = (layout.width, layout.height)
        _above(axes, 0.5 * (left + right), row, mark.name, box, ha="center", color=ink(mark.ink))


def _above(axes: Axes, left: float, row: int, text: str, box: tuple[float, float], **style: Any) -> None:  # noqa: ANN401
    """Words in a row above the axes, from ``left``, in; ``box`` is the size of the axes, in."""
    place = 1.0 + (0.4 * labels.LINE + row * labels.LINE) / box[1]
    axes.text(left / box[0], place, text, transform=axes.transAxes, va="bottom", **style)


def _draw_heads(axes: Axes, panel: Panel, layout: ChartLayout, number: int) -> None:
    """The key above the names of the uprights, the title on top."""
    first, box = max(layout.uprights[number], default=-1) + 1, (layout.width, layout.height)
    _draw_key(axes, layout.keys[number], first, box)
    if panel.title:
        _above(axes, 0.0, first + len(layout.keys[number]), panel.title, box, weight="bold")


def _draw_key(axes: Axes, key: Sequence[Sequence[Curve | Hatch]], first: int, box: tuple[float, float]) -> None:
    """Rows of names with their samples above axes of this size, in, the last in row ``first``."""
    wide = max((key_width(entry) for row in key for entry in row), default=0.0)
    for row, entries in enumerate(key[::-1], start=first):
        middle = 1.0 + (0.85 + row) * labels.LINE / box[1]
        for left, entry in zip(wide * np.arange(len(entries)), entries, strict=True):
            ends = np.array([left, left + SAMPLE - 0.06]) / box[0]
            if isinstance(entry, Hatch):
                half = 0.35 * labels.LINE / box[1]
                surfaces.hatched(axes, (ends[0], middle - half, ends[1] - ends[0], 2.0 * half), axes.transAxes)
            else:
                ends[1] -= 1.5 * (entry.size - Curve.size) / 72.0 / box[0]
                sample = _line(entry, ends, [middle] * 2, transform=axes.transAxes, clip_on=False, markevery=[1])
                axes.add_artist(sample)
            _above(axes, left + SAMPLE, row, entry.name, box)


def _head(chart: Chart, width: float) -> tuple[list[tuple[str, str]], list[list[Curve | Hatch]]]:
    """The lines above all panels with their weights and the rows of their key, in a chart so many inches wide."""
    room = width - 2.0 * EDGE
    weights = ("bold", *("normal",) * len(chart.head))
    pairs = zip(chart.head, weights, strict=False)
    lines = [(line, weight) for text, weight in pairs for line in labels.fitting(text, room).splitlines()]
    return lines, in_rows(chart.key, room) if chart.key else []


def head_room(chart: Chart, width: float) -> float:
    """Height of what stands above all panels, in."""
    lines, key = _head(chart, width)
    rows = len(lines) + len(key)
    return EDGE + labels.LINE * (0.4 + rows) if rows else 0.0


def draw_head(found: Figure, chart: Chart, corner: tuple[float, float], width: float) -> None:
    """Draw what stands above all panels into a part of a figure: its lower left corner and its width, in."""
    lines, key = _head(chart, width)
    if not lines and not key:
        return
    (wide, high), box = found.get_size_inches(), (width - 2.0 * EDGE, 1.0)
    axes = found.add_axes(((corner[0] + EDGE) / wide, (corner[1] - 1.0) / high, box[0] / wide, 1.0 / high))
    axes.set_axis_off()
    _draw_key(axes, key, 0, box)
    for row, (line, weight) in enumerate(lines[::-1], start=len(key)):
        _above(axes, 0.0, row, line, box, weight=weight)
