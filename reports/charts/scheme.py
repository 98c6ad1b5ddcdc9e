"""A linkage in its saved positions: where its points are, one position of them drawn out."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import GROUND, CylinderDrive, Guide, Linkage, Spring
from analytic.description.written import file_unit
from comparisons.designer.sheet import Positions, ThreadSheet
from reports.charts import symbols
from reports.charts.draw import FONT_SIZE, GHOST, INK, PALETTE, PAPER, Array, Host, drawn, inches

POSITIONS = 12


@dataclass(frozen=True)
class KinematicScheme:
    """A linkage in its positions; ``where`` is the place on their axis that is drawn out, the clearest if None.

    All places are in the unit of length of the linkage's file; the axis is φ, rad or m, or the time, s.
    """

    linkage: Linkage
    positions: Positions
    where: float | None = None

    @cached_property
    def scale(self) -> float:
        """Length of one metre in the drawing's unit, which is the file's unit of length."""
        return 1.0 / file_unit("m", self.linkage).size

    @property
    def shown_indices(self) -> NDArray[np.intp]:
        """Indices of the positions that are shown, twelve, evenly spread."""
        last = len(self.positions.axis) - 1
        return np.rint(np.linspace(0, last, POSITIONS, endpoint=not self.positions.closed)).astype(np.intp)

    def path(self, body: str, locals_: Iterable[ArrayLike]) -> Array:
        """Points of a body, given in its frame, m, over all positions, (points, 2, n), in the drawing's unit.

        A body without positions is the ground.
        """
        x, y, angle = self.positions.bodies.get(body, np.zeros((3, len(self.positions.axis))))
        u, v = np.array(list(locals_), dtype=float).reshape(-1, 2, 1).swapaxes(0, 1)
        c, s = np.cos(angle), np.sin(angle)
        return self.scale * np.stack([x + c * u - s * v, y + s * u + c * v], axis=1)

    def at(self, course: Array) -> Array:
        """Values over all positions, (..., n), interpolated at the position drawn out: (...,)."""
        where = self.positions.axis[self.shown_indices[self.clearest]] if self.where is None else self.where
        rows = course.reshape(-1, course.shape[-1])
        return np.array([np.interp(where, self.positions.axis, row) for row in rows]).reshape(course.shape[:-1])

    def shown(self, body: str, locals_: Iterable[ArrayLike]) -> Array:
        """Points of a body, given in its frame, m, in the position drawn out, (points, 2), in the drawing's unit."""
        return self.at(self.path(body, locals_))

    @cached_property
    def carriers(self) -> dict[str, str]:
        """A body that carries each named point, by the point: a moving link before the ground."""
        moving = {point: name for name, link in self.linkage.links.items() for point in link.points}
        return dict.fromkeys(self.linkage.ground, GROUND) | moving

    @property
    def joined(self) -> set[str]:
        """Names of the points of pins, sliders and slots, where links are joined."""
        of = self.linkage
        return {p.point for p in of.pins} | {s.point for s in of.sliders} | {s.point for s in of.slots}

    @cached_property
    def paths(self) -> dict[str, Array]:
        """Every named point over all positions, (2, n), in the drawing's unit, the file's of length."""
        return {p: self.path(b, [self.linkage.local(p, b)])[0] for p, b in sorted(self.carriers.items())}

    @cached_property
    def spots(self) -> dict[str, Array]:
        """Every named point in the position drawn out, (2,), in the drawing's unit, the file's of length."""
        return {point: self.at(path) for point, path in self.paths.items()}

    @cached_property
    def clearest(self) -> int:
        """Index, among the shown positions, of the one whose two nearest moving points lie farthest apart."""
        places = np.array(
            [path[:, self.shown_indices] for point, path in self.paths.items() if self.carriers[point] != GROUND]
        )
        apart = np.hypot(*np.moveaxis(places[:, None] - places[None, :], 2, 0))
        apart[np.arange(len(places)), np.arange(len(places))] = np.inf
        return int(np.argmax(np.min(apart, axis=(0, 1))))

    def direction(self, guide: Guide) -> Array:
        """Unit vector, (2,), of a guide in the position drawn out."""
        start, end = self.shown(guide.host, [(0.0, 0.0), guide.along])
        return symbols.unit(end - start)

    @property
    def runs(self) -> list[tuple[Guide, str, str]]:
        """The guides of sliders, then of slots, each with the body, and its point, that moves along it."""
        sliders = [(s.guide, s.link, s.point) for s in self.linkage.sliders]
        return sliders + [(s.guide, self.positions.carriers[s.point], s.point) for s in self.linkage.slots]

    def reach(self, guide: Guide, body: str, point: str) -> Array:
        """The ends of a body's point's travel over all positions along a guide, in its host's frame, m, (2, 2).

        ``body`` carries ``point``, which moves along ``guide``.
        """
        start, end = self.path(guide.host, [guide.through, np.add(guide.through, guide.along)])
        pin = self.path(body, [self.linkage.local(point, body)])[0]
        course = np.sum((pin - start) * (end - start), axis=0) / self.scale**2
        return np.array([guide.through + reach * np.array(guide.along) for reach in (course.min(), course.max())])

    def travel(self, guide: Guide, body: str, point: str) -> Array:
        """The ends of a point's travel along a guide, as it lies in the position drawn out, (2, 2), drawing's unit.

        The point is one of ``body``.
        """
        return self.shown(guide.host, self.reach(guide, body, point))

    @cached_property
    def stretches(self) -> dict[str, Array]:
        """Both ends of every spring, damper and cylinder over all positions, (2, 2, n), in the drawing's unit.

        They are called "spring:0" and so on, in the linkage's order, and "cylinder".
        """
        between: dict[str, Spring | CylinderDrive] = {f"spring:{n}": s for n, s in enumerate(self.linkage.springs)}
        both = between | ({"cylinder": self.linkage.cylinder} if self.linkage.cylinder else {})
        return {name: np.concatenate([self.path(body, [self.linkage.local(point, body)])
                                      for point, body in zip(entry.points, entry.links, strict=True)])
                for name, entry in both.items()}  # fmt: skip

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Lowest and highest x and y that a named point ever reaches, (2,) each, in the drawing's unit."""
        spots = np.concatenate([path.T for path in self.paths.values()])
        return spots.min(axis=0), spots.max(axis=0)


