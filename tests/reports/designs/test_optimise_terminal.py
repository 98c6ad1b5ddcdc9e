"""Curves before and after a change: torque first, peaks marked."""

import numpy as np
import pytest

from analytic.description.crank_motion import RPM
from comparisons.designs.optimisation import OptimisationRequest, optimise
from comparisons.designs.parameters import steady_motion
from reports.charts import draw
from reports.charts.scales import MUTED, PALETTE
from reports.designs.optimise_terminal import before_after_chart
from reports.document.numbers import figure as digits
from tests.analytic.linkages import mechanism
from tests.reports.drawn_words import texts


def test_torque_comes_first_and_both_peaks_are_marked():
    rimoldi = mechanism("rimoldi-164")
    wanted = OptimisationRequest("joint_force:A.peak", ("rod.B.x=170:180",))
    optimum = optimise(rimoldi, steady_motion(rimoldi, 1000.0 * RPM, samples=90), wanted, lambda *_: None)
    torque = optimum.curves()["Mkr"]
    figure = draw.figure(before_after_chart(optimum, "made-up"))
    first, second = figure.axes
    assert {"before", "after", "made-up"} <= set(texts(figure))
    before, after = (values[np.argmax(np.abs(values))] for values in torque)
    assert f"Mkr: peak {digits(before)} → {digits(after)} N*m" in texts(figure, first)
    assert any(text.startswith("joint_force:A: peak ") for text in texts(figure, second))
    dots = {line.get_color(): line.get_ydata()[0] for line in first.lines if line.get_marker() == "o"}
    assert dots == {MUTED: pytest.approx(before), PALETTE[0]: pytest.approx(after)}
    assert "crank angle φ, °" in texts(figure, second)
    assert second.get_xlim() == (0.0, 360.0)
