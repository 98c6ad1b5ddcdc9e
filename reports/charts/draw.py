"""A chart as data drawn by matplotlib, and a figure's files: SVG that follows the reader's colours, PNG on white."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from reports.charts import labels, scales, surfaces
from reports.charts.scales import DARK, DOTS_PER_INCH, FULL_WIDTH, MUTED, STYLE, WIDTH, ink
from reports.document.chart import Array, Chart, Curve, Hatch, Ink, Panel

Host = Figure | SubFigure

PAPER_DOTS = 300  # to the inch
BAR = 3.0  # points, of lines that are bars
MOST = 8  # curves that are named in the key where there is no room for all at their ends
# Inches: beside and above the axes of a panel, left of a head, of a sample in a key, of a line of the head.
BESIDE, ABOVE, EDGE, SAMPLE, HEAD = 0.9, 0.5, 0.1, 0.55, 0.22
ACROSS, UPWARD, EQUAL, TURN = 0.75, 0.22, 0.42, 3.75  # in, from tick to tick at least; of a turn with all its sixths

_COORDINATES = re.compile(r'\b(?:d|x|y|x1|x2|y1|y2|width|height|transform|points)="[^"]*"')
_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_STYLE = re.compile(r"(<style[^>]*>)(.*?)(</style>)", re.DOTALL)


def figure(chart: Chart, width: float | None = None) -> Figure:
    """The chart, drawn in the page's width for it or in so many inches; higher where its names take all the room."""
    columns = max(min(chart.columns, len(chart.panels)), 1)
    room = chart.height * columns / max(len(chart.panels), 1) - ABOVE
    names = sum(max(0.0, labels.LINE * len(_key_curves(panel, room)) - 0.5 * room) for panel in chart.panels)
    height = chart.height * bool(chart.panels) + HEAD * (len(chart.head) + bool(chart.key)) + names / columns
    wide = width or (FULL_WIDTH if chart.wide else WIDTH)
    return drawn(wide, height, lambda quantity: place(quantity, chart), placed=bool(chart.panels))


def drawn(width: float, height: float, draw: Callable[[Figure], None], *, placed: bool = True) -> Figure:
    """A figure of so many inches, drawn in the house style; its parts are ``placed`` so that they do not touch."""
    with matplotlib.rc_context(fname=STYLE):
        quantity = Figure(figsize=(width, height), layout="constrained" if placed else None)
        draw(quantity)
        if engine := quantity.get_layout_engine():
            engine.execute(quantity)  # once, not for every file
            quantity.set_layout_engine("none")
        for axes in quantity.axes:
            labels.move_words_apart(axes)
    return quantity


