"""The picture of a sweep: curves over one parameter, maps over two, parallel coordinates over more and for tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from reports.charts import draw, labels
from reports.charts.style import FULL_WIDTH
from reports.designs.sweep.parallel import parallel_figure
from reports.designs.sweep.swept import DESIGN, FAILS, OWN, Swept, grouped
from reports.designs.sweep.thinning import Kept, PixelCells
from reports.document.chart import Chart, Curve, Hatch, Mark, Panel, Surface

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]

CURVES, MAP = 2.2, 3.0  # in, height of a row of panels
AROUND_CURVES, AROUND_MAP = 1.0, 1.6  # in, beside the axes of a panel
CURVE_CELLS, MAP_CELLS = 1000, 300  # along an axis; finer than the paper shows
NOWHERE = np.zeros(0)
DIAMOND = ("D", 5.0)
UPRIGHT = Curve(NOWHERE, NOWHERE, OWN, "muted", line="--", width=0.9)


def sweep_svg(dataset: xarray.Dataset, own: Mapping[str, float] | None = None) -> str:
    """The picture as an SVG file of its own, on white."""
    return draw.svg(sweep_figure(dataset, own), page="white")


def sweep_figure(dataset: xarray.Dataset, own: Mapping[str, float] | None = None) -> Figure:
    """The figures of a sweep, at most nine of them, over what it varies.

    A dataset has a dimension per parameter, or the dimension ``design`` with the parameters as coordinates over it; nan
    is a design that does not assemble. ``own`` are the numbers of the file by name, in its units: the design of the
    file is marked where it lies among the others. Where there are more designs than can be seen, the least and the
    largest are kept, and the picture says so. Raises LinkproofError where there is nothing to draw.
    """
    swept = Swept(_ascending(dataset), own or {})
    if not swept.figures or not swept.count:
        raise LinkproofError("picture of a sweep: expected designs and figures of theirs, got none; sweep something")
    if swept.is_table or len(swept.parameters) > 2:
        return parallel_figure(swept)
    return draw.figure(_curves(swept) if len(swept.parameters) == 1 else _maps(swept))


def _curves(swept: Swept) -> Chart:
    """A panel per figure over one parameter."""
    (parameter,) = swept.parameters
    cells, columns = PixelCells(swept.places(parameter), CURVE_CELLS), 1 if len(swept.figures) < 4 else 2
    uprights = tuple(Mark(place) for place in swept.own_place)
    panels, seen = [], {name: swept.keep(name, cells) for name in swept.figures}
    for name, kept in seen.items():
        curve = Curve(*cells.curve(kept), marker="" if swept.count > 1 else "o")
        best = [_star("", cells.places[place], kept.extremes[2]) for place in kept.best]
        title = labels.fitting(swept.label(name, kept), FULL_WIDTH / columns - AROUND_CURVES)
        hatch = Hatch(cells.failing(kept))
        axes = (swept.label(parameter), swept.scale(name))
        panels.append(Panel((curve, *best), *axes, uprights, names="", title=title, hatch=hatch, span=kept.span))
    note = (
        f"The curve goes through the least and the largest of each {grouped(swept.count // CURVE_CELLS)} neighbours."
        if cells.are_thin
        else ""
    )
    key = _key(swept, seen, UPRIGHT)
    height = CURVES * -(-len(panels) // columns) + 0.5
    return Chart(tuple(panels), height, columns, wide=True, head=swept.head(seen.values(), note), key=key)


def _maps(swept: Swept) -> Chart:
    """A map per figure over two parameters."""
    axes = (swept.label(swept.parameters[0]), swept.label(swept.parameters[1]))
    cells = tuple(PixelCells(swept.places(name), MAP_CELLS) for name in swept.parameters)
    columns = min(3 if len(swept.figures) > 4 else 2, len(swept.figures))
    own = [_marker("", swept.own_place, *DIAMOND)] if swept.own_place else []
    panels, seen = [], {name: swept.keep(name, *cells) for name in swept.figures}
    for name, kept in seen.items():
        places = [np.unravel_index(place, swept.shape) for place in kept.best]
        found = [
            *own,
            *(_star("", *(one.places[at] for one, at in zip(cells, place, strict=True))) for place in places),
        ]
        surface = Surface(cells[0].edges, cells[1].edges, kept.surface().T, swept.scale(name), kept.span)
        title = labels.fitting(swept.label(name, kept), FULL_WIDTH / columns - AROUND_MAP)
        whole = Hatch(cells[0].edges[[[0, -1]]][: bool(kept.failing)])
        outlined = [edge for one in found for edge in (_outline(one), one)]
        panels.append(Panel(tuple(outlined), *axes, names="", title=title, hatch=whole, surface=surface))
    together = grouped(-(-swept.count // (len(cells[0].starts) * len(cells[1].starts))))
    note = (
        f"A point of a map stands for about {together} designs: it shows the value farthest from the middle of all "
        "values, and is hatched where one of them does not assemble."
        if any(one.are_thin for one in cells)
        else ""
    )
    key = _key(swept, seen, _marker(OWN, (0.0, 0.0), *DIAMOND))
    height = MAP * -(-len(panels) // columns) * (1.25 if columns < 3 else 1.0)
    return Chart(tuple(panels), height, columns, wide=len(panels) > 1, head=swept.head(seen.values(), note), key=key)


def _ascending(dataset: xarray.Dataset) -> xarray.Dataset:
    """The designs of a grid, the values of every parameter ascending."""
    for name in dataset.dims:
        places = dataset[name].values
        if name != DESIGN and np.any(places[1:] < places[:-1]):
            dataset = dataset.isel({name: np.argsort(places, kind="stable")})
    return dataset


def _key(swept: Swept, seen: Mapping[str, Kept], own: Curve) -> tuple[Curve | Hatch, ...]:
    """What stars mean, the design of the file, and what does not assemble; each if it is there."""
    meanings = dict.fromkeys(swept.target(name)[1] for name, kept in seen.items() if len(kept.best))
    fails = any(kept.failing for kept in seen.values())
    return (*map(_star, meanings), *(own,) * bool(swept.own_place), *(Hatch(np.zeros((0, 2)), FAILS),) * fails)


def _marker(name: str, place: tuple[float, ...], marker: str, size: float, ink: str = "ink") -> Curve:
    x, y = np.reshape(place, (2, 1))
    return Curve(x, y, name, ink, line="", marker=marker, size=size)


def _star(name: str, *place: float) -> Curve:
    """The best design, or its entry in the key."""
    return _marker(name, place or (0.0, 0.0), "*", 9.0, "limit")


def _outline(curve: Curve) -> Curve:
    """What lies behind a marker on a map, for it to be seen on any colour."""
    return replace(curve, ink="paper", size=curve.size + 3.0)