# The kinematic scheme in twelve positions, one of them drawn out with its joints and guides.


# Inches: the largest drawing, the narrowest, room for words left and below, around the linkage, a pin's radius.
LARGEST, NARROWEST, WORDS, ROOM, PIN = np.array([5.4, 5.4]), 2.4, np.array([0.68, 0.58]), 0.42, 0.042
# The same of a small drawing: its largest size, its rim, a pin's radius.
CARD, RIM, SMALL_PIN = np.array([1.9, 1.5]), 0.17, 0.031
Extent = tuple[Array, Array]  # lowest and highest x and y
Draw = Callable[[Axes, KinematicScheme, float], None]
BEHIND = {"boxstyle": "round,pad=0.1", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.8}
NAME_STYLE: Final[dict[str, Any]] = {
    "ha": "center", "va": "center", "fontsize": FONT_SIZE, "fontstyle": "italic", "zorder": 12.0, "bbox": BEHIND,
}  # fmt: skip


def scheme_figure(linkage: Linkage, positions: Positions) -> Figure:
    """A figure of the linkage in twelve of its positions, to scale in both directions, one of them drawn out."""
    scheme = KinematicScheme(linkage, positions)
    return scaled_figure(scheme, scheme.extent, draw_scheme)


def card_figure(linkage: Linkage, positions: Positions) -> Figure:
    """A small figure of the linkage in its clearest position with the paths of its points, without axes and names."""
    scheme = KinematicScheme(linkage, positions)
    low, high = scheme.extent
    scale = float(np.min((CARD - 2.0 * RIM) / np.maximum(high - low, 1e-9)))
    rim = RIM / scale

    def place_small(figure: Figure) -> None:
        """Draw paths and position into a figure, to its edges."""
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set(xlim=(low[0] - rim, high[0] + rim), ylim=(low[1] - rim, high[1] + rim))
        draw_paths(axes, scheme)
        draw_position(axes, scheme, SMALL_PIN / scale, masses=False)

    width, height = map(float, scale * (high - low) + 2.0 * RIM)
    return drawn(width, height, place_small, placed=False)


def scaled_figure(scheme: KinematicScheme, extent: Extent, draw: Draw, wide: float | None = None) -> Figure:
    """A figure of the plane between two corners, in the file's unit; ``draw`` gets axes, scheme and a pin's radius.

    It is ``wide``, in, and half as high again at most; with None as wide as it needs to be, 5.4 in at most each way.
    """
    largest = LARGEST if wide is None else np.array([wide, 1.5 * wide])
    narrowest = NARROWEST if wide is None else wide - WORDS[0]
    span = np.maximum(extent[1] - extent[0], 1e-9)
    scale = float(np.min((largest - WORDS - 2.0 * ROOM) / span))
    size = np.maximum(span * scale + 2.0 * ROOM, (narrowest, 0.0)) + WORDS
    width, height = map(float, size)
    return drawn(width, height, lambda figure: place(figure, scheme, extent, draw), placed=False)


