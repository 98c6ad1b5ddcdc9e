"""Crank speed by the corrected model, by the model as printed and by the engines, and how far each is off."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from analytic.description.linkage import Erratum
from analytic.motion.released import FreeMotion
from reports.drawing.curves import thinned
from reports.drawing.panels import Other, draw_errors_beneath, draw_methods
from reports.drawing.style import FULL_WIDTH, LIMIT_COLOUR, panels
from reports.facts.printed_models import printed_motion
from reports.facts.released import released
from reports.facts.views import Regime, View

Array = NDArray[np.float64]

POINTS_PER_TURN, LEAST_POINTS = 30, 2000
HEIGHT = 3.9


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
        upper.set_ylabel("ω, rad/s")
        upper.yaxis.set_major_locator(MaxNLocator(5))
        draw_errors_beneath(lower, view, traces, [missed])
        lower.set_xlim(0.0, float(time[-1]))
        lower.set_xlabel("time, s")

    return panels(FULL_WIDTH, HEIGHT, (0.067, 0.86, 0.97, 0.12), draw, ratios=(1.15, 1.0))


def _instants(motion: FreeMotion) -> Array:
    """Instants, s, close enough to see every turn."""
    turns = abs(float(motion.angle(motion.duration)) - motion.start[0]) / (2.0 * np.pi)
    return np.linspace(0.0, motion.duration, max(LEAST_POINTS, round(POINTS_PER_TURN * turns)))
