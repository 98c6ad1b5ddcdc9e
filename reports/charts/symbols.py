"""Symbols of a kinematic scheme: bars, plates, pins, fixed pivots, sliders on hatched guides, slots, springs.

Lengths are in the unit of the axes, which have equal aspect; ``size`` is the radius of a pin in that unit.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon, Wedge
from numpy.typing import ArrayLike, NDArray

from reports.charts.style import INK, MUTED, PAPER, PLATE

Array = NDArray[np.float64]
SLOT = (PAPER, 0.7)  # what passes behind a slot stays visible


def outline(points: Array) -> Array:
    """The corners of the convex hull of (n, 2) points, in turn; two ends where the points lie on one line."""
    order = np.lexsort((points[:, 1], points[:, 0]))
    chains = [_half_hull(points[order]), _half_hull(points[order[::-1]])]
    return np.array(chains[0][:-1] + chains[1][:-1])


def _half_hull(points: Array) -> list[Array]:
    chain: list[Array] = []
    scale = float(np.ptp(points, axis=0).max()) ** 2
    for point in points:
        while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 1e-9 * scale:
            chain.pop()
        chain.append(point)
    return chain


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def bar(axes: Axes, points: Array, width: float, ink: str, layer: float) -> None:
    """A link: a round-ended bar between two points, a plate for three or more."""
    corners = outline(points) if len(points) > 1 else points
    if len(corners) > 2:
        axes.add_patch(
            Polygon(corners, closed=True, facecolor=PLATE, edgecolor=ink, linewidth=width * 0.6, joinstyle="round",
                    zorder=layer)
        )  # fmt: skip
    else:
        axes.plot(*corners.T, color=ink, linewidth=width, solid_capstyle="round", zorder=layer)


def cylinder(axes: Axes, start: Array, end: Array, size: float) -> None:
    """A driver between two points: its barrel from the first to the middle, its rod to the second."""
    along = (end - start) / (float(np.hypot(*(end - start))) or 1.0)
    across, middle = size * np.array([-along[1], along[0]]), 0.5 * (start + end)
    axes.plot(*np.array([start, end]).T, color=INK, linewidth=1.6, zorder=6.0)
    corners = np.array([start + across, middle + across, middle - across, start - across])
    axes.add_patch(Polygon(corners, closed=True, facecolor=PAPER, edgecolor=INK, linewidth=1.2, zorder=6.1))


def pin(axes: Axes, place: ArrayLike, size: float, layer: float = 8.0) -> None:
    """A revolute joint."""
    axes.add_patch(Circle(tuple(np.asarray(place)), size, facecolor=PAPER, edgecolor=INK, linewidth=1.0, zorder=layer))


def fixed_pivot(axes: Axes, place: ArrayLike, size: float) -> None:
    """A pin on the ground: a triangle on a hatched line, and the pin on top."""
    x, y = np.asarray(place)
    low, half = y - 3.4 * size, 2.0 * size
    corners = [(x, y), (x - half, low), (x + half, low)]
    axes.add_patch(Polygon(corners, closed=True, facecolor=PAPER, edgecolor=INK, linewidth=0.9, zorder=6.5))
    hatched_line(axes, (x - 1.6 * half, low), (x + 1.6 * half, low), size)
    pin(axes, place, size)


def hatched_line(axes: Axes, start: ArrayLike, end: ArrayLike, size: float, ink: str = INK) -> None:
    """Ground: a line with short strokes on its right side, seen from start to end."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.hypot(*(b - a)))
    along = (b - a) / length
    across = np.array([along[1], -along[0]])
    feet = a + np.outer(np.arange(0.5 * size, length, 1.25 * size), along)
    gap = np.full(2, np.nan)
    strokes = np.array([point for foot in feet for point in (foot, foot + 1.1 * size * (across - along), gap)])
    axes.plot(*strokes.reshape(-1, 2).T, color=ink, linewidth=0.6, zorder=6.0)
    axes.plot(*np.array([a, b]).T, color=ink, linewidth=0.9, zorder=6.0)


