"""Parallel coordinates: a line per design through an axis per parameter and figure, coloured by the first figure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reports.charts import draw, labels, scales
from reports.charts.scales import Scale
from reports.charts.scheme import BEHIND
from reports.charts.style import FULL_WIDTH, INK, MUTED, SHADES, drawn, ink
from reports.designs.sweep.drawn_designs import FAILS, OWN, DrawnDesigns
from reports.document.chart import Chart, Curve

Array = NDArray[np.float64]

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


def parallel_figure(designs: DrawnDesigns) -> Figure:
    """The parameters, then the figures; designs that do not assemble end behind the parameters."""
    names = (*designs.parameters, *designs.figures)
    values = np.stack([designs.values(name) for name in names], axis=1)
    spans = [np.array(designs.span(name) or _ends(values[:, column])) if name in designs.figures
             else _ends(values[:, column]) for column, name in enumerate(names)]  # fmt: skip
    axes = [scales.tight(span, designs.label(name), TICKS) for span, name in zip(spans, names, strict=True)]
    low, high = (np.array([getattr(axis, end) for axis in axes]) for end in ("low", "high"))
    lines = Lines(tuple(axes), (values - low) / (high - low), len(designs.parameters), designs.best(designs.figures[0]))
    first = f"{designs.figures[0]}: {designs.target(designs.figures[0])[1]}"
    key = [Curve(NOWHERE, NOWHERE, first, "limit", width=2.0)] if lines.best is not None else []
    key += [Curve(NOWHERE, NOWHERE, OWN, "ink", line="", marker="D", size=5.0)] if designs.own_place else []
    fails = any(map(designs.failing, designs.figures))
    key += [Curve(NOWHERE, NOWHERE, FAILS, "reference", width=0.8)] if fails else []
    about = Chart((), head=designs.head, key=tuple(key))
    words = [labels.fitting_label(axis.label, APART - 0.1) for axis in axes]
    width = max(FULL_WIDTH, APART * len(words))
    height = draw.head_room(about, width) + labels.LINE * max(map(labels.lines, words)) + 0.1 + HIGH + EDGE
    return drawn(width, height, partial(_draw, about=about, names=words, lines=lines, own=designs.own_place))


def _ends(values: Array) -> Array:
    return np.array([np.nanmin(values), np.nanmax(values)]) if np.any(np.isfinite(values)) else np.full(2, np.nan)


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
