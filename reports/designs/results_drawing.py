"""Results as pictures: all in one drawing, or one figure by its name in the width of a paper's column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.errors import LinkproofError, UnknownNameError, printable
from analytic.signals import MAGNITUDE
from comparisons.designer.curves import TRANSMISSION
from comparisons.designer.sheet import JOINT, Sheet
from reports.charts import draw
from reports.charts.draw import LINE
from reports.charts.scales import FULL_WIDTH, PALETTE
from reports.charts.scheme import (
    Draw,
    KinematicScheme,
    draw_names,
    draw_paths,
    draw_position,
    draw_scheme,
    scaled_figure,
)
from reports.charts.scheme import place as place_scheme
from reports.document.chart import Chart, Panel
from reports.document.templates import plain
from reports.mechanism.designer import MOST_CURVES, OUTPUT, hodograph
from reports.mechanism.shown import place, signals_panel, stacked_chart, words

# Inches: of the title, of the upper row and of its left half, of a hodograph's cell.
TITLE, UPPER, LEFT, CELL, PER_ROW = 0.4, 4.8, 5.0, 2.75, 4
CURVES: Final = {"Mkr": "torque", "Peq": "power", "S": "S"}
COLUMN: Final = 85.0 / 25.4  # inches
SINGLE, STACKED = 2.3, 1.2  # inches: heights of a panel, and of one of several over one axis
SIGNALS: Final = {"torque": ("Mkr",), "power": ("Peq",), "energy": ("Teq",), "inertia": ("Jeq",), "output": OUTPUT}


def results_figure(sheet: Sheet, name: str | None = None) -> Figure:
    """The drawing, or one figure of it by name for a paper's column; the sheet is that of a page."""
    return _everything(sheet) if name is None else _column_figure(sheet, name)


def _everything(sheet: Sheet) -> Figure:
    """All panels, in as many rows as there are forces."""
    joints = [name for name in sheet.values if name.startswith(JOINT) and name.endswith(":x")]
    vectors = [name.removesuffix(":x") for name in (*joints, "shaking_force:x") if name in sheet.values]
    rows = -(-len(vectors) // PER_ROW)

    def draw_all(figure: Figure) -> None:
        heights = (UPPER, *(rows * CELL,) * (rows > 0))
        whole = draw.head(figure, [printable(sheet.conditions)])
        upper, *lower = whole.subfigures(len(heights), height_ratios=heights, squeeze=False)[:, 0]
        left, right = upper.subfigures(1, 2, width_ratios=(LEFT, FULL_WIDTH - LEFT))
        if sheet.positions is not None:
            scheme = KinematicScheme(sheet.linkage, sheet.positions)
            place_scheme(left, scheme, scheme.extent, draw_scheme)
        signals = [name for name in CURVES if name in sheet.values]
        if signals:
            curves = stacked_chart(sheet, signals, UPPER)
            titles = [
                replace(panel, title=_title(sheet, name)) for panel, name in zip(curves.panels, signals, strict=True)
            ]
            draw.place(right, replace(curves, panels=tuple(titles)))
        if vectors:
            draw.place(lower[0], Chart(tuple(_hodograph(sheet, name) for name in vectors), columns=PER_ROW))

    return draw.drawn(FULL_WIDTH, TITLE + UPPER + rows * CELL, draw_all)


def _title(sheet: Sheet, name: str) -> str:
    """Name of a curve, its peak, and the place of the peak."""
    peak = sheet.peaks[name]
    what = "force" if name == "Mkr" and sheet.is_linear else CURVES[name]
    return f"{what}: peak {words(sheet, peak)} at {place(sheet, peak)}"


def _hodograph(sheet: Sheet, vector: str) -> Panel:
    """The tip of a force, named with its peak."""
    panel = hodograph(sheet, vector, 0)
    name, peak = printable(panel.title or "shaking force"), sheet.peaks[vector + MAGNITUDE]
    return replace(panel, title=f"{name}, {words(sheet, peak)}")


def _draw_curves(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """The curves of all points, and the linkage in one position."""
    draw_paths(axes, scheme)
    draw_position(axes, scheme, size, masses=False)
    draw_names(axes, scheme, size)


SCHEMES: Final[Mapping[str, Draw]] = {"scheme": draw_scheme, "curves": _draw_curves}
FIGURES: Final = (*SCHEMES, *SIGNALS, "forces", "transmission")


def _column_figure(sheet: Sheet, name: str) -> Figure:
    """The figure of a name; raises LinkproofError for an unknown name, or where the linkage has nothing for it."""
    if name not in FIGURES:
        raise UnknownNameError("figure", name, FIGURES)
    positions = sheet.positions
    if positions is not None and name in SCHEMES:
        scheme = KinematicScheme(sheet.linkage, positions)
        return scaled_figure(scheme, scheme.extent, SCHEMES[name], COLUMN)
    result = _chart(sheet, name) if name not in SCHEMES else Chart(())
    if not result.panels:
        raise LinkproofError(
            f"--figure {name}: expected a linkage that has what it shows, got '{sheet.name}', which does not; "
            "choose another figure"
        )
    return draw.figure(result, COLUMN)


def _chart(sheet: Sheet, name: str) -> Chart:
    """The panels of a figure, without curves where the linkage has nothing for them."""
    if name in SIGNALS:
        stack = [signal for signal in SIGNALS[name] if signal in sheet.values]
        return stacked_chart(sheet, stack, SINGLE if len(stack) == 1 else STACKED * len(stack))
    if name == "forces":
        signals = {f"{JOINT}{joint}{MAGNITUDE}": plain(joint) for joint in sheet.joints[:MOST_CURVES]}
        label = f"|F|, {sheet.file_unit_of('N').on_page}"
    else:
        groups = [name for name in sheet.values if name.startswith(TRANSMISSION)]
        signals = {name: plain(name.removeprefix(TRANSMISSION)) for name in groups}
        label = f"transmission angle, {sheet.file_unit_of('rad').on_page}"
    panels = [replace(signals_panel(sheet, signals, label, len(PALETTE)), names="key")] if signals else []
    return Chart(tuple(panels), SINGLE + LINE * len(signals))
