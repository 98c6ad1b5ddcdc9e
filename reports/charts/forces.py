"""Forces over a steady turn: in every joint by magnitude and as hodographs, on the frame with its moment."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from reports.charts.style import (
    DASHES,
    FULL_WIDTH,
    INK,
    MUTED,
    PALETTE,
    drawn,
    label_ends,
    label_values,
    over_turn,
    panels,
)
from reports.document.numbers import figure as digits
from reports.document.templates import plain
from reports.facts.forces import POINTS, TurnForces

Array = NDArray[np.float64]

PER_ROW = 4
EVERY = 30  # points between dots: one per degree makes 30°
MARKED = 90  # a dot every so many degrees of crank angle carries its angle
CLEAR = 0.2  # least distance of two of these names, as a share of a panel's half side
PATCH = {"boxstyle": "round,pad=0.08", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}


def magnitudes_figure(found: TurnForces) -> Figure:
    """|F| of every joint."""
    return panels("joint-forces", draw_magnitudes, found=found)


def draw_magnitudes(axes: Axes, found: TurnForces) -> None:
    """A curve per joint, named with its peak at the right end."""
    ends = []
    for number, (name, force) in enumerate(found.joints.items()):
        values, (peak, where) = np.hypot(*force), found.peaks[name]
        ink, dash = _line(number)
        axes.plot(np.degrees(found.angle), values, color=ink, linestyle=dash, linewidth=1.4)
        axes.plot([where], [peak], marker="o", markersize=3.0, color=ink)
        ends.append((float(values[-1]), f"{plain(name)}, {digits(peak, 3)} N", ink))
    axes.set_ylim(bottom=0.0)
    label_values(axes, "|F|, N", 6)
    over_turn(axes)
    label_ends(axes, ends)


def _line(number: int) -> tuple[str, object]:
    """Colours first, dashes once they are used up."""
    return PALETTE[number % len(PALETTE)], ("-", *DASHES)[number // len(PALETTE) % (len(DASHES) + 1)]


def hodographs_figure(found: TurnForces) -> Figure:
    """The tip of every joint's force over a turn, each to its own scale."""
    rows = -(-len(found.joints) // PER_ROW)
    columns = min(PER_ROW, len(found.joints))
    side = FULL_WIDTH / PER_ROW

    def draw(figure: Figure) -> None:
        figure.subplots_adjust(left=0.22 / columns, right=1.0 - 0.06 / columns, top=1.0 - 0.13 / rows,
                               bottom=0.19 / rows, wspace=0.3, hspace=0.42)  # fmt: skip
        grid = figure.subplots(rows, columns, squeeze=False).ravel()
        for number, (name, force) in enumerate(found.joints.items()):
            draw_hodograph(grid[number], force, _line(number)[0])
            grid[number].set_title(plain(name))
        for axes in grid[len(found.joints) :]:
            axes.set_visible(False)

    return drawn(columns * side, rows * side * 1.12, draw)


def draw_hodograph(axes: Axes, force: Array, ink: str) -> None:
    """Fx against Fy from the origin, a dot every 30° of the crank, the quarters of the turn named."""
    half = draw_tips(axes, force, ink, "N")
    axes.plot(*force[:, :-1:EVERY], linestyle="none", marker="o", markersize=2.4, color=ink, zorder=3.1)
    _name_angles(axes, force, half)


def draw_tips(axes: Axes, force: Array, ink: str, unit: str) -> float:
    """Fx against Fy, (2, n), from the origin, in a square whose half side is returned."""
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    axes.axvline(0.0, color=MUTED, linewidth=0.6)
    axes.plot(*force, color=ink, linewidth=1.3, zorder=3.0)
    middle, half = _square(force)
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(middle[1] - half, middle[1] + half)
    axes.set_aspect("equal")
    axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.set_xlabel(f"Fx, {unit}", labelpad=1.5)
    axes.set_ylabel(f"Fy, {unit}", labelpad=1.5)
    return half


def _square(force: Array) -> tuple[Array, float]:
    """Middle and half side of the square that holds a hodograph and its origin, with room for names.

    At a change point a force is not a number, and is left out.
    """
    low, high = np.fmin.reduce(force, axis=1, initial=0.0), np.fmax.reduce(force, axis=1, initial=0.0)
    return 0.5 * (low + high), 0.64 * (float(np.max(high - low)) or 1.0)


def _name_angles(axes: Axes, force: Array, half: float) -> None:
    """Crank angles beside the curve on its outer side, but where one would hide another."""
    centre, taken = np.mean(force, axis=1, where=np.isfinite(force)), np.full((1, 2), np.inf)
    for degrees in range(0, 360, MARKED):
        tip = force[:, degrees]
        if not np.isfinite(tip).all():
            continue
        along = force[:, (degrees + 1) % (POINTS - 1)] - force[:, degrees - 1 if degrees else POINTS - 2]
        across = np.array([-along[1], along[0]]) / (float(np.hypot(*along)) or 1.0)
        away = across if float(across @ (tip - centre)) >= 0.0 else -across
        place = tip + 0.12 * half * away
        if float(np.min(np.hypot(*(taken - place).T))) > CLEAR * half:
            taken = np.vstack([taken, place])
            axes.text(float(place[0]), float(place[1]), str(degrees), ha="center", va="center", fontsize=6.5,
                      color=INK, zorder=4.0, bbox=PATCH)  # fmt: skip


def shaking_force_figure(found: TurnForces) -> Figure:
    """Hodograph of the force on the frame."""
    return panels("shaking-force", draw_hodograph, force=found.shaking, ink=PALETTE[0])


def shaking_moment_figure(found: TurnForces) -> Figure:
    """Moment on the frame over the turn."""

    def draw(axes: Axes) -> None:
        axes.axhline(0.0, color=MUTED, linewidth=0.6)
        axes.plot(np.degrees(found.angle), found.moment, color=PALETTE[1], linewidth=1.5)
        label_values(axes, f"shaking moment about {found.pivot}, N m", 6)
        over_turn(axes)

    return panels("shaking-moment", draw)
