"""Error over cost, a panel for each mechanism: every method's sweep thin, each engine's front bold, settings marked.

Single runs are solid, runs that are made of several dashed.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter

from comparisons.runs.files import write_file
from comparisons.work_precision.analysis import apart, on_front
from comparisons.work_precision.records import SETTING, Bench, BenchRecord
from reports.charts.style import (
    DOTS_PER_INCH,
    FULL_WIDTH,
    INK,
    MUTED,
    REFERENCE,
    colour,
    decades,
    drawn,
    label_ends,
)
from reports.work_precision.facts import EngineFacts, PlaceFacts, engine_label, engine_labels
from reports.work_precision.words import KINDS

ACROSS, PANEL, FRAME = 3, 2.45, 0.45
# Nothing below round-off is worth a decade, and nothing ten times as large as its own peak one more.
LEAST, MOST = 1e-16, 10.0
MARKS = {"naive": ("o", 5.0), "tuned": ("s", 5.2), "best": ("*", 9.0)}
LINES: tuple[Any, Any] = ("-", (0, (2.6, 1.3)))  # of single runs, and of several extrapolated
BROAD: tuple[Any, Any] = ("-", (0, (0.9, 0.4)))  # the same of broad lines: dashes count in widths


def inks(bench: Bench) -> dict[str, str]:
    """The colours of all engines of a benchmark: by name order, as in all of a report, and the control's muted."""
    labels = engine_labels(bench)
    return {name: colour(name, sorted(labels)) if label == name else MUTED for name, label in labels.items()}


def bench_figure(places: Sequence[PlaceFacts], colours: Mapping[str, str], quantity: str = "") -> Figure:
    """Work-precision of one regime over its mechanisms, in ``quantity`` or in the one each is judged by."""
    cells = len(places) + 1  # the last one is the key
    across = min(ACROSS, cells)
    down = math.ceil(cells / across)
    width, height = FULL_WIDTH * across / ACROSS, PANEL * down + FRAME

    def draw(drawing: Figure) -> None:
        grid = drawing.subplots(down, across, squeeze=False)
        sides = {"left": 0.6 / width, "right": 1.0 - 0.75 / width}
        drawing.subplots_adjust(**sides, top=1.0 - 0.28 / height, bottom=0.46 / height, wspace=0.52, hspace=0.42)
        panels = [axes for row in grid for axes in row]
        for axes, place in zip(panels, places, strict=False):
            draw_place(axes, place, colours, quantity or place.foremost)
        for axes in panels[len(places) :]:
            axes.axis("off")
        for row in grid:
            row[0].set_ylabel("largest |error| / peak")
        _key(panels[len(places)], places, colours)

    return drawn(width, height, draw)


def save_figure(drawing: Figure, path: Path) -> None:
    """Write a figure beside a page as PATH.svg and PATH.png, the same bytes for the same figure."""
    with matplotlib.rc_context({"font.family": "DejaVu Sans", "svg.hashsalt": "linkproof", "text.parse_math": False}):
        for form, told in (("svg", {"Date": None}), ("png", {"Software": None})):
            buffer = io.BytesIO()
            drawing.savefig(buffer, format=form, dpi=DOTS_PER_INCH, metadata=told)
            write_file(path.with_name(f"{path.name}.{form}"), partial(Path.write_bytes, data=buffer.getvalue()))


def draw_place(axes: Axes, place: PlaceFacts, colours: Mapping[str, str], quantity: str) -> None:
    """One mechanism's panel."""
    facts = [one for one in place.engines(quantity) if any(record.finished for record in one.records)]
    for records, style in zip(apart(place.ranked(quantity)), BROAD, strict=True):
        _staircase(axes, on_front(records), style)
    for one in facts:
        _draw_engine(axes, one, colours[one.engine])
    axes.set_title(f"{place.mechanism}: {quantity.replace('_', ' ')}")
    _scales(axes, [record for one in facts for record in one.records if record.finished])
    lowest = [(min(map(drawn_error, on_front(one.records))), one) for one in facts]
    label_ends(axes, [(y, "control" if one.is_control else one.engine, colours[one.engine]) for y, one in lowest])


