"""A chart as data drawn by matplotlib, and a figure's files: SVG that follows the reader's colours, PNG on white."""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure, SubFigure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.textpath import text_to_path
from matplotlib.ticker import MultipleLocator
from matplotlib.transforms import Bbox

from reports.charts import scales
from reports.charts.scales import (
    DARK,
    DOTS_PER_INCH,
    FONT,
    FONT_SIZE,
    FULL_WIDTH,
    INK,
    MUTED,
    PLATE,
    REFERENCE,
    STYLE,
    WIDTH,
    ink,
)
from reports.document.chart import Array, Chart, Curve, Hatch, Ink, Panel, Surface

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
    names = sum(max(0.0, LINE * len(_key_curves(panel, room)) - 0.5 * room) for panel in chart.panels)
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
            move_words_apart(axes)
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
        text = wrap(line, wide - 2.0 * EDGE)
        host.suptitle(text, x=EDGE / wide, ha="left", fontsize="medium", weight="normal" if number else "bold")
        host = host.add_subfigure(host.add_gridspec()[0])
    if key:
        host.legend(loc="outside upper left", **_key(key, wide))
    return host


def is_wide(drawing: Figure) -> bool:
    """Whether a figure takes a page's whole width."""
    return drawing.get_figwidth() == FULL_WIDTH


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
    axes.set_xscale("log" if panel.scale == "logx" else "linear")
    axes.set_yscale("log" if panel.scale == "log" else "linear")
    for low, high in panel.hatch.stretches if panel.hatch else ():
        hatch(axes, low, high)
    if panel.surface:
        draw_surface(axes, panel.surface, panel.span)
    _draw_curves(axes, panel)


def _write_names(axes: Axes, panel: Panel, size: Array) -> None:
    """Names of curves at their ends or in a key, of marks and notes, the title.

    The axes are of about this ``size``, inches, and their limits are known.
    """
    key, title = _key_curves(panel, size[1]), wrap(panel.title, size[0])
    ends = [(mark.place, mark.name, mark.ink) for mark in panel.marks if mark.along == "y"]
    ends += _end_names(panel) if panel.names == "ends" and not key else []
    low, high = sorted(axes.get_ylim())
    for height, name, colour in ends:
        write_words(axes, (1.0, min(max(height, low), high)), name, END, ink(colour))
    uprights = [mark for mark in panel.marks if mark.along == "x" and mark.name]
    for mark in uprights:
        write_words(axes, (mark.place, 1.0), mark.name, UPRIGHT, ink(mark.ink))
    for note in panel.notes:
        write_words(axes, (note.x, note.y), note.text, NOTE)
    if key:
        axes.legend(**_key(key, size[0]), loc="lower left", bbox_to_anchor=(0.0, 1.0), title=title or None)
    else:
        axes.set_title(title, weight="bold", pad=GAP + 72.0 * LINE * bool(uprights))


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
    lines = [line for curve in named for line in wrap(curve.name).splitlines()]
    if panel.names != "ends" or LINE * len(lines) <= tall:
        return []
    below = [curve.y if curve.stacked else np.zeros(1) for curve in named]
    sizes = [float(np.nanmax(np.abs(curve.y - y))) for curve, y in zip(named, [np.zeros(1), *below[:-1]], strict=True)]
    largest = [named[n] for n in sorted(np.argsort(sizes)[-MOST:])]
    rest = len(named) - len(largest)
    return [*largest, *[Curve(name=f"and {rest} more", line="")][:rest]]


def _key(key: Sequence[Curve | Hatch], room: float) -> dict[str, Any]:
    """A key in as many columns as so many inches have room for."""
    names = [wrap(entry.name, room - SAMPLE) for entry in key]
    return {
        "handles": [hatch_sample() if isinstance(entry, Hatch) else _line(entry) for entry in key],
        "labels": names,
        "ncols": max(1, int(room / (SAMPLE + max(map(text_width, names))))),
        "alignment": "left",
        "title_fontproperties": {"weight": "bold"},
    }


