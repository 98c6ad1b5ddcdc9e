"""The picture of a sweep: curves over one parameter, maps over two, parallel coordinates over more and for tables."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from analytic.errors import LinkproofError
from reports.charts import draw
from reports.designs.drawn_designs import FAILS, OWN, DrawnDesigns, drawn_designs
from reports.designs.parallel_coordinates import parallel_figure
from reports.document.chart import Array, Chart, Curve, Hatch, Mark, Panel, Surface

if TYPE_CHECKING:
    import xarray


CURVES, MAP = 2.2, 3.0  # in, height of a row of panels
DIAMOND = ("D", 5.0)
UPRIGHT = Curve(name=OWN, ink="muted", line="--", width=0.9)


def sweep_svg(dataset: xarray.Dataset, own: Mapping[str, float] | None = None, always: Collection[int] = ()) -> str:
    """The picture as an SVG file of its own, on white."""
    return draw.svg(sweep_figure(dataset, own, always), page="white")


def sweep_figure(
    dataset: xarray.Dataset, own: Mapping[str, float] | None = None, always: Collection[int] = ()
) -> Figure:
    """The figures of a sweep, at most nine of them, over what it varies.

    A dataset has a dimension per parameter, or the dimension ``design`` with the parameters as coordinates over it; nan
    is a design that does not assemble. ``own`` are the numbers of the file by name, in its units: the design of the
    file is marked where it lies among the others. Of many designs a sample is drawn, in which those of the numbers
    ``always`` are drawn, and the picture states it. Raises LinkproofError without designs.
    """
    if not dataset.data_vars or not all(dataset.sizes.values()):
        raise LinkproofError("picture of a sweep: expected designs and figures of theirs, got none; sweep something")
    designs = drawn_designs(dataset, own or {}, always)
    if designs.are_lines:
        return parallel_figure(designs)
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
        star = [] if best is None else [_star("", places[best], values[best])]
        fails = np.flatnonzero(np.diff(np.concatenate([[False], np.isnan(values), [False]])))
        panels.append(
            Panel((curve, *star), designs.label(parameter), designs.scale(name), uprights, names="",
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
    own = [_marker("", designs.own_place, *DIAMOND)] if designs.own_place else []
    panels = []
    for name in designs.figures:
        values, best = designs.values(name), designs.best(name)
        column, row = np.unravel_index(best or 0, values.shape)
        marks = own if best is None else [*own, _star("", across[column], upward[row])]
        surface = Surface(*edges, values.T, designs.scale(name), designs.span(name))
        whole = Hatch(edges[0][[[0, -1]]][: bool(designs.failing(name))])
        outlined = [mark for curve in marks for mark in (replace(curve, ink="paper", size=curve.size + 3.0), curve)]
        panels.append(Panel(tuple(outlined), *axes, names="", title=designs.label(name), hatch=whole, surface=surface))
    height = MAP * -(-len(panels) // columns) * (1.25 if columns < 3 else 1.0)
    key = _key(designs, _marker(OWN, (0.0, 0.0), *DIAMOND))
    return Chart(tuple(panels), height, columns, wide=len(panels) > 1, head=designs.head, key=key)


def _edges(places: Array) -> Array:
    """Where the cells of ascending places end, half-way between neighbours: (places + 1,)."""
    if len(places) == 1:
        return places + 0.5 * (abs(places[0]) or 1.0) * np.array([-1.0, 1.0])
    first, last = 1.5 * places[[0, -1]] - 0.5 * places[[1, -2]]
    return np.concatenate([[first], 0.5 * (places[1:] + places[:-1]), [last]])


def _key(designs: DrawnDesigns, own: Curve) -> tuple[Curve | Hatch, ...]:
    """The key: stars, the design of the file, and the hatch of designs that do not assemble."""
    meanings = dict.fromkeys(designs.target(name)[1] for name in designs.figures if designs.best(name) is not None)
    fails = any(map(designs.failing, designs.figures))
    return (*map(_star, meanings), *(own,) * bool(designs.own_place), *(Hatch(np.zeros((0, 2)), FAILS),) * fails)


def _marker(name: str, place: tuple[float, ...], marker: str, size: float, ink: str = "ink") -> Curve:
    x, y = np.reshape(place, (2, 1))
    return Curve(x, y, name, ink, line="", marker=marker, size=size)


def _star(name: str, *place: float) -> Curve:
    """The best design, or its entry in the key."""
    return _marker(name, place or (0.0, 0.0), "*", 9.0, "limit")
