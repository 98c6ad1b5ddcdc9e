"""The thread: its contour in the linkage's plane and in space, and what it feeds over a turn."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]  # matplotlib types the plane only
from numpy.typing import NDArray

from analytic.description.thread_path import ThreadEye, ThreadGuide
from analytic.turn.thread_feed import contour, reference_angle
from reports.charts import symbols
from reports.charts.old_scheme import (
    GHOST,
    LARGEST_HEIGHT,
    MILLIMETRE,
    NAME_STYLE,
    TURN_POINTS,
    KinematicScheme,
    draw_position,
    write,
)
from reports.charts.style import (
    INK,
    LEFT,
    MUTED,
    PALETTE,
    RIM,
    WIDTH,
    drawn,
    label_values,
    over_turn,
    panels,
    plane,
    scaled_figure,
)
from reports.facts.thread import MM, diagram, thread_of, travels
from reports.records.views import View

Array = NDArray[np.float64]

THREAD = PALETTE[1]
PAD = 0.36  # inches around the outermost points
EYE_INKS = (PALETTE[0], PALETTE[2], PALETTE[3])
GUIDE_STYLE: dict[str, Any] = {**NAME_STYLE, "color": THREAD}


def is_spatial(view: View) -> bool:
    """Whether the contour leaves the linkage's plane."""
    stops = thread_of(view).stops
    return any((stop.z if isinstance(stop, ThreadEye) else stop.position[2]) != 0.0 for stop in stops)


def reference_scheme(view: View) -> KinematicScheme:
    """The linkage where the feed is counted from."""
    angle = reference_angle(view.mechanism, thread_of(view))
    turn = view.mechanism.sweep(np.linspace(0.0, 2.0 * np.pi, TURN_POINTS))
    return KinematicScheme(view.linkage, view.mechanism.sweep(np.array([angle])), turn)


def plane_figure(view: View) -> Figure:
    """The contour with the scheme, to scale in both directions, as wide as half the page allows."""
    scheme = reference_scheme(view)
    spots = MILLIMETRE * contour(scheme.few, thread_of(view))[:, :2, 0]
    low = np.minimum(scheme.extent[0], spots.min(axis=0))
    high = np.maximum(scheme.extent[1], spots.max(axis=0))
    draw = partial(draw_plane, view=view, scheme=scheme)
    return scaled_figure((low, high), PAD, (WIDTH, LARGEST_HEIGHT), WIDTH - LEFT - RIM, draw)


def draw_plane(axes: Axes, view: View, scheme: KinematicScheme, size: float) -> None:
    """Links, eyes' paths and the contour in the reference position; the axes' limits are the caller's."""
    thread = thread_of(view)
    plane(axes, 6, 8)
    for eye in thread.eyes:
        axes.plot(*(MILLIMETRE * scheme.turn.point(eye.point)), color=GHOST, linewidth=1.0, linestyle=(0, (3, 2)))
    draw_position(axes, scheme, size)
    spots = MILLIMETRE * contour(scheme.few, thread)[:, :2, 0]
    axes.plot(*spots.T, color=THREAD, linewidth=1.6, zorder=10.0)
    for stop, spot in zip(thread.stops, spots, strict=True):
        if isinstance(stop, ThreadGuide):
            symbols.pin(axes, spot, 0.8 * size, 11.0)
            away = spot - spots.mean(axis=0)  # its name on the side away from the thread
            write(axes, spot + 4.2 * size * away / (float(np.hypot(*away)) or 1.0), stop.name, GUIDE_STYLE)


def space_figure(view: View) -> Figure:
    """The contour in space."""

    def draw(figure: Figure) -> None:
        axes = Axes3D(figure, (0.0, 0.03, 0.97, 0.97))
        figure.add_axes(axes)
        draw_space(axes, view)

    return drawn(WIDTH, WIDTH, draw)


