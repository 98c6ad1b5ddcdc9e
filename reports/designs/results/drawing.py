"""Results as a drawing: scheme with coupler curves, torque, power and output over the axis, hodographs of forces."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from matplotlib.figure import Figure

from analytic.errors import printable
from comparisons.datasheet.building import sheet
from comparisons.datasheet.designer_results import DesignerResults
from reports.charts import draw
from reports.charts.kinematic_scheme import KinematicScheme
from reports.charts.scheme import draw_scheme, place
from reports.charts.style import FULL_WIDTH
from reports.designs.results.column_figures import column_figure
from reports.document.chart import Chart, Panel
from reports.mechanism.designer import hodograph
from reports.mechanism.shown import ShownSheet

# Inches: of the title, of the upper row and of its left half, of a hodograph's cell.
TITLE, UPPER, LEFT, CELL, PER_ROW = 0.4, 4.8, 5.0, 2.75, 4
PAPER_DOTS: Final = 300  # to the inch
CURVES: Final = {"Mkr": "torque", "Peq": "power", "S": "S"}


def picture(results: DesignerResults, kind: str, name: str | None = None) -> str | bytes:
    """The drawing, or one figure of it by name for a paper's column, on white; ``kind`` is svg, png or pdf."""
    shown = ShownSheet(sheet(results.case))
    figure = results_figure(shown) if name is None else column_figure(shown, name)
    if kind == "svg":
        return draw.svg(figure, page="white")
    return draw.pdf(figure) if kind == "pdf" else draw.png(figure, PAPER_DOTS)


def results_figure(shown: ShownSheet) -> Figure:
    """All panels, in as many rows as there are forces."""
    joints = [name for name in shown.sheet.values if name.startswith("joint_force:") and name.endswith(":x")]
    vectors = [name.removesuffix(":x") for name in (*joints, "shaking_force:x") if shown.has(name)]
    rows = -(-len(vectors) // PER_ROW)

    def draw_all(figure: Figure) -> None:
        heights = (UPPER, *(rows * CELL,) * (rows > 0))
        whole = draw.head(figure, [printable(shown.sheet.conditions)])
        upper, *lower = whole.subfigures(len(heights), height_ratios=heights, squeeze=False)[:, 0]
        left, right = upper.subfigures(1, 2, width_ratios=(LEFT, FULL_WIDTH - LEFT))
        if shown.sheet.positions is not None:
            scheme = KinematicScheme(shown.sheet.linkage, shown.sheet.positions)
            place(left, scheme, scheme.extent, draw_scheme)
        curves = shown.stacked([name for name in CURVES if shown.has(name)], UPPER)
        named = [replace(panel, title=_title(shown, name)) for panel, name in zip(curves.panels, CURVES, strict=False)]
        draw.place(right, replace(curves, panels=tuple(named)))
        if vectors:
            draw.place(lower[0], Chart(tuple(_hodograph(shown, name) for name in vectors), columns=PER_ROW))

    return draw.drawn(FULL_WIDTH, TITLE + UPPER + rows * CELL, draw_all)


def _title(shown: ShownSheet, name: str) -> str:
    """What a curve is, its peak, and where."""
    what = "force" if name == "Mkr" and shown.sheet.linkage.is_linear else CURVES[name]
    return f"{what}: peak {shown.peak(name)} at {shown.place(shown.sheet.peaks[name]['at'])}"


def _hodograph(shown: ShownSheet, vector: str) -> Panel:
    """The tip of a force, named with its peak."""
    panel = hodograph(shown, vector, 0, shown.unit(f"{vector}:x").name)
    return replace(panel, title=f"{printable(panel.title or 'shaking force')}, {shown.peak(f'{vector}:magnitude')}")
