"""Tornadoes: bars sorted by size, either side of the nominal value, and nothing left out unsaid."""

import numpy as np
import pytest

from comparisons.designs.tolerances import Tornado
from reports.charts import draw
from reports.charts.scales import PALETTE
from reports.designs.tolerance_terminal import WIDE, tornado_figure
from tests.reports.drawn_words import texts

PEAK = Tornado(
    "Mkr.peak", "N*m", 0.27, (("a.x", -1e-3, 2e-3), ("b.y", -5e-3, 4e-3), ("c.mass", 3e-3, 1e-3), ("d.x", 0.0, 0.0))
)


def bars(axes):
    """(row, end) of the bars at the lower and at the upper limit, from above."""
    found = [line for line in axes.lines if line.get_linewidth() == WIDE and len(line.get_xdata()) == 2]
    return [sorted((round(line.get_ydata()[0]), line.get_xdata()[1]) for line in found if line.get_color() == colour)
            for colour in PALETTE[:2]]  # fmt: skip


def test_the_largest_bar_is_on_top_and_what_moves_nothing_is_counted():
    figure = tornado_figure([PEAK], "Tolerances")
    (axes,), words = figure.axes, texts(figure)
    assert {"Tolerances", "at the lower limit", "at the upper limit"} <= set(words)
    assert bars(axes) == [[(0, -5e-3), (1, 3e-3), (2, -1e-3)], [(0, 4e-3), (1, 1e-3), (2, 2e-3)]]
    assert [word for word in words if word in {"a.x", "b.y", "c.mass", "d.x"}] == ["b.y", "c.mass", "a.x"]
    assert {"Mkr.peak: 0.2700 N*m; 1 moves nothing", "change, N*m"} <= set(words)
    low, high = axes.get_xlim()
    assert low <= -5e-3 < 4e-3 <= high


@pytest.mark.parametrize("values", [(), (("a.x", np.nan, 1.0),), (("a.x", 0.0, 0.0),), (("a.x", -1e-300, 1e300),)])
def test_results_that_nothing_moves_or_that_break_are_drawn(values):
    assert draw.svg(tornado_figure([Tornado("stroke", "", np.nan, values)]))
