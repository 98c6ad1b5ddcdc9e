"""Results as a drawing: scheme with coupler curves, torque, power and output over the axis, hodographs of forces."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import printable
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.units import file_unit
from reports.charts import style
from reports.charts.forces import draw_tips
from reports.charts.old_scheme import POSITIONS, KinematicScheme, draw_scheme
from reports.charts.style import FULL_WIDTH, INK, MUTED, PALETTE, PIN_INCHES, drawn, label_values
from reports.document.numbers import figure as digits

Array = NDArray[np.float64]

# Inches: of the upper row, of its left half, of a hodograph's cell; room at the edges and between.
UPPER, LEFT_WIDTH, PER_ROW = 4.6, 4.7, 4
CELL_WIDTH, CELL_HEIGHT = FULL_WIDTH / PER_ROW, 2.4
TITLE, EDGE, LABELS, ROOM = 0.4, 0.15, 0.62, 0.42
CURVES: Final = {"Mkr": "torque", "Peq": "power", "S": "S"}


def svg_text(results: DesignerResults) -> str:
    """The drawing as an SVG file of its own, on white."""
    return style.svg_text(results_figure(results))


def results_figure(results: DesignerResults) -> Figure:
    """All panels, in as many rows as there are forces."""
    vectors = [name.removesuffix(":x") for name in results.curves.names if name.endswith("force:x") or _is_joint(name)]
    rows = -(-len(vectors) // PER_ROW)
    height = TITLE + UPPER + rows * CELL_HEIGHT + EDGE

    def draw(figure: Figure) -> None:
        figure.text(EDGE / FULL_WIDTH, 1.0 - 0.22 / height, printable(results.conditions), fontsize=9.0, color=INK)
        _draw_scheme(figure, results, height)
        _draw_curves(figure, results, height)
        for number, vector in enumerate(vectors):
            row, column = divmod(number, PER_ROW)
            left = column * CELL_WIDTH + LABELS
            bottom = height - TITLE - UPPER - (row + 1) * CELL_HEIGHT + ROOM
            size = min(CELL_WIDTH - LABELS - EDGE, CELL_HEIGHT - ROOM - 0.4)
            box = (left / FULL_WIDTH, bottom / height, size / FULL_WIDTH, size / height)
            _draw_hodograph(figure.add_axes(box), results, vector)

    return drawn(FULL_WIDTH, height, draw)


def _is_joint(name: str) -> bool:
    return name.startswith("joint_force:") and name.endswith(":x")


def _draw_scheme(figure: Figure, results: DesignerResults, height: float) -> None:
    """The scheme to one scale both ways, in the file's unit of length, over the motion's range."""
    length, (low, high) = file_unit("m", results.linkage), results.reach
    mechanism = results.case.mechanism
    once = low + min(high - low, FULL_TURN)
    few, turn = np.linspace(low, once, POSITIONS, endpoint=False), np.linspace(low, once, 361)
    scheme = KinematicScheme(results.linkage, mechanism.sweep(few), mechanism.sweep(turn), 1.0 / length.size)
    box = np.array([LEFT_WIDTH - LABELS - EDGE, UPPER - ROOM - EDGE])
    first, last = scheme.extent
    scale = float(np.min((box - 2 * ROOM) / np.maximum(last - first, 1e-9)))
    axes = figure.add_axes(
        (LABELS / FULL_WIDTH, (height - TITLE - UPPER + ROOM) / height, box[0] / FULL_WIDTH, box[1] / height)
    )
    middle, half = 0.5 * (first + last), 0.5 * box / scale
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    draw_scheme(axes, scheme, PIN_INCHES / scale)
    for number, point in enumerate(_coupler_points(results.linkage)):
        axes.plot(
            *(scheme.scale * scheme.turn.point(point)), color=PALETTE[1 + number % (len(PALETTE) - 1)], zorder=3.0
        )
    axes.set_xlabel(f"x, {length.name}")
    axes.set_ylabel(f"y, {length.name}")


def _coupler_points(linkage: Linkage) -> list[str]:
    """Points of one link alone, whose curves are what the linkage is for; the output's is drawn with the scheme."""
    held = {*linkage.ground} | ({linkage.output.point} if linkage.output else set())
    held |= {pin.point for pin in linkage.pins} | {s.point for s in linkage.sliders} | {s.point for s in linkage.slots}
    return sorted({point for link in linkage.links.values() for point in link.points} - held)


def _draw_curves(figure: Figure, results: DesignerResults, height: float) -> None:
    """Torque, power and the output's displacement, one above the other, each with its peak."""
    names = [name for name in CURVES if results.curves.has(name)]
    left, width = (LEFT_WIDTH + LABELS + 0.1) / FULL_WIDTH, (FULL_WIDTH - LEFT_WIDTH - LABELS - EDGE - 0.1) / FULL_WIDTH
    each = (UPPER - ROOM - EDGE) / max(len(names), 1)
    for number, name in enumerate(names):
        bottom = (height - TITLE - EDGE - (number + 1) * each + 0.1) / height
        axes = figure.add_axes((left, bottom, width, (each - 0.28) / height))
        _draw_curve(axes, results, name, PALETTE[number])
        if number < len(names) - 1:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("time, s" if results.axis == "time" else f"φ, {results.unit('phi').name}")


def _draw_curve(axes: Axes, results: DesignerResults, name: str, ink: str) -> None:
    curves, unit, axis = results.curves, results.unit(name), results.unit(results.axis)
    along = curves.of(curves.on_grid, results.axis) / axis.size
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    axes.plot(along, curves.of(curves.on_grid, name) / unit.size, color=ink)
    peak = curves.peaks([name])[name]
    place = float(curves.values([results.axis], peak.time)[0]) / axis.size
    axes.plot([place], [peak.value / unit.size], marker="o", markersize=3.5, color=ink)
    title = "force" if name == "Mkr" and results.is_linear else CURVES[name]
    axes.set_title(f"{title}: peak {digits(peak.value / unit.size)} {unit.name} at {place:.4g} {axis.name}")
    axes.set_xlim(float(np.min(along)), float(np.max(along)))
    if results.axis == "phi" and axis.name == "deg":
        axes.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 3, 4.5, 6, 9, 10]))
    label_values(axes, f"{name}, {unit.name}", 4)


def _draw_hodograph(axes: Axes, results: DesignerResults, vector: str) -> None:
    """The tip of a force over the motion, its peak marked by a dot."""
    curves, unit = results.curves, results.unit(f"{vector}:x")
    force = np.stack([curves.of(curves.on_grid, f"{vector}:{xy}") for xy in "xy"]) / unit.size
    peak = curves.peaks([f"{vector}:magnitude"])[f"{vector}:magnitude"]
    tip = np.array(curves.values((f"{vector}:x", f"{vector}:y"), peak.time)) / unit.size
    draw_tips(axes, force, PALETTE[0], unit.name)
    axes.plot(*tip, marker="o", markersize=3.5, color=PALETTE[1], zorder=3.2)
    name = vector.partition(":")[2] or "shaking force"
    axes.set_title(f"{printable(name)}\n{digits(peak.value / unit.size)} {unit.name}")
