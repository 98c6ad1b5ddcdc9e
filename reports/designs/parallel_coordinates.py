"""Parallel coordinates: a line per design through an axis per parameter and figure, coloured by the first figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reports.charts import draw, labels, scales
from reports.charts.scales import FULL_WIDTH, INK, SHADES, ink
from reports.charts.scheme import BEHIND
from reports.designs.drawn_designs import FAILS, OWN, DrawnDesigns
from reports.document.chart import Curve

Array = NDArray[np.float64]

APART, HIGH, TICKS = 1.7, 4.8, 6  # in, between axes at least, of the figure; ticks of an axis
THIN = 0.6  # points, of a line among many
NOWHERE = np.zeros(0)


@dataclass(frozen=True)
class Lines:
    """Designs as lines: where they cross the axes, (lines, axes) from 0 to 1, nan beyond where they end.

    ``names`` are those of the axes and ``ends`` (axes, 2) their limits. The axes of the ``parameters`` come first, then
    those of the figures, of which the first gives the colour; ``best`` is the line of the best design.
    """

    names: tuple[str, ...]
    ends: Array
    heights: Array
    parameters: int
    best: int | None


def parallel_figure(designs: DrawnDesigns) -> Figure:
    """The parameters, then the figures; designs that do not assemble end behind the parameters."""
    names = (*designs.parameters, *designs.figures)
    values = np.stack([designs.values(name) for name in names], axis=1)
    spans = [designs.span(name) if name in designs.figures else None for name in names]
    ends = np.array([_ends(values[:, n] if numbers is None else np.array(numbers)) for n, numbers in enumerate(spans)])
    low, size = ends[:, 0], np.ptp(ends, axis=1)
    labelled = tuple(designs.label(name) for name in names)
    lines = Lines(labelled, ends, (values - low) / size, len(designs.parameters), designs.best(designs.figures[0]))
    first = f"{designs.figures[0]}: {designs.target(designs.figures[0])[1]}"
    key = [Curve(NOWHERE, NOWHERE, first, "limit", width=2.0)] if lines.best is not None else []
    key += [Curve(NOWHERE, NOWHERE, OWN, "ink", line="", marker="D", size=5.0)] if designs.own_place else []
    fails = any(map(designs.failing, designs.figures))
    key += [Curve(NOWHERE, NOWHERE, FAILS, "reference", width=0.8)] if fails else []
    own = [(place - start) / wide for place, start, wide in zip(designs.own_place, low, size, strict=False)]

    def draw_all(figure: Figure) -> None:
        _draw(draw.head(figure, designs.head, key), lines, own)

    return draw.drawn(max(FULL_WIDTH, APART * len(names)), HIGH, draw_all)


def _ends(values: Array) -> tuple[float, float]:
    """The least and the largest value, apart."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    room = 0.1 * (abs(low) or 1.0) if low == high else 0.0
    return low - room, high + room


def _draw(host: draw.Host, lines: Lines, own: Sequence[float]) -> None:
    """Draw the lines, the axes, and the file's own design as diamonds."""
    axes = host.subplots()
    axes.set_label("parallel")
    axes.set(xlim=(-0.5, len(lines.names) - 0.5), ylim=(0.0, 1.0), autoscale_on=False, xticks=[], yticks=[])
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    _draw_lines(axes, lines)
    _draw_ramp(axes, lines.parameters)
    axes.plot(range(len(own)), own, color=INK, linestyle="", marker="D", markersize=5.0, zorder=7.0, clip_on=False)
    for number, (ends, name) in enumerate(zip(lines.ends, lines.names, strict=True)):
        _draw_scale(axes, number, ends, name)


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


def _draw_lines(axes: Axes, lines: Lines) -> None:
    """Draw lines that end early, then shade by shade, the smallest figures on top, the best design above all."""
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