def draw_space(axes: Axes3D, view: View) -> None:
    """Links in their plane, eyes' paths at their depth, the contour through all; the main shaft points to the reader.

    z is drawn to a scale of its own: a few millimetres beside lengths of a hundred.
    """
    scheme, thread = reference_scheme(view), thread_of(view)
    for name in view.linkage.links:
        spots = scheme.shown_places(name, scheme.link_points(name))
        corners = symbols.outline(spots) if len(spots) > 1 else spots
        ring = np.vstack([corners, corners[:1]])
        axes.plot(ring[:, 0], np.zeros(len(ring)), ring[:, 1], color=INK, linewidth=1.8)
    corners = MILLIMETRE * contour(scheme.few, thread)[:, :, 0]
    for eye in thread.eyes:
        x, y = MILLIMETRE * scheme.turn.point(eye.point)
        axes.plot(x, np.full(len(x), MILLIMETRE * eye.z), y, color=GHOST, linewidth=1.0)
    axes.plot(corners[:, 0], corners[:, 2], corners[:, 1], color=THREAD, linewidth=1.8, marker="o", markersize=3.0)
    names = [stop.name if isinstance(stop, ThreadGuide) else stop.point for stop in thread.stops]
    for name, corner in dict(zip(names, corners, strict=True)).items():  # each point once
        axes.text(corner[0], corner[2], corner[1], f"\u00a0\u00a0{name}", fontsize=7.5, color=THREAD)
    _space_scales(axes)


def _space_scales(axes: Axes3D) -> None:
    spans = [float(np.ptp(limits)) for limits in (axes.get_xlim(), axes.get_zlim())]
    largest = max(spans)
    axes.set_box_aspect((spans[0] / largest, 0.5, spans[1] / largest), zoom=0.94)
    axes.view_init(elev=18.0, azim=-58.0)
    for axis, name in ((axes.xaxis, "x, mm"), (axes.yaxis, "z, mm"), (axes.zaxis, "y, mm")):
        axis.set_major_locator(MaxNLocator(4))
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.set_label_text(name)
    axes.invert_yaxis()


def feed_figure(view: View) -> Figure:
    """Pd over a turn, the contour's length beneath."""
    return panels("feed", draw_feed, view=view)


def draw_feed(upper: Axes, lower: Axes, view: View) -> None:
    """Feed above, contour below, with φ_top and φ_bottom of the eyes as uprights named above."""
    found = diagram(view)
    angle = np.degrees(np.append(found.angle, 2.0 * np.pi))
    upper.axhline(0.0, color=MUTED, linewidth=0.6)
    for axes, values, label in ((upper, found.feed, "Pd, mm"), (lower, found.length, "contour L, mm")):
        axes.plot(angle, MM * np.append(values, values[0]), color=THREAD, linewidth=1.6, zorder=3.0)
        label_values(axes, label)
        axes.margins(y=0.1)
        over_turn(axes, "" if axes is upper else "crank angle φ, °")
    _mark_eyes(upper, lower, view)


def _mark_eyes(upper: Axes, lower: Axes, view: View) -> None:
    """An upright per turning point of an eye; names of several eyes stand in a row each."""
    found = travels(view)
    for number, (name, one) in enumerate(found.items()):
        ink = EYE_INKS[number % len(EYE_INKS)]
        for word, angle in (("top", one.top_angle), ("bottom", one.bottom_angle)):
            degrees = float(np.degrees(angle))
            for axes in (upper, lower):
                axes.axvline(degrees, color=ink, linewidth=0.9, linestyle=(0, (4, 2)), zorder=2.0)
            text = f"φ_{word}" + (f" {name}" if len(found) > 1 else "")
            side = "left" if degrees < 30.0 else "right" if degrees > 330.0 else "center"
            upper.annotate(text, (degrees, 1.0), xycoords=("data", "axes fraction"), xytext=(0.0, 3.0 + 9.0 * number),
                           textcoords="offset points", ha=side, va="bottom", fontsize=7.5, color=ink)  # fmt: skip