def _draw_engine(axes: Axes, facts: EngineFacts, ink: str) -> None:
    for sweep in facts.methods:
        points = sweep.points
        axes.plot(points.seconds, [max(one, LEAST) for one in points.errors], color=ink, linewidth=0.6, alpha=0.5,
                  linestyle=LINES[points.first.is_extrapolated], marker=".", markersize=2.2, zorder=2.0)  # fmt: skip
    for records, style in zip(apart(facts.records), LINES, strict=True):
        line = [(_seconds(one), drawn_error(one)) for one in on_front(records)]
        if line:
            axes.plot(*zip(*line, strict=True), color=ink, linewidth=1.9, linestyle=style, solid_joinstyle="round",
                      zorder=3.0)  # fmt: skip
    for record in facts.records:
        if record.kind == SETTING and record.finished:
            mark, size = MARKS.get(record.setting, ("D", 4.5))
            axes.plot(_seconds(record), drawn_error(record), marker=mark, markersize=size, color=ink, zorder=4.0,
                      markerfacecolor="white" if record.setting == "naive" else ink,
                      markeredgecolor=ink if record.setting == "naive" else INK,
                      markeredgewidth=1.3 if record.setting == "naive" else 0.7, linestyle="none")  # fmt: skip


def _staircase(axes: Axes, front: Sequence[BenchRecord], style: Any) -> None:  # noqa: ANN401  matplotlib's own type
    """What no engine does better than, as a broad grey line."""
    if front:
        line = [(_seconds(one), drawn_error(one)) for one in front]
        axes.step(*zip(*line, strict=True), where="post", color=REFERENCE, linewidth=5.0, alpha=0.55, linestyle=style,
                  zorder=1.0, solid_capstyle="round", dash_capstyle="butt")  # fmt: skip


def _seconds(record: BenchRecord) -> float:
    return record.seconds_min or 0.0


def drawn_error(record: BenchRecord) -> float:
    """The largest error over the peak, at the least that a decade is worth."""
    return max(record.error_max or 0.0, LEAST)


def _scales(axes: Axes, records: Sequence[BenchRecord]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    errors = [min(drawn_error(one), MOST) for one in records] or [LEAST, 1.0]
    low, high = math.floor(math.log10(min(errors))), math.ceil(math.log10(max(errors)) + 0.05)
    axes.set_ylim(10.0 ** (low - 0.4), 10.0 ** (high + 0.2))
    decades(axes.yaxis, 6)
    decades(axes.xaxis, 8)
    axes.xaxis.set_major_formatter(EngFormatter("s"))
    axes.set_xlabel("stepping alone")


def _key(axes: Axes, places: Sequence[PlaceFacts], colours: Mapping[str, str]) -> None:
    """Engines by colour, single runs and extrapolated ones by line, settings by mark, in the empty cell."""
    ran = {r.engine: engine_label(r.engine, r.is_control) for p in places for r in p.records if r.finished}
    kinds = sorted({r.is_extrapolated for place in places for r in place.records if r.finished})
    settings = {r.setting for place in places for r in place.records if r.kind == SETTING and r.finished}
    handles = [
        *(Line2D([], [], color=ink, linewidth=1.9, label=f"{ran[name]}: its front")
          for name, ink in colours.items() if name in ran),
        *(Line2D([], [], color=INK, linewidth=1.9, linestyle=LINES[kind], label=KINDS[kind]) for kind in kinds),
        Line2D([], [], color=INK, linewidth=0.6, marker=".", markersize=3.0, label="a method over its steps"),
        *(Line2D([], [], linestyle="none", marker=mark, markersize=size, color=INK, markeredgecolor=INK,
                 markerfacecolor="white" if name == "naive" else INK, label=f"setting {name}")
          for name, (mark, size) in MARKS.items() if name in settings),
        Line2D([], [], color=REFERENCE, linewidth=5.0, alpha=0.55, label="the front over all engines"),
    ]  # fmt: skip
    axes.legend(handles=handles, loc="center left", handlelength=2.2, labelspacing=0.45, fontsize=8.5)
