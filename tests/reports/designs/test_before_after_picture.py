"""Curves before and after a change: torque first, peaks marked, whatever the values."""

import numpy as np
import pytest

from reports.charts import draw
from reports.charts.scales import MUTED, PALETTE
from reports.designs.optimise_terminal import Change, before_after_figure
from tests.reports.drawn_words import texts

ANGLE = np.arange(0.0, 360.0, 2.0)
WAVE = np.sin(np.radians(ANGLE))


def test_torque_comes_first_and_both_peaks_are_marked():
    signals = {
        "joint_force:needle_bar on ground": Change(ANGLE, 100.0 + WAVE, 90.0 - WAVE, "N"),
        "Mkr": Change(ANGLE, -0.27 * WAVE - 0.01, 0.2 * WAVE + 0.01, "N*m"),
    }
    figure = before_after_figure(signals, "made-up")
    first, second = figure.axes
    assert {"before", "after", "made-up"} <= set(texts(figure))
    assert "Mkr: peak -0.2800 → 0.2100 N*m" in texts(figure, first)
    assert "joint_force:needle_bar on ground: peak 101.0 → 91.00 N" in texts(figure, second)
    dots = {line.get_color(): line.get_xydata().tolist() for line in first.lines if line.get_marker() == "o"}
    assert dots == {MUTED: [pytest.approx([90.0, -0.28])], PALETTE[0]: [pytest.approx([90.0, 0.21])]}
    assert "crank angle φ, °" in texts(figure, second)
    assert second.get_xlim() == (0.0, 360.0)


@pytest.mark.parametrize("values", [np.full(5, np.nan), np.zeros(0), np.full(5, 1e300)])
def test_any_values_are_drawn(values):
    places = np.linspace(0.1, 0.2, len(values))
    figure = before_after_figure({"S": Change(places, values, values, "")}, axis="travel of the drive, m")
    assert draw.svg(figure)
    assert len(figure.axes) == 1
