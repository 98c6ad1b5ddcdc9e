"""The picture of a sweep: curves over one parameter, maps over two, dots over each of more and for tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.errors import printable
from comparisons.designer.sweep import ONE_BY_ONE
from reports.charts import draw
from reports.charts.draw import FULL_WIDTH, HATCHED, INK, LIMIT, MUTED, PALETTE, PAPER, REFERENCE, Array, axis_label
from reports.document import numbers

if TYPE_CHECKING:
    import xarray


MOST: Final = 9  # figures in one picture
SAMPLE: Final = 20_000  # designs in a curve or a map
LINES: Final = 2_000  # designs drawn as a dot each
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
        """Whether each design is one of a list, and not a point of a grid of one or two numbers."""
        return ONE_BY_ONE in self.dataset.dims

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the varied parameters."""
        return tuple(str(name) for name in (self.dataset.coords if self.are_lines else self.dataset.dims))

    @property
    def figures(self) -> tuple[str, ...]:
        """Names of the figures that are drawn, the first nine."""
        return tuple(map(str, self.dataset.data_vars))[:MOST]

    def values(self, name: str) -> Array:
        """The values of a figure or a parameter over the designs, in the file's unit."""
        return np.asarray(self.dataset[name].values, dtype=float)

    def failing(self, name: str) -> int:
        """The number of designs without a value of this figure."""
        return int(np.count_nonzero(np.isnan(self.values(name))))

    def best(self, name: str) -> int | None:
        """The index, in the flattened designs, of the one whose figure is nearest to its target.

        None where all fail.
        """
        away = np.abs(self.values(name) - self.target(name)[0])
        return None if np.all(np.isnan(away)) else int(np.nanargmin(away))

    def span(self, name: str) -> tuple[float, float] | None:
        """Limits of a figure's scale that cut off a few very large values, such as those near dead positions.

        They are twice the span of eight tenths of all, and the value nearest to the target; None where all can be shown
        or there is none.
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
        """The unit of a parameter or figure, of the file, as text; "" without one."""
        return printable(str(self.dataset[name].attrs.get("units", "")))

    def label(self, name: str) -> str:
        """A name with its unit; where the picture cuts values off, with the range of all values between them."""
        ends = ""
        if name in self.figures and self.span(name):
            values = self.values(name)
            ends = f" ({numbers.figure(np.nanmin(values))} to {numbers.figure(np.nanmax(values))})"
        return axis_label(f"{printable(name)}{ends}", self.unit(name))

    def target(self, figure: str) -> tuple[float, str]:
        """The best value of a figure, 90° for transmission angles and else 0, and words on the design nearest to it.

        It is in the file's unit.
        """
        if figure.startswith("transmission_angle:") and not figure.endswith(".range"):
            return 0.5 * math.pi if self.unit(figure) == "rad" else 90.0, "nearest to 90°"
        return 0.0, "nearest to 0" if figure.endswith(SIGNED) or "@" in figure else "least"

    @property
    def own_place(self) -> tuple[float, ...]:
        """The file's own values of the parameters if they lie among the designs, else ()."""
        place = tuple(self.own[name] for name in self.parameters)
        ends = [(np.min(values), np.max(values)) for values in map(self.values, self.parameters)]
        return place if all(low <= value <= high for value, (low, high) in zip(place, ends, strict=True)) else ()

    @property
    def head(self) -> tuple[str, ...]:
        """The lines above the picture: linkage and number of designs, conditions, and what is cut off or left out."""
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

    ``always`` are indices of designs that are among them, in the flattened order of the dimensions. ``own`` is kept.
    The sample is the same every time; fewer designs are all drawn.
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
    """A count with narrow spaces between its thousands."""
    return numbers.grouped(count, "\N{NARROW NO-BREAK SPACE}")


CURVES, MAP, DOTS = 2.2, 3.6, 1.9  # in, height of a row of panels
STAR: Final[dict[str, Any]] = {"marker": "*", "color": LIMIT, "markersize": 9.0, "linestyle": "", "zorder": 4.0,
                               "clip_on": False}  # fmt: skip