def slider(axes: Axes, place: ArrayLike, along: ArrayLike, size: float) -> None:
    """The block of a slider, lying along its guide."""
    centre, x = np.asarray(place, dtype=float), np.asarray(along, dtype=float)
    y = np.array([-x[1], x[0]])
    corners = [centre + 2.6 * size * i * x + 1.6 * size * j * y for i, j in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    axes.add_patch(Polygon(corners, closed=True, facecolor=PLATE, edgecolor=INK, linewidth=1.0, zorder=7.0))


def guide(axes: Axes, start: ArrayLike, end: ArrayLike, side: float, size: float) -> None:
    """A guide on the ground over a slider's travel: its centre line, and a rail on one side (+1 left, -1 right)."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    along = (b - a) / (float(np.hypot(*(b - a))) or 1.0)
    left = np.array([-along[1], along[0]])
    centre_line(axes, a - 6.0 * size * along, b + 6.0 * size * along)
    ends = (a - 3.2 * size * along + side * 1.7 * size * left, b + 3.2 * size * along + side * 1.7 * size * left)
    hatched_line(axes, *(ends if side < 0.0 else ends[::-1]), size)


def centre_line(axes: Axes, start: ArrayLike, end: ArrayLike) -> None:
    """A dash-dotted axis."""
    line = np.array([start, end], dtype=float)
    axes.plot(*line.T, color=MUTED, linewidth=0.7, linestyle=(0, (9, 2.5, 1.5, 2.5)), zorder=1.5)


def slot(axes: Axes, start: ArrayLike, end: ArrayLike, size: float) -> None:
    """A slot of a moving link over a pin's travel: two parallel walls, closed at both ends."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    along = (b - a) / (float(np.hypot(*(b - a))) or 1.0)
    across = 1.7 * size * np.array([-along[1], along[0]])
    a, b = a - 2.6 * size * along, b + 2.6 * size * along
    corners = [a + across, b + across, b - across, a - across]
    axes.add_patch(Polygon(corners, closed=True, facecolor=SLOT, edgecolor=INK, linewidth=1.0, zorder=5.5))


def mass_centre(axes: Axes, place: ArrayLike, size: float) -> None:
    """The quartered disc of a mass centre."""
    centre = tuple(np.asarray(place, dtype=float))
    axes.add_patch(Circle(centre, 0.8 * size, facecolor=PAPER, edgecolor=INK, linewidth=0.6, zorder=9.0))
    for start in (0.0, 180.0):
        axes.add_patch(Wedge(centre, 0.8 * size, start, start + 90.0, facecolor=INK, linewidth=0.0, zorder=9.1))


def spring(axes: Axes, start: ArrayLike, end: ArrayLike, size: float) -> None:
    """A zigzag between two points, of as many turns as its length has room for."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    span = b - a
    length = float(np.hypot(*span)) or 1.0
    across = np.array([-span[1], span[0]]) / length
    turns = int(np.clip(0.6 * length / (1.5 * size), 5, 40))
    share = np.concatenate([[0.0, 0.2], np.linspace(0.21, 0.79, turns), [0.8, 1.0]])
    height = np.concatenate([[0.0, 0.0], 1.5 * size * (-1.0) ** np.arange(turns), [0.0, 0.0]])
    axes.plot(*(a + np.outer(share, span) + np.outer(height, across)).T, color=INK, linewidth=0.8, zorder=4.6)


def leader(axes: Axes, start: ArrayLike, end: ArrayLike) -> None:
    """A thin dotted line that ties a mass centre to its link."""
    line = np.array([start, end], dtype=float)
    axes.plot(*line.T, color=INK, linewidth=0.6, linestyle=(0, (1, 1.6)), zorder=4.5)


def eye(axes: Axes, place: ArrayLike, size: float) -> None:
    """A point of a link where nothing is pinned."""
    axes.add_patch(Circle(tuple(np.asarray(place)), 0.6 * size, facecolor=INK, linewidth=0.0, zorder=8.0))
