"""Crank speed by the corrected model, by the model as printed and by the engines."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from analytic.free_motion import FreeMotion
from analytic.linkage import Erratum
from reports.figures.curves import thinned
from reports.figures.panels import draw_methods
from reports.figures.style import FULL_WIDTH, LIMIT_COLOUR, drawn
from reports.printed_models import printed_motion
from reports.released import Released, released
from reports.views import Regime, View

Array = NDArray[np.float64]

POINTS_PER_TURN, LEAST_POINTS = 30, 2000


def printed_figure(view: View, erratum: Erratum) -> Figure:
    """ω over the time of the regime in which the two models part."""
    conditions = next((one.conditions for one in view.regimes if one.name == erratum.regime), "")
    regime = Regime(erratum.regime, conditions, None)
    corrected, printed = released(view, regime), printed_motion(view, erratum)

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        figure.subplots_adjust(left=0.067, right=0.86, top=0.97, bottom=0.17)
        axes.plot(*_speed(printed), color=LIMIT_COLOUR, linewidth=1.2, linestyle=(0, (6, 2)), label="as printed")
        assert isinstance(corrected, Released)
        draw_methods(axes, view, _speed(corrected.motion), view.traces(regime, "omega"))
        axes.set_ylabel("ω, rad/s")
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.set_xlim(0.0, printed.duration)
        axes.set_xlabel("time, s")

    return drawn(FULL_WIDTH, 2.6, draw)


def _speed(motion: FreeMotion) -> tuple[Array, Array]:
    """Time, s, and ω, rad/s, finely enough for every turn and thinned for drawing."""
    turns = abs(float(motion.angle(motion.duration)) - motion.start[0]) / (2.0 * np.pi)
    time = np.linspace(0.0, motion.duration, max(LEAST_POINTS, round(POINTS_PER_TURN * turns)))
    return thinned(time, motion.speed(time))
