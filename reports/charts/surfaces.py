"""Surfaces over two parameters as colours: an image of their cells, contour lines with their values, a colour bar."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.patches import Patch

from reports.charts import scales
from reports.charts.scales import FONT_SIZE, PLATE, REFERENCE
from reports.document.chart import Surface

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


def sample() -> Patch:
    """The entry of a key for a hatched area."""
    return Patch(**HATCHED)