def place(host: Host, scheme: KinematicScheme, extent: Extent, draw: Draw) -> None:
    """Draw the plane between two corners, in the file's unit, to scale into a figure or a part of one.

    ``draw`` gets new axes, the scheme and a pin's radius.
    """
    whole = inches(host)
    box = whole - WORDS
    scale = float(np.min((box - 2.0 * ROOM) / np.maximum(extent[1] - extent[0], 1e-9)))
    axes = host.add_axes((*((WORDS - 0.08) / whole), *(box / whole)))
    (left, bottom), (right, top) = (0.5 * (sum(extent) + side * box / scale) for side in (-1.0, 1.0))
    unit = file_unit("m", scheme.linkage).name
    axes.set(xlim=(left, right), ylim=(bottom, top), xlabel=f"x, {unit}", ylabel=f"y, {unit}")
    axes.set_aspect("equal")
    axes.locator_params(nbins=6, steps=[1, 2, 5, 10])
    draw(axes, scheme, PIN / scale)


def draw_scheme(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Draw all shown positions faintly and one in full, with names; ``size`` is a pin's radius.

    Sets no limits of the axes.
    """
    _ghosts(axes, scheme)
    draw_paths(axes, scheme)
    draw_position(axes, scheme, size)
    draw_names(axes, scheme, size)


def draw_position(axes: Axes, scheme: KinematicScheme, size: float, *, masses: bool = True) -> None:
    """Draw one position in full: guides, links, springs, joints and, if wanted, mass centres.

    ``size`` is a pin's radius.
    """
    _guides(axes, scheme, size)
    _links(axes, scheme, size)
    if masses:
        _mass_centres(axes, scheme, size)
    _joints(axes, scheme, size)


def _ghosts(axes: Axes, scheme: KinematicScheme) -> None:
    """Draw every link in each of the twelve positions, as thin lines."""
    for name, link in scheme.linkage.links.items():
        corners = symbols.outline(np.array(list(link.points.values())).reshape(-1, 2))
        ring = np.vstack([corners, corners[: len(corners) > 2]])
        lines = scheme.path(name, ring)[:, :, scheme.shown_indices].transpose(2, 0, 1)
        axes.add_collection(LineCollection(list(lines), colors=GHOST, linewidths=0.7, zorder=2.0), autolim=False)


def draw_paths(axes: Axes, scheme: KinematicScheme) -> None:
    """Draw the curve of every point: the output's broad, those of points in no joint in colour, others dashed.

    Points on the ground, and others that stay in place, have none.
    """
    linkage = scheme.linkage
    output = linkage.output.point if linkage.output else None
    free = sorted(set(scheme.paths) - scheme.joined - set(linkage.ground) - {output})
    for point, path in scheme.paths.items():
        if point == output:
            symbols.line(axes, path.T, 2.4, 3.0, PALETTE[0], alpha=0.75, solid_capstyle="round")
        elif point in free:
            symbols.line(axes, path.T, 1.2, 3.0, PALETTE[1 + free.index(point) % (len(PALETTE) - 1)])
        elif float(np.max(np.ptp(path, axis=1))) > 1e-9 * scheme.scale:
            symbols.line(axes, path.T, 0.7, 1.8, GHOST, linestyle=(0, (2, 2)))


def _guides(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Draw guides of sliders and slots over their travel; a rail on the ground is on the side away from the links.

    ``size`` is a pin's radius.
    """
    for guide, body, point in scheme.runs:
        start, end = scheme.travel(guide, body, point)
        if guide.host == GROUND:
            side = -1.0 if float(symbols.left(end - start) @ _towards_links(point, scheme)) > 0.0 else 1.0
            symbols.guide(axes, start, end, side, size)
        else:
            symbols.slot(axes, start, end, size)


def _links(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Draw links, springs, a cylinder and the blocks of sliders; ``size`` is a pin's radius."""
    for number, (name, link) in enumerate(scheme.linkage.links.items()):
        spots = scheme.shown(name, link.points.values())
        if len(spots) > 1:
            symbols.bar(axes, spots, 5.0 + 0.01 * number)
    for name, ends in scheme.stretches.items():
        (start, end), draw = scheme.at(ends), symbols.cylinder if name == "cylinder" else symbols.spring
        draw(axes, start, end, size)
    for slider in scheme.linkage.sliders:
        symbols.slider(axes, scheme.spots[slider.point], scheme.direction(slider.guide), size)


def _mass_centres(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Draw the mass centres of links with inertia that are clear of the joints, tied to their link.

    ``size`` is a pin's radius.
    """
    joints = np.array(list(scheme.spots.values()))
    for name, link in scheme.linkage.links.items():
        if link.inertia is not None and link.points:
            start, spot = scheme.shown(name, [next(iter(link.points.values())), link.centre])
            if float(np.min(np.hypot(*(joints - spot).T))) > 1.6 * size:
                symbols.mass_centre(axes, spot, start, size)


def _joints(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Draw pins, fixed pivots, pins in slots, and points where nothing is pinned; ``size`` is a pin's radius."""
    linkage = scheme.linkage
    shared = {end for spring in linkage.springs for end in spring.points} | {slot.point for slot in linkage.slots}
    pivots = {pin.point for pin in linkage.pins if GROUND in pin.links} | (shared & set(linkage.ground))
    for name, spot in scheme.spots.items():
        draw = symbols.fixed_pivot if name in pivots else symbols.pin if name in scheme.joined else symbols.eye
        draw(axes, spot, size)


def draw_names(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Write the points' names on the side that no link leaves from; ``size`` is a pin's radius."""
    across = {s.point: symbols.left(scheme.direction(s.guide)) for s in scheme.linkage.sliders}
    for name, spot in scheme.spots.items():
        away, reach = symbols.unit(-_towards_links(name, scheme)), 3.8 * size
        if not away.any():
            away = np.array([0.8, 0.6])
        if name in across:  # the rail is on the side away from the links, the name goes to theirs
            side = 1.0 if float(across[name] @ away) <= 0.0 else -1.0
            away, reach = side * across[name], 4.2 * size
        elif name in scheme.linkage.ground and away[1] < 0.2:  # the hatched foot hangs below
            away = np.array([np.copysign(0.95, away[0]), 0.3])
        write_name(axes, spot + reach * away, name)


def write_name(axes: Axes, place: Array, name: str, ink: str = INK) -> None:
    """Write a name, centred at a place, (2,), of the axes, in the colour ``ink``."""
    axes.text(float(place[0]), float(place[1]), name, color=ink, **NAME_STYLE)


def _towards_links(name: str, scheme: KinematicScheme) -> Array:
    """The sum of unit vectors from a point to its neighbours on the same links, (2,); zeros without neighbours.

    ``name`` is the point's.
    """
    links = [link.points for link in scheme.linkage.links.values() if name in link.points]
    spans = [scheme.spots[other] - scheme.spots[name] for points in links for other in points if other != name]
    return np.round(sum(map(symbols.unit, spans), np.zeros(2)), 6)


# The thread's contour with the linkage, at the angle from which its feed is counted.

THREAD = PALETTE[1]


def thread_figure(linkage: Linkage, positions: Positions, thread: ThreadSheet) -> Figure:
    """A figure of the thread's contour with the linkage, to scale in both directions, where its feed is zero."""
    scheme = KinematicScheme(linkage, positions, thread.reference_angle)
    spots = scheme.scale * thread.contour
    low, high = scheme.extent
    extent = np.minimum(low, spots.min(axis=0)), np.maximum(high, spots.max(axis=0))
    return scaled_figure(scheme, extent, partial(_draw_thread, thread=thread))


def _draw_thread(axes: Axes, scheme: KinematicScheme, size: float, thread: ThreadSheet) -> None:
    """Draw the linkage, eyes' paths, the thread's contour and its fixed guides, with names; sets no limits of the axes.

    ``size`` is a pin's radius.
    """
    for path in thread.paths.values():
        symbols.line(axes, scheme.scale * path.T, 1.0, 2.0, GHOST, linestyle=(0, (3, 2)))
    draw_position(axes, scheme, size)
    draw_names(axes, scheme, size)
    spots = scheme.scale * thread.contour
    symbols.line(axes, spots, 1.6, 10.0, THREAD)
    for name, spot in zip(thread.stops, spots, strict=True):
        if name not in thread.paths:
            symbols.pin(axes, spot, 0.8 * size, 11.0)
            away = symbols.unit(spot - spots.mean(axis=0))  # its name on the side away from the thread
            write_name(axes, spot + 4.4 * size * away, name, THREAD)
