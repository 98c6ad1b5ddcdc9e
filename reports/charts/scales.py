"""The scales of a panel: limits that suit what is drawn, round ticks, a power of ten in the label."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator, ScalarFormatter

from reports.document.chart import Ink, Panel
from reports.document.templates import FOLDER

MARGIN = 0.07  # of a span, beyond the curves
NOTED = 0.25  # of a span, beyond curves with words beside their extremes
DIPS, LONG = 0.05, 50  # the share of a long curve that may dip below a logarithmic axis, and how many points are long
FROM_ZERO = 0.4  # an axis starts at zero where the least value is below this share of the largest
STEADY = 1e-6  # a curve that varies by less than this share of its size is flat
UP_TO, DOWN_TO = 1e5, 1e-3  # beyond these a power of ten goes to the label
STEPS = [1.0, 2.0, 2.5, 5.0, 10.0]
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def power_of_ten(value: float, _: int | None = None) -> str:
    """10 to a whole power, in plain characters: 10⁻⁵."""
    return f"10{str(round(math.log10(value))).translate(RAISED)}"


def set_limits(axes: Axes, panel: Panel) -> None:
    """Limits of axes in which a panel is drawn; those of y, and of x where it is a turn or logarithmic."""
    if panel.turn:
        axes.set_xlim(0.0, 360.0)
    if axes.get_xscale() == "log":
        axes.set_xlim(_decades(*axes.get_xlim()))
    if panel.rows:
        axes.set_ylim(len(panel.rows) - 0.5, -0.5)
    elif axes.get_yscale() == "log":
        axes.set_ylim(_decades(_above_dips(panel), axes.dataLim.y1))
    elif panel.scale != "equal" and not panel.surface:
        low, high = axes.dataLim.intervaly
        axes.set_ylim(panel.span or _linear(low, high, axes.get_ylim()))


def _linear(low: float, high: float, limits: tuple[float, float]) -> tuple[float, float]:
    """Limits with room about what is drawn: a flat curve stands in their middle, magnitudes above zero."""
    size = max(abs(low), abs(high))
    if 0.0 < high - low <= STEADY * size:
        return low - 0.1 * size, high + 0.1 * size
    return (0.0, limits[1]) if 0.0 <= low < FROM_ZERO * high else limits


def _above_dips(panel: Panel) -> float:
    """Where a logarithmic axis begins: an error that changes sign dips to zero."""
    lowest = [mark.place for mark in panel.marks if mark.along == "y"]
    for curve in panel.curves:
        values = curve.y[np.isfinite(curve.y) & (curve.y > 0.0)]
        dips = DIPS if len(values) > LONG and not curve.marker else 0.0
        lowest += [float(np.quantile(values, dips))] if len(values) else []
    return min(lowest, default=0.1)


def _decades(low: float, high: float) -> tuple[float, float]:
    """Limits widened to whole powers of ten, at least one decade apart."""
    first, last = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    return 10.0**first, 10.0 ** max(last, first + 1)


def write_scale(axis: Axis, label: str, ticks: int) -> None:
    """About so many round ticks and the label of an axis whose limits are set; a power of ten goes to the label."""
    axis.set_label_text(label)
    if axis.get_scale() == "log":
        axis.set_major_locator(LogLocator(numticks=ticks))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(power_of_ten))
        return
    axis.set_major_locator(MaxNLocator(ticks, steps=STEPS))
    formatter = ScalarFormatter(useOffset=False)
    formatter.set_scientific(False)
    largest = float(np.max(np.abs(axis.get_view_interval())))
    if not DOWN_TO <= largest < UP_TO:
        power = math.floor(math.log10(largest) + 1e-9)
        formatter.set_scientific(True)
        formatter.set_powerlimits((power, power))
        axis.offsetText.set_visible(False)
        name, comma, unit = label.rpartition(", ")
        factor = power_of_ten(10.0**power)
        axis.set_label_text(f"{name}{comma}{factor} {unit}" if comma else f"{label} × {factor}")
    axis.set_major_formatter(formatter)


# How every figure looks: colours that a colour-blind reader can tell apart, sizes that stay legible on paper.
#
# Figures are drawn through matplotlib's object interface, with the fonts it brings along, so that two reports of the
# same results are the same text. Nothing here knows an engine by name.


# Okabe and Ito, dark enough for words; the closed form is always ink.
PALETTE = ("#0072b2", "#c75300", "#00855f", "#aa4499", "#5b45c9", "#8a6b00")
INK, MUTED, FAINT, REFERENCE = "#1d2733", "#5b6673", "#d8dde3", "#a9b3bf"
LIMIT_COLOUR = "#a02020"
PAPER, PLATE, GHOST = "#ffffff", "#e4e9ef", "#a8b8c8"  # behind a drawing, inside a link, what is faintly drawn

# What each of a drawing's colours becomes where the reader's scheme is dark.
DARK = {
    INK: "#e4e8ed",
    MUTED: "#a3aebb",
    FAINT: "#37414d",
    REFERENCE: "#6f7b88",
    LIMIT_COLOUR: "#ff7b72",
    PAPER: "#12171e",
    PLATE: "#2b333d",
    GHOST: "#4d5a68",
    **dict(zip(PALETTE, ("#4aa8e8", "#f08a3c", "#33c79a", "#e08ad2", "#a99cf5", "#d9b93b"), strict=True)),
}
NAMED = {"ink": INK, "muted": MUTED, "faint": FAINT, "reference": REFERENCE, "limit": LIMIT_COLOUR, "paper": PAPER}
FONT, FONT_SIZE = "DejaVu Sans", 9.0
STYLE = FOLDER / "figures.mplstyle"  # how figures look, and how they are written: colours, sizes, fonts

# Inches of a figure that shares the page's width with another, and of one that has it to itself.
WIDTH, FULL_WIDTH = 5.4, 11.0
DOTS_PER_INCH = 160


def ink(name: Ink) -> str:
    """A colour of the palette by its number, or one that has a name."""
    return NAMED[name] if isinstance(name, str) else PALETTE[name % len(PALETTE)]