# Surfaces over two parameters as colours: an image of their cells, contour lines with their values, a colour bar.


TICKS = 8
# Lines and their words on darker and on brighter colours; as the image, they do not turn with the reader's scheme.
ON_DARK, ON_BRIGHT, MIDDLE = "#fefefe", "#101418", 0.55
CONTOURED = 120  # cells in one direction of contour lines
HATCHED: dict[str, Any] = {"facecolor": PLATE, "edgecolor": REFERENCE, "hatch": "////", "linewidth": 0.0}


def draw_surface(axes: Axes, surface: Surface, span: tuple[float, float] | None) -> None:
    """Draw a surface into axes, in colours over a span or all its values, and its colour bar beside them."""
    if not np.any(np.isfinite(surface.values)):
        return
    low, high = span or (None, None)
    image = axes.pcolorfast(surface.x, surface.y, surface.values, cmap="viridis", vmin=low, vmax=high, zorder=1.6)
    bar = axes.figure.colorbar(image, ax=axes, pad=0.02)
    scales.write_scale(bar.ax.yaxis, surface.label, TICKS)
    ticks = bar.ax.yaxis.get_majorticklocs().tolist()
    words = bar.ax.yaxis.get_major_formatter().format_ticks(ticks)
    _draw_contours(axes, surface, image, dict(zip(ticks, words, strict=True)))


