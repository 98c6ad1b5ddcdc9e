"""Surfaces over two parameters as colours: an image of their cells, contour lines with their values, a colour bar."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.transforms import Transform
from numpy.typing import NDArray

from reports.charts import labels, scales
from reports.charts.scales import Scale
from reports.charts.style import FONT_SIZE, PLATE, REFERENCE
from reports.document.chart import Surface

Array = NDArray[np.float64]

COLOURS, HATCH = "viridis", "////"  # grows evenly to the eye
APART, BAR = 0.1, 0.13  # in, between a panel and its colour bar, of the bar
TICKS = 8
# Lines and their words on darker and on brighter colours; as the image, they do not turn with the reader's scheme.
ON_DARK, ON_BRIGHT, MIDDLE = "#fefefe", "#101418", 0.55
PIXELS, CONTOURED = 400, 120  # cells in one direction of an image of unequal cells, and of contour lines


def bar_room(surface: Surface) -> float:
    """Room on the right of a panel for the colour bar and its words, in."""
    scale = _scale(surface)
    words = max(map(labels.width, scale.words), default=0.0)
    return APART + BAR + labels.GAP + words + (labels.LINE + 0.05 if scale.label else 0.0)


def _scale(surface: Surface) -> Scale:
    """The scale of the colours."""
    return scales.tight(surface.values if surface.span is None else np.array(surface.span), surface.label, TICKS)


def draw_surface(axes: Axes, surface: Surface, width: float) -> None:
    """Draw a surface into axes of so many inches, and its colour bar beside them."""
    if not np.any(np.isfinite(surface.values)):
        return
    scale = _scale(surface)
    ends = (surface.x[0], surface.x[-1], surface.y[0], surface.y[-1])
    image = surface.values[np.ix_(_even(surface.y), _even(surface.x))]
    style: dict[str, Any] = {
        "cmap": COLOURS,
        "vmin": scale.low,
        "vmax": scale.high,
        "aspect": "auto",
        "interpolation": "none",
    }
    axes.imshow(image, extent=ends, origin="lower", zorder=1.6, **style)
    _draw_contours(axes, surface, scale)
    bar = axes.inset_axes((1.0 + APART / width, 0.0, BAR / width, 1.0))
    bar.set_axis_off()
    bar.imshow(
        np.linspace(scale.low, scale.high, 256)[:, None],
        extent=(0.0, 1.0, scale.low, scale.high),
        origin="lower",
        **style,
    )
    beside = 1.0 + labels.GAP / BAR
    for tick, word in zip(scale.ticks, scale.words, strict=True):
        bar.axhline(tick, color=_on(scale, tick), linewidth=0.6)
        bar.text(beside, tick, word, transform=bar.get_yaxis_transform(), va="center")
    right = (bar_room(surface) - APART - 0.5 * labels.LINE) / BAR
    bar.text(right, 0.5, scale.label, transform=bar.transAxes, rotation=90.0, va="center", ha="center")


def _even(edges: Array) -> NDArray[np.intp]:
    """The cell of every pixel of an image: one each where all are equally wide."""
    count = len(edges) - 1
    if np.allclose(np.diff(edges), (edges[-1] - edges[0]) / count, rtol=1e-6, atol=0.0):
        return np.arange(count)
    middles = edges[0] + (edges[-1] - edges[0]) * (np.arange(PIXELS) + 0.5) / PIXELS
    return np.asarray(np.clip(np.searchsorted(edges, middles, side="right") - 1, 0, count - 1))


def _draw_contours(axes: Axes, surface: Surface, scale: Scale) -> None:
    """Lines at the ticks of the colour bar, through the middles of the cells."""
    rows, columns = (slice(None, None, -(-count // CONTOURED)) for count in surface.values.shape)
    x, y = 0.5 * (surface.x[1:] + surface.x[:-1])[columns], 0.5 * (surface.y[1:] + surface.y[:-1])[rows]
    values = np.ma.masked_invalid(surface.values[rows, columns])
    within = {tick: word for tick, word in zip(scale.ticks, scale.words, strict=True) if scale.low < tick < scale.high}
    within = {tick: word for tick, word in within.items() if values.min() < tick < values.max()}
    if min(values.shape) < 2 or not within:
        return
    colours = [_on(scale, tick) for tick in within]
    drawn = axes.contour(x, y, values, levels=list(within), colors=colours, linewidths=0.8, zorder=1.7)
    axes.clabel(drawn, fmt=within, fontsize=FONT_SIZE, inline_spacing=2)


def _on(scale: Scale, value: float) -> str:
    """A colour that can be seen on that of a value."""
    return ON_DARK if scale.share(value) < MIDDLE else ON_BRIGHT


def hatched(axes: Axes, box: tuple[float, float, float, float], transform: Transform) -> None:
    """A hatched box: left, bottom, width, height; the ground and the strokes apart, so that both follow the scheme."""
    left, bottom, width, height = box
    styles: tuple[dict[str, Any], ...] = ({"facecolor": PLATE}, {"fill": False, "edgecolor": REFERENCE, "hatch": HATCH})
    for style in styles:
        place: dict[str, Any] = {"transform": transform, "zorder": 1.1, "clip_on": False, "linewidth": 0.0}
        axes.add_artist(Rectangle((left, bottom), width, height, **place, **style))
