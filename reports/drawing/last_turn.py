"""The last turn of a released crank: speed in rpm and acceleration over the crank angle, closed form and engines."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from reports.drawing.curves import over_last_turn
from reports.drawing.panels import draw_methods
from reports.drawing.style import FULL_WIDTH, drawn, over_turn
from reports.facts.released import Released
from reports.facts.views import Regime, View

Array = NDArray[np.float64]

POINTS = 721
PANELS = (("omega", "n, rpm", 1.0 / RPM), ("epsilon", "ε, rad/s²", 1.0))


def last_turn_figure(view: View, regime: Regime, found: Released) -> Figure:
    """N and ε over the last full turn; the motion must have made one."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, 2, gridspec_kw={"wspace": 0.62})
        figure.subplots_adjust(left=0.067, right=0.89, top=0.95, bottom=0.16)
        for axes, (quantity, label, factor) in zip(panels, PANELS, strict=True):
            traces = [over_last_turn(trace) for trace in view.traces(regime, quantity)]
            draw_methods(axes, view, _truth(found, quantity), traces, factor)
            axes.set_ylabel(label)
            axes.yaxis.set_major_locator(MaxNLocator(5))
            over_turn(axes)

    return drawn(FULL_WIDTH, 2.7, draw)


def _truth(found: Released, quantity: str) -> tuple[Array, Array]:
    """Crank angle, degrees in order, and the closed form's value over the last turn."""
    motion, rotation = found.motion, found.ending
    assert rotation is not None, "only a motion that ends in a full turn has a last one"
    start = motion.duration - 2.0 * np.pi / abs(rotation.mean_speed)
    time = np.linspace(start, motion.duration, POINTS)[1:]
    values = motion.speed(time) if quantity == "omega" else motion.acceleration(time)
    degrees = np.degrees(motion.angle(time)) % 360.0
    order = np.argsort(degrees)
    return degrees[order], values[order]