def _draw_contours(axes: Axes, surface: Surface, image: ScalarMappable, words: dict[float, str]) -> None:
    """Lines at the ticks of the colour bar, through the middles of the cells."""
    rows, columns = (slice(None, None, -(-count // CONTOURED)) for count in surface.values.shape)
    x, y = 0.5 * (surface.x[1:] + surface.x[:-1])[columns], 0.5 * (surface.y[1:] + surface.y[:-1])[rows]
    values = np.ma.masked_invalid(surface.values[rows, columns])
    within = {tick: word for tick, word in words.items() if values.min() < tick < values.max()}
    if min(values.shape) < 2 or not within:
        return
    low, high = image.get_clim()
    colours = [ON_DARK if (tick - low) < MIDDLE * (high - low) else ON_BRIGHT for tick in within]
    drawn = axes.contour(x, y, values, levels=list(within), colors=colours, linewidths=0.8, zorder=1.7)
    axes.clabel(drawn, fmt=within, fontsize=FONT_SIZE, inline_spacing=2)


def hatch(axes: Axes, low: float, high: float) -> None:
    """Hatch the axes between two places of their x axis."""
    axes.axvspan(low, high, zorder=1.1, **HATCHED)


def hatch_sample() -> Patch:
    """The entry of a key for a hatched area."""
    return Patch(**HATCHED)


# Words in a chart that do not touch: names beside the ends of curves and above marks, notes at points.


LINE = FONT_SIZE * 1.2 / 72.0  # in, of one line of words
BEFORE_UNIT = re.compile(r"(?<=\d) (?=\S+$)")
LONGEST = 1.7  # in, of a name beside the axes before it goes on in a second line
# Where words may stand about a point, in halves of their size, the best first.
SHIFTS = np.array([(0, 1), (0, -1), (1, 0.4), (-1, 0.4), (1, -0.4), (-1, -0.4), (1, 1.6), (-1, 1.6), (0, 2.6)])
INSIDE_NAME, JOINT = re.compile(r"(?<=[.:])(?=[^\W\d])"), "\u2060"
BOLD = 1.12  # how much wider bold words are
GAP = 4.0  # points, between a curve's end or a note's point and its words
END, UPRIGHT, NOTE = "end", "upright", "note"  # places of words: beside an end of a curve, a vertical line, a point


@cache
def text_width(text: str) -> float:
    """Width of the longest line of a text, in."""
    prop = FontProperties(family=FONT, size=FONT_SIZE)
    sizes = [text_to_path.get_text_width_height_descent(name, prop, ismath=False) for name in text.splitlines()]
    return max((size[0] for size in sizes), default=0.0) / 72.0


def wrap(text: str, room: float = LONGEST) -> str:
    """A text in lines of so many inches at most, however bold; a name may also break behind a point or a colon."""
    longest = max(int(len(text) * room / (BOLD * text_width(text) or 1.0)), 1)
    joined = INSIDE_NAME.sub(f"{JOINT} ", BEFORE_UNIT.sub("\u00a0", text))
    return "\n".join(textwrap.wrap(joined, longest, break_long_words=False)).replace(f"{JOINT} ", "").replace(JOINT, "")


def spread(places: Sequence[float], sizes: Sequence[float], room: float) -> Array:
    """Increasing places moved as little as needed for words of these sizes not to touch, from 0 to ``room``."""
    tall = np.asarray(sizes)
    offsets = np.cumsum([0.0, *(0.5 * (tall[1:] + tall[:-1]))])[: len(tall)]
    free = np.clip(np.asarray(places) - offsets, 0.0, max(room - float(max(offsets, default=0.0)), 0.0))
    up, down = np.maximum.accumulate(free), np.minimum.accumulate(free[::-1])[::-1]
    return np.asarray(0.5 * (up + down) + offsets)


def write_words(axes: Axes, place: tuple[float, float], name: str, kind: str, colour: str = INK) -> None:
    """Words at the right of a height (``END``), above a place of the x axis (``UPRIGHT``) or at a point (``NOTE``)."""
    if not name:
        return
    coordinates = {END: axes.get_yaxis_transform(), UPRIGHT: axes.get_xaxis_transform(), NOTE: axes.transData}[kind]
    beside, across, up = ((GAP, 0.0), "left", "center") if kind == END else ((0.0, GAP), "center", "bottom")
    axes.annotate(wrap(name), place, beside, coordinates, "offset points", color=colour, annotation_clip=False,
                  label=kind, ha=across, va="center" if kind == NOTE else up)  # fmt: skip


def move_words_apart(axes: Axes) -> None:
    """Move the words of axes apart; called once the layout has placed the axes."""
    words = {kind: [label for label in axes.texts if label.get_label() == kind] for kind in (END, UPRIGHT, NOTE)}
    _move_apart(axes, words[UPRIGHT], 0)
    _move_apart(axes, words[END], 1)
    _place_notes(axes, words[NOTE])


def _move_apart(axes: Axes, names: list[Any], way: int) -> None:
    """Names beside the axes, apart in x (``way`` 0) or y."""
    start, dots = axes.bbox.min[way], axes.figure.dpi / 72.0
    anchors = {name: name.xycoords.transform(name.xy)[way] - start for name in names}
    order = sorted(names, key=lambda name: anchors[name])
    sizes = [name.get_window_extent().size[way] + dots for name in order]
    places = spread([anchors[name] for name in order], sizes, axes.bbox.size[way])
    for name, place in zip(order, places, strict=True):
        shift = np.array(name.xyann)
        shift[way] = (place - anchors[name]) / dots
        name.set_position(shift)


def _place_notes(axes: Axes, notes: list[Any]) -> None:
    """Words about points, where they hide no other and as little of the curves as can be."""
    dots, taken = axes.figure.dpi / 72.0, [Bbox.null()]
    spots = np.concatenate([np.zeros((0, 2)), *(axes.transData.transform(line.get_xydata()) for line in axes.lines)])
    for note in notes:
        point, half = axes.transData.transform(note.xy), 0.5 * note.get_window_extent().size
        outward = (1.0, 1.0 if point[1] > np.mean(axes.bbox.intervaly) else -1.0)
        places = point + SHIFTS * outward * (half + GAP * dots)
        areas = [Bbox([place - half, place + half]).padded(dots) for place in places]
        costs = [
            3.0 * n + 1e6 * area.count_overlaps(taken) - 1e3 * axes.bbox.count_contains(area.corners())
            + area.count_contains(spots)
            for n, area in enumerate(areas)
        ]  # fmt: skip
        best = int(np.argmin(costs))
        taken.append(areas[best])
        note.set_position((places[best] - point) / dots)
