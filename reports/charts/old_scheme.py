"""The kinematic scheme in twelve crank positions, one of them drawn out with its joints and guides."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Guide, Linkage, Vector
from analytic.kinematics.crank_range import crank_range
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from reports.charts import symbols
from reports.charts.style import INK, MUTED, plane, scaled_figure
from reports.records.views import View

Array = NDArray[np.float64]

POSITIONS = 12
TURN_POINTS = 361
INSET = 1e-9  # of a range that ends in dead positions, so that its ends are assembled
MILLIMETRE = 1e3
GHOST, PATH = "#a8b8c8", "#0072b2"
LARGEST_WIDTH, LARGEST_HEIGHT, SMALLEST_WIDTH = 6.2, 5.6, 2.4
NUMBER_STYLE = {"fontsize": 6.5, "color": MUTED, "zorder": 4.0}
NAME_STYLE = {
    "fontsize": 8.5,
    "fontstyle": "italic",
    "color": INK,
    "zorder": 12.0,
    "bbox": {"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
}


@dataclass(frozen=True)
class KinematicScheme:
    """Where everything is: over twelve positions, and over the whole turn or motion.

    ``scale`` is what a metre measures in the drawing's unit, which is mm unless it says otherwise.
    """

    linkage: Linkage
    few: Sweep
    turn: Sweep
    scale: float = MILLIMETRE

    def places(self, sweep: Sweep, body: str, locals_: Iterable[Vector]) -> Array:
        """Points of a body, (points, 2, positions)."""
        parts = [np.broadcast_arrays(*sweep.local_point(body, local), sweep.angle)[:2] for local in locals_]
        return self.scale * np.array(parts, dtype=float)

    def link_points(self, link: str) -> list[Vector]:
        """The named points that make a link's shape."""
        return list(self.linkage.links[link].points.values())

    def shown_places(self, body: str, locals_: Iterable[Vector]) -> Array:
        """Points of a body in the position drawn out, (points, 2)."""
        return self.places(self.few, body, locals_)[:, :, self.shown]

    @cached_property
    def spots(self) -> dict[str, Array]:
        """Every named point in the position drawn out."""
        names = {p for link in self.linkage.links.values() for p in link.points} | set(self.linkage.ground)
        return {name: self.scale * self.few.point(name)[:, self.shown] for name in sorted(names)}

    def direction(self, guide: Guide) -> Array:
        """Unit vector of a guide in the position drawn out."""
        start, end = self.shown_places(guide.host, [(0.0, 0.0), guide.along])
        return np.asarray((end - start) / np.hypot(*(end - start)))

    def travel(self, guide: Guide, body: str, point: str) -> tuple[Vector, Vector]:
        """The two ends, in the host's frame, between which a point moves along a guide over the turn."""
        (x, y), (u, v) = guide.through, guide.along
        ends = self.places(self.turn, guide.host, [guide.through, (x + u, y + v)])
        pin = self.places(self.turn, body, [self.linkage.local(point, body)])[0]
        along = np.sum((pin - ends[0]) * (ends[1] - ends[0]), axis=0) / self.scale**2
        low, high = float(np.min(along)), float(np.max(along))
        return (x + low * u, y + low * v), (x + high * u, y + high * v)

    @cached_property
    def shown(self) -> int:
        """The position to draw out: the one whose points lie farthest apart."""
        names = {point for link in self.linkage.links.values() for point in link.points}
        places = self.scale * np.array([self.few.point(name) for name in sorted(names)])
        apart = np.hypot(*np.moveaxis(places[:, None] - places[None, :], 2, 0))
        apart[np.arange(len(names)), np.arange(len(names))] = np.inf
        return int(np.argmax(np.min(apart, axis=(0, 1))))

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Lowest and highest x and y ever reached, mm."""
        moving = [self.places(self.turn, name, link.points.values()) for name, link in self.linkage.links.items()]
        spots = np.concatenate([part.transpose(0, 2, 1).reshape(-1, 2) for part in moving])
        spots = np.concatenate([spots, self.scale * np.array(list(self.linkage.ground.values())).reshape(-1, 2)])
        return spots.min(axis=0), spots.max(axis=0)


def scheme_of(mechanism: Mechanism) -> KinematicScheme:
    """The scheme of a mechanism at every 30° from φ = 0, or in twelve positions of the range it reaches."""
    reach = crank_range(mechanism)
    low, high = (0.0, 2.0 * np.pi) if reach.is_full_turn else reach.limits
    inset = 0.0 if reach.is_full_turn else INSET * (high - low)
    few = np.linspace(low + inset, high - inset, POSITIONS, endpoint=not reach.is_full_turn)
    many = np.linspace(low + inset, high - inset, TURN_POINTS)
    return KinematicScheme(mechanism.linkage, mechanism.sweep(few), mechanism.sweep(many))


def scheme_figure(view: View) -> Figure:
    """The scheme on a page of its own, to scale in both directions."""
    return mechanism_figure(view.mechanism)


def mechanism_figure(mechanism: Mechanism) -> Figure:
    """The scheme of a mechanism, to scale in both directions."""
    scheme = scheme_of(mechanism)
    largest, draw = (LARGEST_WIDTH, LARGEST_HEIGHT), partial(draw_scheme, scheme=scheme)
    return scaled_figure(scheme.extent, 0.42, largest, SMALLEST_WIDTH, draw)


def draw_scheme(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """All positions faintly, one drawn out; ``size`` is a pin's radius in mm. The axes' limits are the caller's."""
    plane(axes, 4, 8)
    _ghosts(axes, scheme)
    _paths(axes, scheme)
    taken = draw_position(axes, scheme, size)
    _crank_numbers(axes, scheme, size, taken)


