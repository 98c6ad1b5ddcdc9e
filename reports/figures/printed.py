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
from reports.released import released
from reports.views import Regime, View

Array = NDArray[np.float64]

POINTS_PER_TURN, LEAST_POINTS = 30, 2000


def printed_figure(view: View, erratum: Erratum) -> Figure:
    """ω over the time of the regime in which the two models part."""
    conditions = next((one.conditions for one in view.regimes if one.name == erratum.regime), "")
    regime = Regime(erratum.regime, conditions, None)
    corrected, printed = released(view, regime), printed_motion(view, erratum)
    assert corrected is not None, "a printed model belongs to a regime of the linkage's own"
    time = _instants(corrected.motion)

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        figure.subplots_adjust(left=0.067, right=0.86, top=0.97, bottom=0.17)
        draw_methods(axes, view, (time, corrected.motion.speed(time)), view.traces(regime, "omega"))
        axes.plot(
            *thinned(time, printed.speed(time)), color=LIMIT_COLOUR, linewidth=1.2, label="as printed", zorder=4.0
        )
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.04), handlelength=1.9)
        axes.set_ylabel("ω, rad/s")
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.set_xlim(0.0, float(time[-1]))
        axes.set_xlabel("time, s")

    return drawn(FULL_WIDTH, 2.6, draw)


def _instants(motion: FreeMotion) -> Array:
    """Instants, s, close enough to see every turn."""
    turns = abs(float(motion.angle(motion.duration)) - motion.start[0]) / (2.0 * np.pi)
    return np.linspace(0.0, motion.duration, max(LEAST_POINTS, round(POINTS_PER_TURN * turns)))
