"""The thread's contour at the angle from which its feed is counted: in the linkage's plane, and in space."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]  # matplotlib types the plane only

from analytic.description.file_units import file_unit
from analytic.description.linkage import Linkage
from comparisons.datasheet.sheet import Positions, ThreadSheet
from reports.charts import symbols
from reports.charts.draw import drawn
from reports.charts.kinematic_scheme import KinematicScheme
from reports.charts.scales import GHOST, INK, PALETTE, WIDTH
from reports.charts.scheme import NAME_STYLE, draw_names, draw_position, scaled_figure, write

THREAD = PALETTE[1]
GUIDE_STYLE: dict[str, Any] = {**NAME_STYLE, "color": THREAD}


def is_spatial(thread: ThreadSheet) -> bool:
    """Whether the contour leaves the linkage's plane."""
    return bool(np.any(thread.contour[:, 2]))


def plane_figure(linkage: Linkage, positions: Positions, thread: ThreadSheet) -> Figure:
    """The contour with the linkage, to scale in both directions."""
    scheme = KinematicScheme(linkage, positions, thread.reference_angle)
    spots = scheme.scale * thread.contour[:, :2]
    low, high = scheme.extent
    extent = np.minimum(low, spots.min(axis=0)), np.maximum(high, spots.max(axis=0))
    return scaled_figure(scheme, extent, partial(_draw_plane, thread=thread))


def _draw_plane(axes: Axes, scheme: KinematicScheme, size: float, thread: ThreadSheet) -> None:
    """Links, eyes' paths and the contour; the axes' limits are the caller's."""
    for eye in thread.eyes.values():
        symbols.line(axes, scheme.scale * eye["path"][:2].T, 1.0, 2.0, GHOST, linestyle=(0, (3, 2)))
    draw_position(axes, scheme, size)
    draw_names(axes, scheme, size)
    spots = scheme.scale * thread.contour[:, :2]
    symbols.line(axes, spots, 1.6, 10.0, THREAD)
    for name, spot in zip(thread.stops, spots, strict=True):
        if name not in thread.eyes:
            symbols.pin(axes, spot, 0.8 * size, 11.0)
            away = symbols.unit(spot - spots.mean(axis=0))  # its name on the side away from the thread
            write(axes, spot + 4.4 * size * away, name, GUIDE_STYLE)


def space_figure(linkage: Linkage, positions: Positions, thread: ThreadSheet) -> Figure:
    """The contour in space: the main shaft points to the reader, and z has a scale of its own."""
    scheme = KinematicScheme(linkage, positions, thread.reference_angle)
    return drawn(WIDTH, WIDTH, partial(_draw_space, scheme=scheme, thread=thread), placed=False)


def _draw_space(figure: Figure, scheme: KinematicScheme, thread: ThreadSheet) -> None:
    """Links in their plane, eyes' paths at their depth, the contour through all."""
    axes = Axes3D(figure, (0.0, 0.03, 0.97, 0.97))
    figure.add_axes(axes)
    for name, link in scheme.linkage.links.items():
        spots = scheme.shown(name, link.points.values())
        corners = symbols.outline(spots)
        ring = np.vstack([corners, corners[:1]])
        axes.plot(ring[:, 0], np.zeros(len(ring)), ring[:, 1], color=INK, linewidth=1.8)
    for eye in thread.eyes.values():
        x, y, z = scheme.scale * eye["path"]
        axes.plot(x, z, y, color=GHOST, linewidth=1.0)
    corners = scheme.scale * thread.contour
    axes.plot(corners[:, 0], corners[:, 2], corners[:, 1], color=THREAD, linewidth=1.8, marker="o", markersize=3.0)
    for name, (x, y, z) in dict(zip(thread.stops, corners, strict=True)).items():  # each point once
        axes.text(x, z, y, f"\u00a0\u00a0{name}", color=THREAD)
    _space_scales(axes, file_unit("m", scheme.linkage).name)


def _space_scales(axes: Axes3D, unit: str) -> None:
    """Proportions, view, ticks and labels of the axes in space."""
    wide, high = (float(np.ptp(limits)) for limits in (axes.get_xlim(), axes.get_zlim()))
    axes.set_box_aspect((wide, 0.5 * max(wide, high), high), zoom=0.94)
    axes.view_init(elev=18.0, azim=-58.0)
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "z"), (axes.zaxis, "y")):
        axis.set_major_locator(MaxNLocator(4))
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.set_label_text(f"{name}, {unit}")
    axes.invert_yaxis()