def draw_position(axes: Axes, scheme: KinematicScheme, size: float) -> Array:
    """The position drawn out, with guides, links, joints and names; returns where the names stand, (names, 2), mm."""
    _guides(axes, scheme, size)
    _links(axes, scheme, size)
    _joints(axes, scheme, size)
    return _names(axes, scheme, size)


def _ghosts(axes: Axes, scheme: KinematicScheme) -> None:
    """Every link in every position, as thin lines."""
    lines = []
    for link in scheme.linkage.links:
        places = scheme.places(scheme.few, link, scheme.link_points(link))
        for spots in places.transpose(2, 0, 1) if len(places) > 1 else ():
            corners = symbols.outline(spots)
            lines.append(corners if len(corners) == 2 else np.vstack([corners, corners[:1]]))
    axes.add_collection(LineCollection(lines, colors=GHOST, linewidths=0.7, zorder=2.0))


def _paths(axes: Axes, scheme: KinematicScheme) -> None:
    """The circle or curve of every moving pin, the output's in colour."""
    output = scheme.linkage.output.point if scheme.linkage.output else None
    for point in sorted({point for link in scheme.linkage.links.values() for point in link.points}):
        path = scheme.scale * scheme.turn.point(point)
        if point == output:
            axes.plot(*path, color=PATH, linewidth=2.4, alpha=0.75, solid_capstyle="round", zorder=3.0)
            spots = scheme.scale * scheme.few.point(point)
            axes.plot(*spots, linestyle="none", marker="o", markersize=2.2, color=PATH, zorder=3.1)
        elif float(np.max(np.ptp(path, axis=1))) > 1e-6:
            axes.plot(*path, color=GHOST, linewidth=0.7, linestyle=(0, (2, 2)), zorder=1.8)


def _crank_numbers(axes: Axes, scheme: KinematicScheme, size: float, taken: Array) -> None:
    """0 to 11 around the crank pin's circle, but for the position drawn out and where a name is in the way."""
    if scheme.linkage.is_linear:
        return
    link = scheme.linkage.links[scheme.linkage.crank]
    pivot = next(p.point for p in scheme.linkage.pins if {GROUND, link.name} <= set(p.links))
    far = max(link.points, key=lambda name: float(np.hypot(*np.subtract(link.points[name], link.points[pivot]))))
    if far == pivot:  # a crank that is nothing but a slot has no pin to number
        return
    spots, centre = scheme.scale * scheme.few.point(far), scheme.scale * scheme.few.point(pivot)
    arm = spots - centre
    places = centre + arm * (1.0 + 2.4 * size / np.hypot(*arm))
    for number in sorted(set(range(POSITIONS)) - {scheme.shown}):
        if np.min(np.hypot(*(taken - places[:, number]).T)) > 3.0 * size:
            write(axes, places[:, number], str(number), NUMBER_STYLE)