def place(host: Host, chart: Chart) -> None:
    """Draw the chart into a figure or a part of one."""
    host = head(host, chart.head, chart.key)
    if not chart.panels:
        return
    columns = min(chart.columns, len(chart.panels))
    rows = -(-len(chart.panels) // columns)
    shared = chart.panels[0].scale != "equal" and not any(panel.rows for panel in chart.panels)
    heights = [len(panel.rows) + 1 for panel in chart.panels[::columns]]
    grid = host.subplots(rows, columns, squeeze=False, sharex="col" if shared else False, height_ratios=heights).ravel()
    size = inches(host) / (columns, rows) - (BESIDE, ABOVE)
    for axes, panel in zip(grid, chart.panels, strict=False):
        _draw_panel(axes, panel)
    for number, (axes, panel) in enumerate(zip(grid, chart.panels, strict=False)):
        _set_scales(axes, panel, size)
        _write_names(axes, panel, size)
        last = not shared or number + columns >= len(chart.panels)
        axes.tick_params(labelbottom=last)
        axes.xaxis.label.set_visible(last)
    for axes in grid[len(chart.panels) :]:
        axes.remove()


def inches(host: Host) -> Array:
    """Width and height of a figure or a part of one, in."""
    return np.array(host.bbox.size) / host.dpi


def head(host: Host, lines: Sequence[str], key: Sequence[Curve | Hatch] = ()) -> Host:
    """Write lines, the first in bold, and a key on top of a part of a figure; returns the part below them."""
    wide = inches(host)[0]
    for number, line in enumerate(lines):
        text = labels.wrap(line, wide - 2.0 * EDGE)
        host.suptitle(text, x=EDGE / wide, ha="left", fontsize="medium", weight="normal" if number else "bold")
        host = host.add_subfigure(host.add_gridspec()[0])
    if key:
        host.legend(loc="outside upper left", **_key(key, wide))
    return host


def is_wide(drawing: Figure) -> bool:
    """Whether a figure takes a page's whole width."""
    return drawing.get_figwidth() == FULL_WIDTH


def edges(quantity: Figure) -> tuple[float, float]:
    """Left and right end of the first axes, as shares of the width."""
    left, right = quantity.axes[0].get_position().intervalx
    return left, right


def svg(drawing: Figure, page: str = "none") -> str:
    """The figure as an SVG file, the same for the same figure; a dark scheme of the reader's turns its colours.

    ``page`` is the colour behind it.
    """
    text = _saved(drawing, "svg", ("Date", "Creator", "Format", "Type"), facecolor=page).decode("utf-8")
    text = _COORDINATES.sub(lambda match: _LONG_NUMBER.sub(r"\1", match[0]), text)
    dark = "" if page != "none" else f"@media (prefers-color-scheme: dark){{{_dark(text)}}}"
    return _STYLE.sub(lambda match: f"{match[1]}{match[2].strip()}{dark}{match[3]}", text, count=1)


def png(drawing: Figure, dots: int = DOTS_PER_INCH) -> bytes:
    """The figure as a PNG file on white, for papers, so many dots to the inch."""
    return _saved(drawing, "png", ("Software",), facecolor="white", dpi=dots)


def pdf(drawing: Figure) -> bytes:
    """The figure as a PDF file on white, for papers: lines as lines, its fonts within it."""
    return _saved(drawing, "pdf", ("CreationDate", "Creator", "Producer"), facecolor="white")


def picture(drawing: Figure, kind: str) -> str | bytes:
    """The figure on white as a file of a ``kind``, svg, png or pdf, for papers."""
    if kind == "svg":
        return svg(drawing, page="white")
    return pdf(drawing) if kind == "pdf" else png(drawing, PAPER_DOTS)


def _saved(drawing: Figure, kind: str, left_out: Sequence[str], **more: Any) -> bytes:  # noqa: ANN401
    """A figure as a file of a kind, without the metadata ``left_out``, which change from one time to the next."""
    buffer = io.BytesIO()
    with matplotlib.rc_context(fname=STYLE):
        drawing.savefig(buffer, format=kind, metadata=dict.fromkeys(left_out), **more)
    return buffer.getvalue()


def _dark(text: str) -> str:
    """Rules that turn the colours a drawing has."""
    return "".join(
        f'[style*="{what}: {light}"],[{what}="{light}"]{{{what}:{dark}!important}}'
        for light, dark in DARK.items()
        for what in ("fill", "stroke")
        if re.search(f'{what}(: |="){light}', text)
    )


def _draw_panel(axes: Axes, panel: Panel) -> None:
    """Draw a panel, but for its words."""
    axes.set_xscale("log" if panel.scale in ("logx", "loglog") else "linear")
    axes.set_yscale("log" if panel.scale in ("log", "loglog") else "linear")
    for low, high in panel.hatch.stretches if panel.hatch else ():
        surfaces.hatch(axes, low, high)
    if panel.surface:
        surfaces.draw_surface(axes, panel.surface, panel.span)
    _draw_curves(axes, panel)


def _write_names(axes: Axes, panel: Panel, size: Array) -> None:
    """Names of curves at their ends or in a key, of marks and notes, the title.

    The axes are of about this ``size``, inches, and their limits are known.
    """
    key, title = _key_curves(panel, size[1]), labels.wrap(panel.title, size[0])
    ends = [(mark.place, mark.name, mark.ink) for mark in panel.marks if mark.along == "y"]
    ends += _end_names(panel) if panel.names == "ends" and not key else []
    low, high = sorted(axes.get_ylim())
    for height, name, colour in ends:
        labels.write(axes, (1.0, min(max(height, low), high)), name, labels.END, ink(colour))
    uprights = [mark for mark in panel.marks if mark.along == "x" and mark.name]
    for mark in uprights:
        labels.write(axes, (mark.place, 1.0), mark.name, labels.UPRIGHT, ink(mark.ink))
    for note in panel.notes:
        labels.write(axes, (note.x, note.y), note.text, labels.NOTE)
    if key:
        axes.legend(**_key(key, size[0]), loc="lower left", bbox_to_anchor=(0.0, 1.0), title=title or None)
    else:
        axes.set_title(title, weight="bold", pad=labels.GAP + 72.0 * labels.LINE * bool(uprights))


def _set_scales(axes: Axes, panel: Panel, size: Array) -> None:
    """Limits, ticks, labels, lines at zero."""
    equal = panel.scale == "equal"
    scales.set_limits(axes, panel)
    ticks = np.maximum(size / ((EQUAL, EQUAL) if equal else (ACROSS, UPWARD)), 2.0).astype(int)
    scales.write_scale(axes.xaxis, panel.x_label, ticks[0])
    scales.write_scale(axes.yaxis, panel.y_label, ticks[1])
    if panel.turn:
        axes.xaxis.set_major_locator(MultipleLocator(60.0 if size[0] > TURN else 120.0))
    if panel.rows:
        axes.set_yticks(range(len(panel.rows)), panel.rows)
    elif axes.get_ylim()[0] < 0.0 < axes.get_ylim()[1]:
        axes.axhline(0.0, color=MUTED, linewidth=0.6, zorder=1.5)
    if equal:
        axes.axvline(0.0, color=MUTED, linewidth=0.6, zorder=1.5)
        axes.set_aspect("equal", adjustable="datalim")


def _draw_curves(axes: Axes, panel: Panel) -> None:
    """Curves, each on the one before it where they are stacked, and lines across the panel."""
    below: Array = np.zeros(1)
    for curve in panel.curves:
        if curve.stacked:
            axes.fill_between(curve.x, below, curve.y, color=ink(curve.ink), alpha=0.75, linewidth=0.0)
            below = curve.y
        axes.add_line(_line(curve))
    for mark in panel.marks:
        line = axes.axvline if mark.along == "x" else axes.axhline
        style: Any = "-" if mark.ink == "faint" else (0, (5, 2))
        line(mark.place, color=ink(mark.ink), linewidth=0.9, linestyle=style, zorder=2.0)
    y = scales.NOTED if panel.notes else scales.MARGIN
    axes.margins(0.5 * y if panel.scale == "equal" else 0.0 if any(entry.line for entry in panel.curves) else y, y)
    axes.autoscale_view()


def _end_names(panel: Panel) -> list[tuple[float, str, Ink]]:
    """Where curves end with their names and colours; of a stacked one half-way down to the one below."""
    rows, below = [], 0.0
    for curve in panel.curves:
        end = float(next((value for value in curve.y[::-1] if np.isfinite(value)), 0.0))
        rows.append((0.5 * (end + below) if curve.stacked else end, curve.name, curve.ink))
        below = end
    return rows


def _line(curve: Curve) -> Line2D:
    """A curve as matplotlib's line."""
    line: Any = curve.line or "none"
    return Line2D(curve.x, curve.y, color=ink(curve.ink), linestyle=line, linewidth=curve.width,
                  marker=curve.marker or "none", markersize=curve.size, clip_on=not curve.marker,
                  solid_capstyle="butt" if curve.width >= BAR else "projecting",
                  zorder=2.0 if curve.ink == "reference" else 3.0)  # fmt: skip


def _key_curves(panel: Panel, tall: float) -> list[Curve]:
    """Curves whose names stand above the panel: as requested, or where there are too many for their ends."""
    named = list({curve.name: curve for curve in panel.curves if curve.name}.values())
    if panel.names == "key":
        return named
    lines = [line for curve in named for line in labels.wrap(curve.name).splitlines()]
    if panel.names != "ends" or labels.LINE * len(lines) <= tall:
        return []
    below = [curve.y if curve.stacked else np.zeros(1) for curve in named]
    sizes = [float(np.nanmax(np.abs(curve.y - y))) for curve, y in zip(named, [np.zeros(1), *below[:-1]], strict=True)]
    largest = [named[n] for n in sorted(np.argsort(sizes)[-MOST:])]
    rest = len(named) - len(largest)
    return [*largest, *[Curve(name=f"and {rest} more", line="")][:rest]]


def _key(key: Sequence[Curve | Hatch], room: float) -> dict[str, Any]:
    """A key in as many columns as so many inches have room for."""
    names = [labels.wrap(entry.name, room - SAMPLE) for entry in key]
    return {
        "handles": [surfaces.sample() if isinstance(entry, Hatch) else _line(entry) for entry in key],
        "labels": names,
        "ncols": max(1, int(room / (SAMPLE + max(map(labels.width, names))))),
        "alignment": "left",
        "title_fontproperties": {"weight": "bold"},
    }
