"""Parallel coordinates: a line per design through an axis per parameter and figure, coloured by the first figure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import repeat

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reports.charts import draw, labels, scales
from reports.charts.scales import Scale
from reports.charts.scheme import BEHIND
from reports.charts.style import FULL_WIDTH, INK, MUTED, SHADES, drawn, ink
from reports.designs.sweep import thinning
from reports.designs.sweep.swept import FAILS, OWN, Swept, grouped
from reports.designs.sweep.thinning import Kept
from reports.document.chart import Chart, Curve

Array = NDArray[np.float64]

MOST = 2000  # lines
APART, HIGH, TICKS = 1.7, 3.6, 6  # in, between axes at least, their height; ticks of an axis
THIN = 0.6  # points, of a line among many
EDGE = 0.25  # in, below the axes
NOWHERE = np.zeros(0)


@dataclass(frozen=True)
class Lines:
    """Designs as lines: where they cross the axes, (lines, axes) from 0 to 1, nan beyond where they end.

    The axes of the ``parameters`` come first, then those of the figures, of which the first gives the colour; ``best``
    is the line of the best design.
    """

    axes: tuple[Scale, ...]
    heights: Array
    parameters: int
    best: int | None


def parallel_figure(swept: Swept) -> Figure:
    """The parameters, then the figures; designs that do not assemble end behind the parameters."""
    lines, kept, meaning = _lines(swept)
    note = (
        f"{grouped(MOST)} designs are drawn, chosen at random with seed 0; among them the best, and the least and the "
        "largest of every figure."
        if swept.count > MOST
        else ""
    )
    first = f"{swept.figures[0]}: {meaning}"
    key = [Curve(NOWHERE, NOWHERE, first, "limit", width=2.0)] if lines.best is not None else []
    key += [Curve(NOWHERE, NOWHERE, OWN, "ink", line="", marker="D", size=5.0)] if swept.own_place else []
    key += [Curve(NOWHERE, NOWHERE, FAILS, "reference", width=0.8)] if any(one.failing for one in kept) else []
    about = Chart((), head=swept.head(kept, note), key=tuple(key))
    names = [labels.fitting_label(axis.label, APART - 0.1) for axis in lines.axes]
    width = max(FULL_WIDTH, APART * len(names))
    room = labels.LINE * max(map(labels.lines, names)) + 0.1
    height = draw.head_room(about, width) + room + HIGH + EDGE
    return drawn(width, height, partial(_draw, about=about, names=names, lines=lines, own=swept.own_place))


def _lines(swept: Swept) -> tuple[Lines, list[Kept], str]:
    """The lines, what is kept of the figures, and in what the best one is best."""
    kept = {name: swept.keep(name) for name in swept.figures}
    names = (*swept.parameters, *swept.figures)
    spans = [*map(swept.ends, swept.parameters), *(np.array(one.span or one.extremes[:2]) for one in kept.values())]
    first = kept[swept.figures[0]]
    best = int(first.indices[2])
    always = {best} | {int(index) for one in kept.values() for index in one.indices[:2]}
    chosen = thinning.sample(swept.count, MOST, always - {-1})
    told = [swept.label(name, kept.get(name)) for name in names]
    axes = tuple(map(scales.tight, spans, told, repeat(TICKS)))
    heights = [
        (swept.pick(name, chosen) - axis.low) / (axis.high - axis.low) for name, axis in zip(names, axes, strict=True)
    ]
    line = None if best < 0 else int(np.searchsorted(chosen, best))
    whole = Lines(axes, np.stack(heights, axis=1), len(swept.parameters), line)
    return whole, list(kept.values()), swept.target(swept.figures[0])[1]


def _draw(figure: Figure, about: Chart, names: list[str], lines: Lines, own: tuple[float, ...]) -> None:
    width, height = map(float, figure.get_size_inches())
    axes = figure.add_axes((0.0, EDGE / height, 1.0, HIGH / height))
    axes.set_axis_off()
    axes.set(xlim=(-0.5, len(names) - 0.5), ylim=(0.0, 1.0), autoscale_on=False)
    _draw_lines(axes, lines)
    for number, (scale, name) in enumerate(zip(lines.axes, names, strict=True)):
        axes.plot([number] * 2, [0.0, 1.0], color=INK, linewidth=1.0, zorder=5.0)
        if number == lines.parameters:
            _draw_ramp(axes, number)
        for tick, word in zip(scale.ticks, scale.words, strict=True):
            place, stroke = scale.share(tick), 0.04 * len(names) / width
            axes.plot([number - stroke, number], [place] * 2, color=MUTED, linewidth=0.8, zorder=5.0)
            axes.text(number - 1.5 * stroke, place, word, ha="right", va="center", bbox=BEHIND, zorder=6.0)
        axes.text(number, 1.0 + 0.08 / HIGH, name, ha="center", va="bottom")
    for number, (place, scale) in enumerate(zip(own, lines.axes, strict=False)):
        axes.plot([number], [scale.share(place)], color=INK, marker="D", markersize=5.0, zorder=7.0, clip_on=False)
    draw.draw_head(figure, about, (0.0, height - draw.head_room(about, width)), width)


def _draw_ramp(axes: Axes, number: int) -> None:
    """The colours of the lines along the axis of the figure that gives them."""
    for shade in range(SHADES):
        ends = [shade / SHADES, (shade + 1) / SHADES]
        axes.plot([number] * 2, ends, color=ink(shade / (SHADES - 1)), linewidth=6.0, solid_capstyle="butt", zorder=5.0)


def _draw_lines(axes: Axes, lines: Lines) -> None:
    """Those that end first, then one shade after the other, the smallest figures on top, the best above all."""
    shades = np.round(np.clip(lines.heights[:, lines.parameters], 0.0, 1.0) * (SHADES - 1))
    _draw_shade(axes, lines.heights[np.isnan(shades)], ink("reference"), 0.8)
    for shade in range(SHADES)[::-1]:
        _draw_shade(axes, lines.heights[shades == shade], ink(shade / (SHADES - 1)), THIN)
    if lines.best is not None:
        _draw_shade(axes, lines.heights[[lines.best]], ink("limit"), 2.0)


def _draw_shade(axes: Axes, heights: Array, colour: str, width: float) -> None:
    """Lines (lines, axes) of one colour, as one."""
    if len(heights):
        broken = np.pad(heights, ((0, 0), (0, 1)), constant_values=np.nan)
        places = np.tile(np.arange(broken.shape[1], dtype=float), len(broken))
        axes.plot(
            places, broken.ravel(), color=colour, linewidth=width, alpha=0.7 if width == THIN else 1.0, zorder=3.0
        )
