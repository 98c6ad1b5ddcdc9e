"""One figure of the results by its name, in the width of a paper's column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.errors import LinkproofError, UnknownNameError
from analytic.signals import MAGNITUDE
from comparisons.datasheet.figures import TRANSMISSION
from comparisons.datasheet.sheet import JOINT, Sheet
from reports.charts import draw
from reports.charts.kinematic_scheme import KinematicScheme
from reports.charts.labels import LINE
from reports.charts.scheme import Draw, draw_names, draw_paths, draw_position, draw_scheme, scaled_figure
from reports.charts.style import PALETTE
from reports.document.chart import Chart, Curve
from reports.document.templates import plain
from reports.mechanism.designer import MOST_CURVES, OUTPUT
from reports.mechanism.shown import chart, panel, stacked

COLUMN: Final = 85.0 / 25.4  # inches
SINGLE, STACKED = 2.3, 1.2  # inches: heights of a panel, and of one of several over one axis
SIGNALS: Final = {"torque": ("Mkr",), "power": ("Peq",), "energy": ("Teq",), "inertia": ("Jeq",), "output": OUTPUT}


def _draw_curves(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    """The curves of all points, and the linkage in one position."""
    draw_paths(axes, scheme)
    draw_position(axes, scheme, size, masses=False)
    draw_names(axes, scheme, size)


SCHEMES: Final[Mapping[str, Draw]] = {"scheme": draw_scheme, "curves": _draw_curves}
FIGURES: Final = (*SCHEMES, *SIGNALS, "forces", "transmission")


def column_figure(sheet: Sheet, name: str) -> Figure:
    """The figure of a name; raises LinkproofError for an unknown name, or where the linkage has nothing for it."""
    if name not in FIGURES:
        raise UnknownNameError("figure", name, FIGURES)
    positions = sheet.positions
    if positions is not None and name in SCHEMES:
        scheme = KinematicScheme(sheet.linkage, positions)
        return scaled_figure(scheme, scheme.extent, SCHEMES[name], COLUMN)
    drawn = _chart(sheet, name) if name not in SCHEMES else Chart(())
    if not drawn.panels:
        raise LinkproofError(
            f"--figure {name}: expected a linkage that has what it shows, got '{sheet.name}', which does not; "
            "choose another figure"
        )
    return draw.figure(drawn, COLUMN)


def _chart(sheet: Sheet, name: str) -> Chart:
    """The panels of a figure, without curves where the linkage has nothing for them."""
    if name in SIGNALS:
        signals = [signal for signal in SIGNALS[name] if sheet.has(signal)]
        return stacked(sheet, signals, SINGLE if len(signals) == 1 else STACKED * len(signals))
    if name == "forces":
        named = {joint: f"{JOINT}{joint}{MAGNITUDE}" for joint in sheet.joints[:MOST_CURVES]}
        label = f"|F|, {sheet.own('N').on_page}"
    else:
        named = {one.removeprefix(TRANSMISSION): one for one in sheet.values if one.startswith(TRANSMISSION)}
        label = f"transmission angle, {sheet.own('rad').on_page}"
    curves = [
        Curve(sheet.x, sheet.y(signal), plain(what), n, "-" if n < len(PALETTE) else "--")
        for n, (what, signal) in enumerate(named.items())
    ]
    panels = [replace(panel(sheet, curves, label), names="key")] if curves else []
    return chart(sheet, panels, SINGLE + LINE * len(curves))
