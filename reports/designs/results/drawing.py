"""Results as a drawing: scheme with coupler curves, torque, power and output over the axis, hodographs of forces."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from matplotlib.figure import Figure

from analytic.errors import printable
from analytic.signals import MAGNITUDE
from comparisons.datasheet.sheet import JOINT, Sheet
from reports.charts import draw
from reports.charts.kinematic_scheme import KinematicScheme
from reports.charts.scheme import draw_scheme, place
from reports.charts.style import FULL_WIDTH, drawn
from reports.designs.results.column_figures import column_figure
from reports.document.chart import Chart, Panel
from reports.mechanism.designer import hodograph
from reports.mechanism.shown import place as place_words
from reports.mechanism.shown import stacked, words

# Inches: of the title, of the upper row and of its left half, of a hodograph's cell.
TITLE, UPPER, LEFT, CELL, PER_ROW = 0.4, 4.8, 5.0, 2.75, 4
PAPER_DOTS: Final = 300  # to the inch
CURVES: Final = {"Mkr": "torque", "Peq": "power", "S": "S"}


def picture(sheet: Sheet, kind: str, name: str | None = None) -> str | bytes:
    """The drawing, or one figure of it by name for a paper's column, on white; ``kind`` is svg, png or pdf.

    The sheet is that of a page.
    """
    figure = results_figure(sheet) if name is None else column_figure(sheet, name)
    if kind == "svg":
        return draw.svg(figure, page="white")
    return draw.pdf(figure) if kind == "pdf" else draw.png(figure, PAPER_DOTS)


def results_figure(sheet: Sheet) -> Figure:
    """All panels, in as many rows as there are forces."""
    joints = [name for name in sheet.values if name.startswith(JOINT) and name.endswith(":x")]
    vectors = [name.removesuffix(":x") for name in (*joints, "shaking_force:x") if sheet.has(name)]
    rows = -(-len(vectors) // PER_ROW)
    height = TITLE + UPPER + rows * CELL

    def draw_all(figure: Figure) -> None:
        figure.text(0.15 / FULL_WIDTH, 1.0 - 0.25 / height, printable(sheet.conditions))
        if sheet.positions is not None:
            scheme = KinematicScheme(sheet.linkage, sheet.positions)
            place(figure, scheme, (0.0, rows * CELL), (LEFT, UPPER), extent=scheme.extent, draw=draw_scheme)
        signals = [name for name in CURVES if sheet.has(name)]
        if signals:
            curves = stacked(sheet, signals, UPPER)
            titles = [replace(one, title=_title(sheet, name)) for one, name in zip(curves.panels, signals, strict=True)]
            draw.place(figure, replace(curves, panels=tuple(titles)), (LEFT, rows * CELL), (FULL_WIDTH - LEFT, UPPER))
        if vectors:
            hodographs = Chart(tuple(_hodograph(sheet, name) for name in vectors), columns=PER_ROW)
            draw.place(figure, hodographs, (0.0, 0.0), (FULL_WIDTH, rows * CELL))

    return drawn(FULL_WIDTH, height, draw_all)


def _title(sheet: Sheet, name: str) -> str:
    """What a curve is, its peak, and where."""
    peak = sheet.peaks[name]
    what = "force" if name == "Mkr" and sheet.is_linear else CURVES[name]
    return f"{what}: peak {words(sheet, peak)} at {place_words(sheet, peak)}"


def _hodograph(sheet: Sheet, vector: str) -> Panel:
    """The tip of a force, named with its peak."""
    panel = hodograph(sheet, vector, 0, sheet.unit(f"{vector}:x").on_page)
    name, peak = printable(panel.title or "shaking force"), sheet.peaks[vector + MAGNITUDE]
    return replace(panel, title=f"{name}, {words(sheet, peak)}")