DIAMOND: Final[dict[str, Any]] = {"marker": "D", "color": INK, "markersize": 5.0, "linestyle": "", "zorder": 4.0}
UPRIGHT: Final[dict[str, Any]] = {"color": MUTED, "linestyle": "--", "linewidth": 0.9}
AROUND: Final = {"markeredgecolor": PAPER, "markeredgewidth": 1.0}  # of a mark on a map


def sweep_figure(dataset: xarray.Dataset, own: Mapping[str, float], always: Collection[int]) -> Figure:
    """The figures of a sweep, at most nine of them: curves over one number, maps over two, dots over each of more.

    A dataset has a dimension per parameter, or the dimension ``design`` with the parameters as coordinates over it; nan
    is a design that does not assemble. ``own`` are the numbers of the file by name, in its units: the design of the
    file is marked where it lies among the others. Of many designs a sample is drawn, in which those of the indices
    ``always`` are drawn, and the picture states it.
    """
    designs = drawn_designs(dataset, own, always)
    count, over = len(designs.figures), len(designs.parameters)
    if designs.are_lines or over > 2:
        return _figure(designs, (count, over), (max(FULL_WIDTH, DOTS * over), DOTS), _plot_dots)
    columns = min(2, count) if over == 2 or count > 3 else 1
    shape = (-(-count // columns), columns)
    if over == 1:
        return _figure(designs, shape, (FULL_WIDTH, CURVES), _plot_curves)
    return _figure(designs, shape, (0.5 * FULL_WIDTH * columns, MAP), _plot_maps)


def _figure(
    designs: DrawnDesigns, shape: tuple[int, int], size: tuple[float, float], plot: Callable[[DrawnDesigns, Any], None]
) -> Figure:
    """A figure of ``shape`` (rows, columns) of panels that ``plot`` fills, with the marks' meanings in a legend.

    ``size`` is its width and the height of a row, in. ``plot`` gets the designs and the array of axes.
    """
    (rows, columns), (width, tall) = shape, size

    def place(figure: Figure) -> None:
        """Draw head, panels and a legend of all marks into the figure."""
        host = draw.head(figure, designs.head)
        grid = host.subplots(rows, columns, squeeze=False)
        plot(designs, grid)
        every = [axes.get_legend_handles_labels() for axes in grid.flat]
        marks = {name: mark for marks, names in every for mark, name in zip(marks, names, strict=True)}
        if marks:
            host.legend(marks.values(), marks, loc="outside upper left", ncols=max(1, int(width / 2.0)))
        for axes in grid.flat[len(designs.figures) :] if plot is not _plot_dots else ():
            axes.remove()

    return draw.drawn(width, tall * rows + draw.LINE * (len(draw.head_lines(designs.head, width)) + 2), place)


def _plot_curves(designs: DrawnDesigns, grid: Any) -> None:  # noqa: ANN401 - an array of axes
    """Draw a panel per figure over one parameter into the axes of ``grid``, hatched where no design assembles."""
    (parameter,) = designs.parameters
    x = designs.values(parameter)
    edges = _edges(x)
    for axes, name in zip(grid.flat, designs.figures, strict=False):
        values = designs.values(name)
        axes.plot(x, values, marker="" if len(x) > 1 else "o")
        _mark(axes, designs, name, x, *(designs.own_place or (None,)))
        fails = np.flatnonzero(np.diff(np.concatenate([[False], np.isnan(values), [False]])))
        for low, high in edges[fails].reshape(-1, 2):
            axes.axvspan(low, high, zorder=1.1, label=FAILS, **HATCHED)
        axes.set_title(draw.wrap(designs.label(name), FULL_WIDTH / grid.shape[1] - 1.0))
        draw.finish(axes, designs.label(parameter), designs.unit(name))
        axes.set_ylim(designs.span(name))


def _mark(axes: Axes, designs: DrawnDesigns, name: str, x: Array, own: float | None) -> None:
    """Mark the design nearest to the target of the figure ``name``, and the file's ``own`` place unless None.

    ``x`` are the designs' places along the axes.
    """
    best = designs.best(name)
    if best is not None:
        axes.plot(x[best], designs.values(name)[best], label=designs.target(name)[1], **STAR)
    if own is not None:
        axes.axvline(own, label=OWN, **UPRIGHT)


def _plot_maps(designs: DrawnDesigns, grid: Any) -> None:  # noqa: ANN401
    """Draw a map per figure over two parameters into the axes of ``grid``, with contour lines.

    It is hatched where no design assembles.
    """
    across, upward = map(designs.values, designs.parameters)
    edges = _edges(across), _edges(upward)
    for axes, name in zip(grid.flat, designs.figures, strict=False):
        values, best = designs.values(name), designs.best(name)
        low, high = designs.span(name) or (None, None)
        if designs.failing(name):
            axes.axvspan(*edges[0][[0, -1]], zorder=1.1, label=FAILS, **HATCHED)
        if best is not None:
            image = axes.pcolorfast(*edges, values.T, vmin=low, vmax=high, zorder=1.6)
            bar = axes.figure.colorbar(image, ax=axes, pad=0.02, label=designs.unit(name))
            levels = [tick for tick in bar.get_ticks() if np.nanmin(values) < tick < np.nanmax(values)]
            if min(values.shape) > 1 and levels:
                lines = axes.contour(across, upward, values.T, levels, colors=PAPER, linewidths=0.8, zorder=1.7)
                axes.clabel(lines, fmt="%.3g", inline_spacing=2)
            column, row = np.unravel_index(best, values.shape)
            axes.plot(across[column], upward[row], label=designs.target(name)[1], **STAR, **AROUND)
        if designs.own_place:
            axes.plot(*designs.own_place, label=OWN, **DIAMOND, **AROUND)
        axes.set(xlabel=designs.label(designs.parameters[0]), ylabel=designs.label(designs.parameters[1]))
        axes.set_title(draw.wrap(designs.label(name), FULL_WIDTH / 2.0 - 1.0))


def _plot_dots(designs: DrawnDesigns, grid: Any) -> None:  # noqa: ANN401
    """Draw figures down, parameters across, a dot per design, into the axes of ``grid``.

    Strokes at the foot are designs not assembled.
    """
    for row, (line, name) in enumerate(zip(grid, designs.figures, strict=True)):
        values = designs.values(name)
        fails = np.isnan(values)
        for axes, parameter, own in zip_longest(line, designs.parameters, designs.own_place):
            x = designs.values(parameter)
            axes.plot(x, values, ".", color=PALETTE[0], markersize=2.5, alpha=0.5, rasterized=True)
            if fails.any():
                foot = {"transform": axes.get_xaxis_transform(), "color": REFERENCE, "label": FAILS, "clip_on": False}
                axes.plot(x[fails], np.zeros(np.count_nonzero(fails)), "|", rasterized=True, **foot)
            _mark(axes, designs, name, x, own)
            axes.margins(0.05)
            axes.locator_params(nbins=4)
            axes.set_ylim(designs.span(name))
            is_first, is_last = axes is line[0], row == len(grid) - 1
            axes.set_ylabel(draw.wrap(designs.label(name), DOTS) if is_first else "")
            axes.set_xlabel(draw.wrap(designs.label(parameter), DOTS) if is_last else "")
            axes.tick_params(labelleft=is_first, labelbottom=is_last)


def _edges(places: Array) -> Array:
    """The borders of cells around places (n,), ascending, half-way between neighbours: (n + 1,).

    Those at the ends are as far out as the next ones are in; those of a single place are half its size away, or
    0.5 from 0.
    """
    if len(places) == 1:
        return places + 0.5 * (abs(places[0]) or 1.0) * np.array([-1.0, 1.0])
    first, last = 1.5 * places[[0, -1]] - 0.5 * places[[1, -2]]
    return np.concatenate([[first], 0.5 * (places[1:] + places[:-1]), [last]])
