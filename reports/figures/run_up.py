"""A regime over time: one quantity by the closed form and the engines, and their deviation beneath."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from comparisons.case import Case
from comparisons.quantities import QUANTITIES
from reports.figures.inertia import power_for
from reports.figures.panels import draw_errors_beneath, draw_methods
from reports.figures.style import MUTED, WIDTH, drawn
from reports.views import Regime, View, family

Array = NDArray[np.float64]

# Quantities whose history is drawn, in this order; S, v and a are drawn over the crank angle instead.
SHOWN = ("phi", "omega", "epsilon", "Mkr", "Teq", "Peq", "Jeq")
HEIGHT = 3.5
POINTS_PER_TURN, LEAST_POINTS = 180, 1500
# Below this an axis counts in a power of ten.
SMALL = 1e-2


def histories(view: View, regime: Regime) -> list[str]:
    """The quantities of a regime whose histories are drawn, forces in the joints last."""
    names = [record.quantity for record in view.records if record.regime == regime.name]
    parts = sorted({name for name in names if name != family(name)})
    return [name for name in SHOWN if name in names] + parts


def history_figure(view: View, regime: Regime, quantity: str) -> Figure:
    """A quantity over the time of a regime."""

    def draw(figure: Figure) -> None:
        upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (1.35, 1), "hspace": 0.12})
        figure.subplots_adjust(left=0.155, right=0.77, top=0.97, bottom=0.12)
        draw_history(upper, lower, view, regime, quantity)

    return drawn(WIDTH, HEIGHT, draw)


def draw_history(upper: Axes, lower: Axes, view: View, regime: Regime, quantity: str) -> None:
    """Values above, |error| over peak below; acceleration jumps are marked in both."""
    traces = view.traces(regime, quantity)
    time, values = truth(view, regime, quantity)
    largest = float(np.max(np.abs(values), initial=0.0))
    factor, prefix = power_for(largest) if 0.0 < largest < SMALL else (1.0, "")
    for axes in (upper, lower):
        for jump in regime.jumps:
            axes.axvline(jump, color=MUTED, linewidth=0.7, linestyle=(0, (1, 2)), zorder=1.0)
    draw_methods(upper, view, (time, values), traces, factor)
    draw_errors_beneath(lower, view, traces)
    unit = next((record.unit for record in view.records if record.quantity == quantity), "")
    upper.set_ylabel(f"{symbol(quantity)}, {prefix}{unit}")
    upper.yaxis.set_major_locator(MaxNLocator(5))
    lower.set_xlim(0.0, float(time[-1]) if len(time) else 1.0)
    lower.xaxis.set_major_locator(MaxNLocator(8))
    lower.set_xlabel("time, s")


def symbol(quantity: str) -> str:
    """How a quantity is written on an axis; a force is drawn by its magnitude."""
    if quantity != family(quantity):
        return "|F|"
    return {"phi": "φ", "omega": "ω", "epsilon": "ε"}.get(quantity, quantity)


def truth(view: View, regime: Regime, quantity: str) -> tuple[Array, Array]:
    """The closed form as the campaign had it, from the longest curve; evaluated anew where no run gave one."""
    traces = view.traces(regime, quantity)
    if traces:
        longest = max(traces, key=lambda trace: len(trace.time))
        return longest.time, longest.reference
    motion = regime.motion
    if motion is None or quantity not in QUANTITIES:
        return np.empty(0), np.empty(0)
    turns = float(np.ptp(motion.angle(np.linspace(0.0, motion.duration, 100)))) / (2.0 * np.pi)
    time = np.linspace(0.0, motion.duration, max(LEAST_POINTS, round(POINTS_PER_TURN * turns)))
    return time, QUANTITIES[quantity].reference(Case(view.mechanism, motion), time)
