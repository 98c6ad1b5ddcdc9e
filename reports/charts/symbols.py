"""Symbols of a kinematic scheme: bars, plates, pins, fixed pivots, sliders on hatched guides, slots, springs.

Each is drawn into axes of equal aspect, and nothing is returned. Places are (2,), lengths in the unit of the axes;
``size`` is the radius of a pin in that unit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon, Wedge
from numpy.typing import ArrayLike

from reports.charts.draw import INK, MUTED, PAPER, PLATE, Array

SLOT = (PAPER, 0.7)  # lines behind a slot stay visible
AROUND = np.exp(1j * np.arange(0.1, 2.0 * np.pi, 0.01))  # directions, none of them one that a drawing is likely to have


def outline(points: Array) -> Array:
    """The corners, (k, 2), of the convex hull of (n, 2) points, in order; the two ends for points on one line.

    Fewer than two points are returned unchanged.
    """
    if len(points) < 2:
        return points
    farthest = np.argmax(points @ np.array([AROUND.real, AROUND.imag]), axis=0)
    return points[list(dict.fromkeys(farthest.tolist()))]


def unit(span: ArrayLike) -> Array:
    """The unit vector, (2,), along a vector; zeros for one without length."""
    vector = np.asarray(span, dtype=float)
    return np.asarray(vector / (float(np.hypot(*vector)) or 1.0))


def left(vector: Array) -> Array:
    """A vector (2,) turned by a quarter of a turn counter-clockwise."""
    return np.array([-vector[1], vector[0]])


def line(axes: Axes, places: ArrayLike, width: float, layer: float, ink: str = INK, **style: Any) -> None:  # noqa: ANN401
    """Draw a line of a ``width`` in points and an ``ink``, a colour, through (n, 2) places; nan parts it.

    A higher ``layer`` covers lower ones. ``style`` goes to matplotlib's Line2D.
    """
    axes.add_artist(Line2D(*np.transpose(places), color=ink, linewidth=width, zorder=layer, **style))


def _area(axes: Axes, corners: ArrayLike, width: float, layer: float, face: Any = PAPER) -> None:  # noqa: ANN401
    """Draw a polygon, filled with ``face``, a colour or (colour, opacity), with an outline of a ``width`` in points.

    A higher ``layer`` covers lower ones.
    """
    axes.add_patch(Polygon(np.asarray(corners), facecolor=face, edgecolor=INK, linewidth=width, zorder=layer))


def _box(start: Array, end: Array, half: float) -> list[Array]:
    """The four corners of a box, twice ``half`` wide, around the line from ``start`` to ``end``."""
    across = half * left(unit(end - start))
    return [start + across, end + across, end - across, start - across]


def bar(axes: Axes, points: Array, layer: float) -> None:
    """Draw a link of (n, 2) points: a round-ended bar if they are on one line, else a plate, their convex hull.

    A higher ``layer`` covers lower ones.
    """
    corners = outline(points)
    if len(corners) > 2:
        _area(axes, corners, 1.56, layer, PLATE)
    else:
        line(axes, corners, 2.6, layer, solid_capstyle="round")


def cylinder(axes: Axes, start: Array, end: Array, size: float) -> None:
    """Draw a cylinder: its barrel from the first point to the middle, its rod on to the second."""
    line(axes, (start, end), 1.6, 6.0)
    _area(axes, _box(start, 0.5 * (start + end), size), 1.2, 6.1)


def pin(axes: Axes, place: Array, size: float, layer: float = 8.0) -> None:
    """Draw a revolute joint, a circle of the radius ``size``; a higher ``layer`` covers lower ones."""
    axes.add_patch(Circle((place[0], place[1]), size, facecolor=PAPER, edgecolor=INK, linewidth=1.0, zorder=layer))


def fixed_pivot(axes: Axes, place: Array, size: float) -> None:
    """Draw a pin on the ground: a triangle on a hatched line, and the pin on top."""
    feet = [place - (reach * size, 3.4 * size) for reach in (3.2, 2.0, -2.0, -3.2)]
    _area(axes, [place, *feet[1:3]], 0.9, 6.5)
    hatched_line(axes, feet[0], feet[3], size)
    pin(axes, place, size)


def hatched_line(axes: Axes, start: Array, end: Array, size: float) -> None:
    """Draw ground: a line with short strokes on its right side, seen from start to end."""
    along = unit(end - start)
    feet = start + np.outer(np.arange(0.5 * size, float(np.hypot(*(end - start))), 1.25 * size), along)
    strokes = [(foot, foot - 1.1 * size * (left(along) + along), (np.nan, np.nan)) for foot in feet]
    line(axes, np.reshape(strokes, (-1, 2)), 0.6, 6.0)
    line(axes, (start, end), 0.9, 6.0)


def slider(axes: Axes, place: Array, along: Array, size: float) -> None:
    """Draw the block of a slider at ``place``, lying along its guide, whose direction is the unit vector ``along``."""
    _area(axes, _box(place - 2.6 * size * along, place + 2.6 * size * along, 1.6 * size), 1.0, 7.0, PLATE)


def guide(axes: Axes, start: Array, end: Array, side: float, size: float) -> None:
    """Draw a guide on the ground: its centre line, and a rail on one ``side`` (+1 left, -1 right)."""
    along = size * unit(end - start)
    line(axes, (start - 6.0 * along, end + 6.0 * along), 0.7, 1.5, MUTED, linestyle=(0, (9, 2.5, 1.5, 2.5)))
    rail = [place + 1.7 * side * left(along) for place in (start - 3.2 * along, end + 3.2 * along)]
    hatched_line(axes, rail[side > 0.0], rail[side < 0.0], size)


def slot(axes: Axes, start: Array, end: Array, size: float) -> None:
    """Draw a slot of a moving link over a pin's travel: an outlined box around it, closed at both ends."""
    along = 2.6 * size * unit(end - start)
    _area(axes, _box(start - along, end + along, 1.7 * size), 1.0, 5.5, SLOT)


def mass_centre(axes: Axes, place: Array, link: Array, size: float) -> None:
    """Draw the quartered disc of a mass centre at ``place``, tied by a dotted line to ``link``, a place of its link."""
    line(axes, (link, place), 0.6, 4.5, linestyle=(0, (1, 1.6)))
    pin(axes, place, 0.8 * size, 9.0)
    for start in (0.0, 180.0):
        quarter = (place[0], place[1]), 0.8 * size, start, start + 90.0
        axes.add_patch(Wedge(*quarter, facecolor=INK, linewidth=0.0, zorder=9.1))


def spring(axes: Axes, start: Array, end: Array, size: float) -> None:
    """Draw a zigzag between two points, of as many turns as its length has room for, 5 to 40 corners."""
    turns = int(np.clip(0.4 * float(np.hypot(*(end - start))) / size, 5, 40))
    share = np.concatenate([[0.0, 0.2], np.linspace(0.21, 0.79, turns), [0.8, 1.0]])
    height = np.concatenate([[0.0, 0.0], 1.5 * size * (-1.0) ** np.arange(turns), [0.0, 0.0]])
    line(axes, start + np.outer(share, end - start) + np.outer(height, left(unit(end - start))), 0.8, 4.6)


def eye(axes: Axes, place: Array, size: float) -> None:
    """Draw a point of a link where nothing is pinned, a dot."""
    axes.add_patch(Circle((place[0], place[1]), 0.6 * size, facecolor=INK, linewidth=0.0, zorder=8.0))