def _guides(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Guides of sliders and slots in the position drawn out, over the travel they see."""
    runs = [(s.guide, s.link, s.point) for s in scheme.linkage.sliders]
    runs += [(s.guide, scheme.few.carrier(s.point), s.point) for s in scheme.linkage.slots]
    for guide, body, point in runs:
        start, end = scheme.shown_places(guide.host, scheme.travel(guide, body, point))
        if guide.host == GROUND:
            symbols.guide(axes, start, end, _free_side(scheme, point, end - start), size)
        else:
            symbols.slot(axes, start, end, size)


def _free_side(scheme: KinematicScheme, point: str, along: Array) -> float:
    """+1 where the left of a guide is clear of the links that lead to its slider, -1 where the right is."""
    pull = _pull(point, scheme)
    return -1.0 if float(along[0] * pull[1] - along[1] * pull[0]) > 0.0 else 1.0


def _links(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """The links of the position drawn out, springs, blocks of sliders, mass centres clear of the joints."""
    linkage = scheme.linkage
    for number, name in enumerate(linkage.links):
        spots = scheme.shown_places(name, scheme.link_points(name))
        if len(spots) > 1:
            symbols.bar(axes, spots, 2.6, INK, 5.0 + 0.01 * number)
    for spring in linkage.springs:
        ends = zip(spring.links, spring.points, strict=True)
        start, end = (scheme.shown_places(body, [linkage.local(point, body)])[0] for body, point in ends)
        symbols.spring(axes, start, end, size)
    if linkage.cylinder is not None:
        ends = zip(linkage.cylinder.links, linkage.cylinder.points, strict=True)
        start, end = (scheme.shown_places(body, [linkage.local(point, body)])[0] for body, point in ends)
        symbols.cylinder(axes, start, end, size)
    for slider in linkage.sliders:
        symbols.slider(axes, scheme.spots[slider.point], scheme.direction(slider.guide), size)
    _mass_centres(axes, scheme, size)


def _mass_centres(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Mass centres of turning links that are clear of the joints, tied to their link."""
    joints = np.array(list(scheme.spots.values()))
    for name, link in scheme.linkage.links.items():
        if link.inertia is not None and link.points:
            start, spot = scheme.shown_places(name, [scheme.link_points(name)[0], link.centre])
            if float(np.min(np.hypot(*(joints - spot).T))) > 1.6 * size:
                symbols.leader(axes, start, spot)
                symbols.mass_centre(axes, spot, size)


def _joints(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Pins, fixed pivots, pins in slots, and the points where nothing is pinned."""
    linkage = scheme.linkage
    held = {end for spring in linkage.springs for end in spring.points} | {slot.point for slot in linkage.slots}
    pivots = {pin.point for pin in linkage.pins if GROUND in pin.links} | (held & set(linkage.ground))
    pins = {pin.point for pin in linkage.pins} | {s.point for s in linkage.slots} | {s.point for s in linkage.sliders}
    for name, spot in scheme.spots.items():
        if name in pivots:
            symbols.fixed_pivot(axes, spot, size)
        elif name in pins:
            symbols.pin(axes, spot, size)
        else:
            symbols.eye(axes, spot, size)


def _names(axes: Axes, scheme: KinematicScheme, size: float) -> Array:
    """Names of the points beside them, on the side no link leaves from; returns where they stand, (names, 2)."""
    places = []
    across = {s.point: _across(scheme.direction(s.guide)) for s in scheme.linkage.sliders}
    for name, spot in scheme.spots.items():
        away = -_pull(name, scheme)
        length = float(np.hypot(*away))
        away = away / length if length > 1e-6 else np.array([0.8, 0.6])
        reach = 3.6 * size
        if name in across:  # the rail is on the side away from the links, the name goes to theirs
            side = 1.0 if float(across[name] @ away) <= 0.0 else -1.0
            away, reach = side * across[name], 4.0 * size
        elif name in scheme.linkage.ground and away[1] < 0.2:  # the hatched foot hangs below
            away = np.array([np.copysign(0.95, away[0]), 0.3])
        places.append(spot + reach * away)
        write(axes, places[-1], name, NAME_STYLE)
    return np.array(places)


def write(axes: Axes, place: Array, text: str, style: dict[str, Any]) -> None:
    """Centred text."""
    axes.text(float(place[0]), float(place[1]), text, ha="center", va="center", **style)


def _across(along: Array) -> Array:
    return np.array([-along[1], along[0]])


def _pull(name: str, scheme: KinematicScheme) -> Array:
    """Sum of the unit vectors from a point to its neighbours on the links that carry it."""
    links = [link.points for link in scheme.linkage.links.values() if name in link.points]
    spans = [scheme.spots[other] - scheme.spots[name] for points in links for other in points if other != name]
    return np.asarray(sum((span / (float(np.hypot(*span)) or 1.0) for span in spans), np.zeros(2)))
