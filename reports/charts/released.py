"""A released crank: its last turn, and its speed by the corrected model, by the model as printed and by the engines."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from analytic.description.schema import Erratum
from analytic.motion.released import FreeMotion
from reports.charts.panels import Other, draw_errors_beneath, draw_methods, over_last_turn, thinned
from reports.charts.style import FULL_WIDTH, LIMIT_COLOUR, drawn, label_values, over_turn, panels
from reports.facts.printed_models import printed_motion
from reports.facts.released import Released, released
from reports.records.views import Regime, View

Array = NDArray[np.float64]

LAST_TURN_POINTS = 721
LAST_TURN = (("omega", "n, rpm", 1.0 / RPM), ("epsilon", "ε, rad/s²", 1.0))
POINTS_PER_TURN, LEAST_POINTS = 30, 2000


def last_turn_figure(view: View, regime: Regime, found: Released) -> Figure:
    """N and ε over the last full turn; the motion must have made one."""

    def draw(figure: Figure) -> None:
        grid = figure.subplots(1, 2, gridspec_kw={"wspace": 0.62})
        figure.subplots_adjust(left=0.067, right=0.89, top=0.95, bottom=0.16)
        for axes, (quantity, label, factor) in zip(grid, LAST_TURN, strict=True):
            traces = [over_last_turn(trace) for trace in view.traces(regime, quantity)]
            draw_methods(axes, view, _truth(found, quantity), traces, factor)
            label_values(axes, label)
            over_turn(axes)

    return drawn(FULL_WIDTH, 2.7, draw)


def _truth(found: Released, quantity: str) -> tuple[Array, Array]:
    """Crank angle, degrees in order, and the closed form's value over the last turn."""
    motion, rotation = found.motion, found.ending
    assert rotation is not None, "only a motion that ends in a full turn has a last one"
    start = motion.duration - 2.0 * np.pi / abs(rotation.mean_speed)
    time = np.linspace(start, motion.duration, LAST_TURN_POINTS)[1:]
    values = motion.speed(time) if quantity == "omega" else motion.acceleration(time)
    degrees = np.degrees(motion.angle(time)) % 360.0
    order = np.argsort(degrees)
    return degrees[order], values[order]


def printed_figure(view: View, erratum: Erratum) -> Figure:
    """ω over the time of the regime in which the two models part, and beneath what parts them from the corrected."""
    regime = Regime(erratum.regime, "", None)
    corrected, traces = released(view, regime), view.traces(regime, "omega")
    assert corrected is not None, "a printed model belongs to a regime of the linkage's own"
    time = _instants(corrected.motion)
    truth, theirs = corrected.motion.speed(time), printed_motion(view, erratum).speed(time)
    missed = Other("as printed", LIMIT_COLOUR, time, np.abs(theirs - truth) / float(np.max(np.abs(truth))))

    def draw(upper: Axes, lower: Axes) -> None:
        draw_methods(upper, view, (time, truth), traces)
        upper.plot(*thinned(time, theirs), color=LIMIT_COLOUR, linewidth=1.2, label="as printed", zorder=4.0)
        upper.legend(loc="upper left", bbox_to_anchor=(1.0, 1.04), handlelength=1.9)
        label_values(upper, "ω, rad/s")
        draw_errors_beneath(lower, view, traces, [missed])
        lower.set_xlim(0.0, float(time[-1]))
        lower.set_xlabel("time, s")

    return panels("printed", draw)


def _instants(motion: FreeMotion) -> Array:
    """Instants, s, close enough to see every turn."""
    turns = abs(float(motion.angle(motion.duration)) - motion.start[0]) / (2.0 * np.pi)
    return np.linspace(0.0, motion.duration, max(LEAST_POINTS, round(POINTS_PER_TURN * turns)))
