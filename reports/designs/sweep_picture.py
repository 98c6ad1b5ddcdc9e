"""The picture of a sweep: curves over one parameter, maps over two, parallel coordinates over more and for tables."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from reports.charts import draw, labels, scales
from reports.charts.scales import FULL_WIDTH, INK, ink
from reports.charts.scheme import BEHIND
from reports.designs.drawn_designs import FAILS, OWN, DrawnDesigns, drawn_designs
from reports.document.chart import Array, Chart, Curve, Hatch, Mark, Panel, Surface, axis_label

if TYPE_CHECKING:
    import xarray


CURVES, MAP = 2.2, 3.0  # in, height of a row of panels
STAR = Curve(ink="limit", line="", marker="*", size=9.0)  # the best design
DIAMOND = Curve(name=OWN, ink="ink", line="", marker="D", size=5.0)
UPRIGHT = Curve(name=OWN, ink="muted", line="--", width=0.9)


def sweep_figure(dataset: xarray.Dataset, own: Mapping[str, float], always: Collection[int]) -> Figure:
    """The figures of a sweep, at most nine of them, over what it varies.

    A dataset has a dimension per parameter, or the dimension ``design`` with the parameters as coordinates over it; nan
    is a design that does not assemble. ``own`` are the numbers of the file by name, in its units: the design of the
    file is marked where it lies among the others. Of many designs a sample is drawn, in which those of the numbers
    ``always`` are drawn, and the picture states it.
    """
    designs = drawn_designs(dataset, own, always)
    if designs.are_lines:
        width = max(FULL_WIDTH, APART * len((*designs.parameters, *designs.figures)))
        return draw.drawn(width, HIGH, partial(_draw_parallel, designs=designs))
    return draw.figure(_curves(designs) if len(designs.parameters) == 1 else _maps(designs))


def _curves(designs: DrawnDesigns) -> Chart:
    """A panel per figure over one parameter."""
    (parameter,) = designs.parameters
    places, columns = designs.values(parameter), 1 if len(designs.figures) < 4 else 2
    edges, uprights = _edges(places), tuple(Mark(place) for place in designs.own_place)
    panels = []
    for name in designs.figures:
        values, best = designs.values(name), designs.best(name)
        curve = Curve(places, values, marker="" if len(places) > 1 else "o")
        star = [] if best is None else [_marked(STAR, places[best], values[best])]
        fails = np.flatnonzero(np.diff(np.concatenate([[False], np.isnan(values), [False]])))
        panels.append(
            Panel((curve, *star), designs.label(parameter), axis_label("value", designs.unit(name)), uprights, names="",
                  title=designs.label(name), hatch=Hatch(edges[fails].reshape(-1, 2)), span=designs.span(name))
        )  # fmt: skip
    height = CURVES * -(-len(panels) // columns) + 0.5
    return Chart(tuple(panels), height, columns, wide=True, head=designs.head, key=_key(designs, UPRIGHT))


def _maps(designs: DrawnDesigns) -> Chart:
    """A map per figure over two parameters."""
    across, upward = map(designs.values, designs.parameters)
    edges = _edges(across), _edges(upward)
    axes = (designs.label(designs.parameters[0]), designs.label(designs.parameters[1]))
    columns = min(3 if len(designs.figures) > 4 else 2, len(designs.figures))
    own = [_marked(DIAMOND, *designs.own_place)] if designs.own_place else []
    panels = []
    for name in designs.figures:
        values, best = designs.values(name), designs.best(name)
        column, row = np.unravel_index(best or 0, values.shape)
        marks = own if best is None else [*own, _marked(STAR, across[column], upward[row])]
        surface = Surface(*edges, values.T, axis_label("value", designs.unit(name)))
        whole = Hatch(edges[0][[[0, -1]]][: bool(designs.failing(name))])
        outlined = [mark for curve in marks for mark in (replace(curve, ink="paper", size=curve.size + 3.0), curve)]
        panels.append(
            Panel(tuple(outlined), *axes, names="", title=designs.label(name), hatch=whole, surface=surface,
                  span=designs.span(name))
        )  # fmt: skip
    height = MAP * -(-len(panels) // columns) * (1.25 if columns < 3 else 1.0)
    return Chart(tuple(panels), height, columns, wide=len(panels) > 1, head=designs.head, key=_key(designs, DIAMOND))


def _edges(places: Array) -> Array:
    """Where the cells of ascending places end, half-way between neighbours: (places + 1,)."""
    if len(places) == 1:
        return places + 0.5 * (abs(places[0]) or 1.0) * np.array([-1.0, 1.0])
    first, last = 1.5 * places[[0, -1]] - 0.5 * places[[1, -2]]
    return np.concatenate([[first], 0.5 * (places[1:] + places[:-1]), [last]])


def _marked(marker: Curve, x: float, y: float) -> Curve:
    """A marker of the key at a place of a panel."""
    return replace(marker, x=np.array([x]), y=np.array([y]), name="")


def _key(designs: DrawnDesigns, own: Curve) -> tuple[Curve | Hatch, ...]:
    """The key: stars, the design of the file, and the hatch of designs that do not assemble."""
    meanings = dict.fromkeys(designs.target(name)[1] for name in designs.figures if designs.best(name) is not None)
    stars = [replace(STAR, name=meaning) for meaning in meanings]
    fails = any(map(designs.failing, designs.figures))
    return (*stars, *(own,) * bool(designs.own_place), *(Hatch(np.zeros((0, 2)), FAILS),) * fails)


# Parallel coordinates: a line per design through an axis per parameter and figure, coloured by the first figure.

APART, HIGH, TICKS = 1.7, 4.8, 6  # in, between axes at least, of the figure; ticks of an axis
THIN = 0.6  # points, of a line among many
SHADES = 32  # of a scale that grows evenly to the eye, none too pale on white
RAMP = tuple(to_hex(colormaps["viridis"](0.9 * n / (SHADES - 1))) for n in range(SHADES))


def _draw_parallel(figure: Figure, designs: DrawnDesigns) -> None:
    """The parameters, then the figures; designs that do not assemble end behind the parameters.

    Heights on the axes are from 0 to 1, nan beyond where a line ends; the file's own design has diamonds.
    """
    names, first = (*designs.parameters, *designs.figures), designs.figures[0]
    ends = np.array([_ends(designs, name) for name in names])
    low, size = ends[:, 0], np.ptp(ends, axis=1)
    heights = (np.stack([designs.values(name) for name in names], axis=1) - low) / size
    own = [(place - start) / wide for place, start, wide in zip(designs.own_place, low, size, strict=False)]
    best = designs.best(first)
    key = [Curve(name=f"{first}: {designs.target(first)[1]}", ink="limit", width=2.0)] if best is not None else []
    key += [DIAMOND] if own else []
    key += [Curve(name=FAILS, ink="reference", width=0.8)] if any(map(designs.failing, designs.figures)) else []
    axes = draw.head(figure, designs.head, key).subplots()
    axes.set_label("parallel")
    axes.set(xlim=(-0.5, len(names) - 0.5), ylim=(0.0, 1.0), autoscale_on=False, xticks=[], yticks=[])
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    _draw_designs(axes, heights, len(designs.parameters))
    if best is not None:
        _draw_lines(axes, heights[[best]], ink("limit"), 2.0)
    axes.plot(range(len(own)), own, color=INK, linestyle="", marker="D", markersize=5.0, zorder=7.0, clip_on=False)
    for number, name in enumerate(names):
        _draw_scale(axes, number, ends[number], designs.label(name))


def _ends(designs: DrawnDesigns, name: str) -> tuple[float, float]:
    """The limits of the axis of a parameter or figure, apart."""
    span = designs.span(name) if name in designs.figures else None
    values = designs.values(name) if span is None else np.array(span)
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    room = 0.1 * (abs(low) or 1.0) if low == high else 0.0
    return low - room, high + room


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


def _draw_designs(axes: Axes, heights: Array, coloured: int) -> None:
    """Draw lines that end early, then shade by shade, the smallest figures on top; the colours along their axis."""
    shades = np.round(np.clip(heights[:, coloured], 0.0, 1.0) * (SHADES - 1))
    _draw_lines(axes, heights[np.isnan(shades)], ink("reference"), 0.8)
    for shade in range(SHADES)[::-1]:
        _draw_lines(axes, heights[shades == shade], RAMP[shade], THIN)
    for shade, colour in enumerate(RAMP):
        ends = [shade / SHADES, (shade + 1) / SHADES]
        axes.plot([coloured] * 2, ends, color=colour, linewidth=6.0, solid_capstyle="butt", zorder=5.0)


def _draw_lines(axes: Axes, heights: Array, colour: str, width: float) -> None:
    """Lines (lines, axes) of one colour, as one."""
    if len(heights):
        broken = np.pad(heights, ((0, 0), (0, 1)), constant_values=np.nan)
        places = np.tile(np.arange(broken.shape[1], dtype=float), len(broken))
        axes.plot(
            places, broken.ravel(), color=colour, linewidth=width, alpha=0.7 if width == THIN else 1.0, zorder=3.0
        )
