"""Parallel coordinates: a line per design through an axis per parameter and figure, coloured by the first figure."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.charts import draw, labels, scales
from reports.charts.scales import FULL_WIDTH, INK, SHADES, ink
from reports.charts.scheme import BEHIND
from reports.designs.drawn_designs import FAILS, OWN, DrawnDesigns
from reports.document.chart import Array, Curve

APART, HIGH, TICKS = 1.7, 4.8, 6  # in, between axes at least, of the figure; ticks of an axis
THIN = 0.6  # points, of a line among many


def parallel_figure(designs: DrawnDesigns) -> Figure:
    """The parameters, then the figures, the first of which gives the colour.

    Designs that do not assemble end behind the parameters; that of the file is drawn as diamonds.
    """
    names = (*designs.parameters, *designs.figures)
    values = np.stack([designs.values(name) for name in names], axis=1)
    spans = [designs.span(name) if name in designs.figures else None for name in names]
    ends = np.array([_ends(values[:, n] if numbers is None else np.array(numbers)) for n, numbers in enumerate(spans)])
    low, size = ends[:, 0], np.ptp(ends, axis=1)
    best, count = designs.best(designs.figures[0]), len(designs.parameters)
    first = f"{designs.figures[0]}: {designs.target(designs.figures[0])[1]}"
    key = [Curve(name=first, ink="limit", width=2.0)] if best is not None else []
    key += [Curve(name=OWN, ink="ink", line="", marker="D", size=5.0)] if designs.own_place else []
    fails = any(map(designs.failing, designs.figures))
    key += [Curve(name=FAILS, ink="reference", width=0.8)] if fails else []
    own = [(place - start) / wide for place, start, wide in zip(designs.own_place, low, size, strict=False)]

    def draw_all(figure: Figure) -> None:
        axes = _empty_axes(draw.head(figure, designs.head, key), len(names))
        _draw_lines(axes, (values - low) / size, count, best)
        _draw_ramp(axes, count)
        axes.plot(range(len(own)), own, color=INK, linestyle="", marker="D", markersize=5.0, zorder=7.0, clip_on=False)
        for number, name in enumerate(names):
            _draw_scale(axes, number, ends[number], designs.label(name))

    return draw.drawn(max(FULL_WIDTH, APART * len(names)), HIGH, draw_all)


def _ends(values: Array) -> tuple[float, float]:
    """The least and the largest value, apart."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    room = 0.1 * (abs(low) or 1.0) if low == high else 0.0
    return low - room, high + room


def _empty_axes(host: draw.Host, count: int) -> Axes:
    """Axes without scales of their own, in which so many scales stand upright, from 0 to 1."""
    axes = host.subplots()
    axes.set_label("parallel")
    axes.set(xlim=(-0.5, count - 0.5), ylim=(0.0, 1.0), autoscale_on=False, xticks=[], yticks=[])
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    return axes


def _draw_scale(axes: Axes, number: int, ends: Array, name: str) -> None:
    """The axis of a parameter or a figure, its label above it."""
    scale = axes.twinx()
    scale.set(ylim=ends, zorder=5.0)
    scale.grid(visible=False)
    scale.spines[:].set_visible(False)
    scale.spines["left"].set(visible=True, position=("data", number), color=INK)
    scale.yaxis.tick_left()
    scales.write_scale(scale.yaxis, name, TICKS)
    label = labels.wrap(scale.yaxis.get_label_text(), APART)
    scale.yaxis.label.set_visible(False)
    scale.text(number, 1.02, label, transform=axes.get_xaxis_transform(), ha="center", va="bottom")
    for word in scale.yaxis.get_ticklabels():
        word.set_bbox(BEHIND)


def _draw_ramp(axes: Axes, number: int) -> None:
    """The colours of the lines along the axis of the figure that gives them."""
    for shade in range(SHADES):
        ends = [shade / SHADES, (shade + 1) / SHADES]
        axes.plot([number] * 2, ends, color=ink(shade / (SHADES - 1)), linewidth=6.0, solid_capstyle="butt", zorder=5.0)


def _draw_lines(axes: Axes, heights: Array, coloured: int, best: int | None) -> None:
    """Draw lines that end early, then shade by shade, the smallest figures on top, the best design above all.

    ``heights`` (lines, axes) are where lines cross the scales, nan beyond where they end; that of number ``coloured``
    gives the colour.
    """
    shades = np.round(np.clip(heights[:, coloured], 0.0, 1.0) * (SHADES - 1))
    _draw_shade(axes, heights[np.isnan(shades)], ink("reference"), 0.8)
    for shade in range(SHADES)[::-1]:
        _draw_shade(axes, heights[shades == shade], ink(shade / (SHADES - 1)), THIN)
    if best is not None:
        _draw_shade(axes, heights[[best]], ink("limit"), 2.0)


def _draw_shade(axes: Axes, heights: Array, colour: str, width: float) -> None:
    """Lines (lines, axes) of one colour, as one."""
    if len(heights):
        broken = np.pad(heights, ((0, 0), (0, 1)), constant_values=np.nan)
        places = np.tile(np.arange(broken.shape[1], dtype=float), len(broken))
        axes.plot(
            places, broken.ravel(), color=colour, linewidth=width, alpha=0.7 if width == THIN else 1.0, zorder=3.0
        )
