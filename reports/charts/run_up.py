"""A regime over time: one quantity by the closed form and the engines, and their deviation beneath."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from analytic.description.crank_motion import RPM
from analytic.motion.rkfixed import PUBLISHED_STEPS
from comparisons.judging.quantities import QUANTITIES
from comparisons.reference.case import Case
from reports.charts.inertia import power_for
from reports.charts.panels import Other, draw_errors_beneath, draw_methods, thinned
from reports.charts.style import INK, MUTED, label_values, panels
from reports.facts.released import Released, released
from reports.records.joint_rows import worst_joint
from reports.records.views import Regime, View, family

Array = NDArray[np.float64]

# Quantities whose history is drawn, in this order; S, v and a are drawn over the crank angle instead.
SHOWN = ("phi", "omega", "epsilon", "Mkr", "Teq", "Peq", "Jeq")
# What the articles' integrator is drawn for beside the engines.
COARSE, SPEED = ("phi", "omega", "epsilon"), "omega"
POINTS_PER_TURN, LEAST_POINTS = 180, 1500
# Below this an axis counts in a power of ten.
SMALL = 1e-2


def histories(view: View, regime: Regime) -> list[str]:
    """The quantities of a regime whose histories are drawn, the worst of the forces in the joints last."""
    names = [record.quantity for record in view.records if record.regime == regime.name]
    return [name for name in SHOWN if name in names] + worst_joint(view, regime)


def history_figure(view: View, regime: Regime, quantity: str) -> Figure:
    """A quantity over the time of a regime."""

    def draw(upper: Axes, lower: Axes) -> None:
        draw_history(upper, lower, view, regime, quantity)
        if quantity == SPEED:
            _count_turns(upper)

    figure = panels("history", draw)
    if quantity == SPEED:  # room for the second scale
        figure.subplots_adjust(right=0.64)
    return figure


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
    found = released(view, regime) if quantity in COARSE else None
    draw_errors_beneath(lower, view, traces, _coarse_errors(view, regime, quantity, found) if found else ())
    if found and found.coarse and quantity != "epsilon":  # which swings so fast that two curves hide each other
        values = found.coarse.angle if quantity == "phi" else found.coarse.speed
        upper.plot(*thinned(found.coarse.time, values), color=INK, linewidth=0.6, zorder=4.0)
    unit = next((record.unit for record in view.records if record.quantity == quantity), "")
    label_values(upper, f"{symbol(quantity)}, {prefix}{unit}")
    lower.set_xlim(0.0, float(time[-1]) if len(time) else 1.0)
    lower.xaxis.set_major_locator(MaxNLocator(8))
    lower.set_xlabel("time, s")


def _coarse_errors(view: View, regime: Regime, quantity: str, found: Released) -> list[Other]:
    """The error of the articles' integrator over the same peak as the engines'; nothing where it broke down."""
    missed = found.coarse_error(quantity)
    peak = max((trace.record.peak or 0.0 for trace in view.traces(regime, quantity)), default=0.0)
    return [Other(f"{PUBLISHED_STEPS} steps", INK, missed[0], missed[1] / peak)] if missed and peak > 0.0 else []


def _in_rpm(speed: ArrayLike) -> ArrayLike:
    return np.asarray(speed, dtype=float) / RPM


def _in_radians(rpm: ArrayLike) -> ArrayLike:
    return np.asarray(rpm, dtype=float) * RPM


def _count_turns(axes: Axes) -> None:
    """The crank speed in rpm on the right, the key beyond it."""
    scale = axes.secondary_yaxis("right", functions=(_in_rpm, _in_radians))
    scale.set_ylabel("n, rpm", labelpad=2.0)
    scale.yaxis.set_major_locator(MaxNLocator(5))
    key = axes.get_legend()
    if key is not None:
        key.set_bbox_to_anchor((1.27, 1.04))


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
