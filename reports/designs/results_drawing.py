"""Results as pictures: all in one drawing, or one figure by its name in the width of a paper's column."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.errors import LinkproofError, UnknownNameError, printable
from analytic.signals import MAGNITUDE
from comparisons.designer.curves import TRANSMISSION
from comparisons.designer.sheet import JOINT, Sheet
from reports.charts import draw
from reports.charts.draw import FULL_WIDTH, LINE, PALETTE
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
from reports.document.templates import plain
from reports.mechanism.designer import OUTPUT, PER_ROW, finish, plot_hodographs, plot_stacked
from reports.mechanism.shown import place, words

# Inches: of the title, of the upper row and of its left half, of a hodograph's row.
TITLE, UPPER, LEFT, CELL = 0.4, 4.8, 5.0, 2.75
CURVES: Final = {"Mkr": "torque", "Peq": "power", "S": "S"}
COLUMN: Final = 85.0 / 25.4  # inches
SINGLE, STACKED = 2.3, 1.2  # inches: heights of a panel, and of one of several over one axis
SIGNALS: Final = {"torque": ("Mkr",), "power": ("Peq",), "energy": ("Teq",), "inertia": ("Jeq",), "output": OUTPUT}
MOST_CURVES: Final = 10


def results_figure(sheet: Sheet, name: str | None = None) -> Figure:
    """The whole drawing of a sheet or, by ``name``, one figure of it for a paper's column; one of ``FIGURES``.

    The sheet is one that ``page_sheet`` made. Raises UnknownNameError for another name, LinkproofError for a figure
    that the linkage lacks.
    """
    return _everything(sheet) if name is None else _column_figure(sheet, name)


def _everything(sheet: Sheet) -> Figure:
    """The figure with all panels: scheme, curves of torque, power and S, and hodographs of the forces."""
    joints = [name for name in sheet.values if name.startswith(JOINT) and name.endswith(":x")]
    vectors = [name.removesuffix(":x") for name in (*joints, "shaking_force:x") if name in sheet.values]
    rows = -(-len(vectors) // PER_ROW)

    def draw_all(figure: Figure) -> None:
        """Draw the scheme, if there are positions, the curves and the forces into the figure."""
        heights = (UPPER, *(rows * CELL,) * (rows > 0))
        whole = draw.head(figure, [printable(sheet.conditions)])
        upper, *lower = whole.subfigures(len(heights), height_ratios=heights, squeeze=False)[:, 0]
        left, right = upper.subfigures(1, 2, width_ratios=(LEFT, FULL_WIDTH - LEFT))
        if sheet.positions is not None:
            scheme = KinematicScheme(sheet.linkage, sheet.positions)
            place_scheme(left, scheme, scheme.extent, draw_scheme)
        signals = [name for name in CURVES if name in sheet.values]
        for axes, name in zip(plot_stacked(sheet, signals, right) if signals else (), signals, strict=True):
            axes.set_title(_title(sheet, name))
        if vectors:
            plot_hodographs(sheet, vectors, lower[0])

    return draw.drawn(FULL_WIDTH, TITLE + UPPER + rows * CELL, draw_all)


def _title(sheet: Sheet, name: str) -> str:
    """The title of a curve of ``CURVES``, by its signal's name: a word, its peak with unit, and the peak's place."""
    peak = sheet.peaks[name]
    what = sheet.linkage.phi.effort if name == "Mkr" else CURVES[name]
    return f"{what}: peak {words(sheet, peak)} at {place(sheet, peak)}"


def _draw_curves(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """Draw the paths of all points, the linkage in one position, and names; ``size`` is a pin's radius."""
    draw_paths(axes, scheme)
    draw_position(axes, scheme, size, masses=False)
    draw_names(axes, scheme, size)


SCHEMES: Final[Mapping[str, Draw]] = {"scheme": draw_scheme, "curves": _draw_curves}
FIGURES: Final = (*SCHEMES, *SIGNALS, "forces", "transmission")


def _column_figure(sheet: Sheet, name: str) -> Figure:
    """The figure of this name, as wide as a paper's column.

    Raises UnknownNameError for an unknown one, LinkproofError for one that the linkage lacks.
    """
    if name not in FIGURES:
        raise UnknownNameError("figure", name, FIGURES)
    if name in SCHEMES and sheet.positions is not None:
        scheme = KinematicScheme(sheet.linkage, sheet.positions)
        return scaled_figure(scheme, scheme.extent, SCHEMES[name], COLUMN)
    stack = [signal for signal in SIGNALS.get(name, ()) if signal in sheet.values]
    if stack:
        height = SINGLE if len(stack) == 1 else STACKED * len(stack)
        return draw.drawn(COLUMN, height, partial(plot_stacked, sheet, stack))
    signals, label = _signals_together(sheet, name)
    if not signals:
        raise LinkproofError(
            f"--figure {name}: expected a linkage that has what it shows, got '{sheet.name}', which does not; "
            "choose another figure"
        )

    def plot(figure: Figure) -> None:
        """Draw the signals on one pair of axes, with a legend above, into a figure."""
        axes = figure.subplots()
        for n, (signal, word) in enumerate(signals.items()):
            axes.plot(sheet.x, sheet.y(signal), "-" if n < len(PALETTE) else "--", label=draw.wrap(word, COLUMN - 1.0))
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
        finish(axes, sheet, label)

    return draw.drawn(COLUMN, SINGLE + LINE * len(signals), plot)


def _signals_together(sheet: Sheet, name: str) -> tuple[dict[str, str], str]:
    """The signals to draw on one pair of axes for "forces" or "transmission", by name with their words.

    With them is the axis label; {} for those lacking or another name. There are ten forces at most, the largest first.
    """
    if name == "forces":
        signals = {f"{JOINT}{joint}{MAGNITUDE}": plain(joint) for joint in sheet.joints[:MOST_CURVES]}
        return signals, f"|F|, {sheet.file_unit_of('N').on_page}"
    groups = [signal for signal in sheet.values if name == "transmission" and signal.startswith(TRANSMISSION)]
    signals = {signal: plain(signal.removeprefix(TRANSMISSION)) for signal in groups}
    return signals, f"transmission angle, {sheet.file_unit_of('rad').on_page}"
