"""The picture of a sweep: curves over one parameter, maps over two, parallel coordinates over more and for tables."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from analytic.errors import printable
from comparisons.designer.sweep import ONE_BY_ONE
from reports.charts import draw, scales
from reports.charts.scales import FULL_WIDTH, INK, ink
from reports.charts.scheme import BEHIND
from reports.document import numbers
from reports.document.chart import Array, Chart, Curve, Hatch, Mark, Panel, Surface, axis_label

if TYPE_CHECKING:
    import xarray


MOST: Final = 9  # figures in one picture
SAMPLE: Final = 20_000  # designs in a curve or a map
LINES: Final = 2_000  # designs drawn as a line each
FAR: Final = 3.0  # times the span of eight tenths of the values: beyond, these are shown and the others cut off
CUT: Final = "If two numbers follow a name, values reach that far and are cut off, to separate the others."
SIGNED: Final = (".mean", ".max", ".min")  # figures that may be negative, as those at an angle
FAILS: Final = "does not assemble"
OWN: Final = "design of the file"


@dataclass(frozen=True)
class DrawnDesigns:
    """Designs over a dimension per parameter, or over one, ``design``, with the parameters as coordinates.

    nan is a design that does not assemble. ``own`` are the numbers of the file by name, in its units; ``count`` is the
    number of designs of which these are drawn.
    """

    dataset: xarray.Dataset
    own: Mapping[str, float]
    count: int

    @property
    def are_lines(self) -> bool:
        """Whether designs are one beside the other, not on a grid of one or two numbers."""
        return ONE_BY_ONE in self.dataset.dims

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the varied parameters."""
        return tuple(str(name) for name in (self.dataset.coords if self.are_lines else self.dataset.dims))

    @property
    def figures(self) -> tuple[str, ...]:
        """The figures that are drawn."""
        return tuple(map(str, self.dataset.data_vars))[:MOST]

    def values(self, name: str) -> Array:
        """The values of a figure or a parameter over the designs, in the file's unit."""
        return np.asarray(self.dataset[name].values, dtype=float)

    def failing(self, name: str) -> int:
        """Number of designs without this figure."""
        return int(np.count_nonzero(np.isnan(self.values(name))))

    def best(self, name: str) -> int | None:
        """The design, in the order of the dimensions, whose figure is nearest to its target; None where all fail."""
        away = np.abs(self.values(name) - self.target(name)[0])
        return None if np.all(np.isnan(away)) else int(np.nanargmin(away))

    def span(self, name: str) -> tuple[float, float] | None:
        """Limits of a figure's scale that cut off a few very large values, such as those near dead positions.

        Twice the span of eight tenths of all, and the value nearest to the target; None where all can be shown.
        """
        values = self.values(name)
        values = values[np.isfinite(values)]
        if not len(values):
            return None
        low, high = np.quantile(values, [0.1, 0.9])
        if np.ptp(values) <= FAR * (high - low) or high == low:
            return None
        half, nearest = 0.5 * (high - low), values[np.argmin(np.abs(values - self.target(name)[0]))]
        ends = max(np.min(values), min(low - half, nearest)), min(np.max(values), max(high + half, nearest))
        return float(ends[0]), float(ends[1])

    def unit(self, name: str) -> str:
        """The unit of a parameter or figure, of the file."""
        return printable(str(self.dataset[name].attrs.get("units", "")))

    def label(self, name: str) -> str:
        """A name with its unit; of values that are cut off in the picture with both ends of all."""
        ends = ""
        if name in self.figures and self.span(name):
            values = self.values(name)
            ends = f" ({numbers.figure(np.nanmin(values))} to {numbers.figure(np.nanmax(values))})"
        return axis_label(f"{printable(name)}{ends}", self.unit(name))

    def target(self, figure: str) -> tuple[float, str]:
        """The best value of a figure, and the note on the design nearest to it."""
        if figure.startswith("transmission_angle:") and not figure.endswith(".range"):
            return 0.5 * math.pi if self.unit(figure) == "rad" else 90.0, "nearest to 90°"
        return 0.0, "nearest to 0" if figure.endswith(SIGNED) or "@" in figure else "least"

    @property
    def own_place(self) -> tuple[float, ...]:
        """The file's own numbers by parameter if they lie among the designs, else nothing."""
        place = tuple(self.own[name] for name in self.parameters)
        ends = [(np.min(values), np.max(values)) for values in map(self.values, self.parameters)]
        return place if all(low <= value <= high for value, (low, high) in zip(place, ends, strict=True)) else ()

    @property
    def head(self) -> tuple[str, ...]:
        """Lines above the picture: whose designs, under which conditions, what is left out."""
        about, left = self.dataset.attrs, len(self.dataset.data_vars) - len(self.figures)
        conditions = about["conditions"].removeprefix(f"{about['mechanism']} ({about['variant']}): ")
        drawn, failing = self.dataset[self.figures[0]].size, max(map(self.failing, self.figures))
        sample = f", a sample of {_grouped(drawn)} is drawn" if drawn < self.count else ""
        fails = f", {_grouped(failing)} of which {'does' if failing == 1 else 'do'} not assemble" if failing else ""
        designs = f"{_grouped(self.count)} design{'s' * (self.count != 1)}{sample}{fails}"
        cut = CUT if any(map(self.span, self.figures)) else ""
        more = f"The first {MOST} of {left + MOST} figures are drawn." if left else ""
        texts = (f"{about['mechanism']}, {about['variant']}: {designs}", conditions, cut, more)
        return tuple(printable(text) for text in texts if text)


def drawn_designs(dataset: xarray.Dataset, own: Mapping[str, float], always: Collection[int]) -> DrawnDesigns:
    """The designs of a sweep to draw: a grid of one or two numbers thinned out evenly, of others a random sample.

    ``always`` are numbers of designs that are among them, in the order of the dimensions.
    """
    shape = tuple(dataset.sizes.values())
    count, always_drawn = math.prod(shape), np.array(sorted(always), dtype=int)
    if ONE_BY_ONE not in dataset.dims and len(shape) < 3:
        most = round(SAMPLE ** (1.0 / len(shape)))
        chosen = {}
        for name, size, indices in zip(dataset.dims, shape, np.unravel_index(always_drawn, shape), strict=True):
            places = np.linspace(0, size - 1, min(size, most)).round().astype(int)
            chosen[name] = np.union1d(places, indices)
        thinned = dataset.isel(chosen)
        return DrawnDesigns(thinned.sortby(list(thinned.dims)), own, count)
    rng = np.random.default_rng(0)
    some = np.arange(count) if count <= LINES else rng.choice(count, LINES, replace=False, shuffle=False)
    chosen_at = np.unravel_index(np.union1d(some, always_drawn), shape)
    drawn = dataset.isel({name: (ONE_BY_ONE, at) for name, at in zip(dataset.dims, chosen_at, strict=True)})
    return DrawnDesigns(drawn, own, count)


def _grouped(count: int) -> str:
    return numbers.grouped(count, "\N{NARROW NO-BREAK SPACE}")


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
    label = draw.wrap(scale.yaxis.get_label_text(), APART)
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
