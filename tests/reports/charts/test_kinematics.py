"""S, v and a over a turn, forwards and backwards."""

import numpy as np
import pytest

from reports.charts import kinematics
from reports.records.views import views
from tests.reports.made_up_results import made_up_results


@pytest.mark.parametrize("clockwise", [False, True])
def test_the_output_goes_once_up_and_down(clockwise):
    (view,) = views(made_up_results(samples=21, clockwise=clockwise))
    angle, values = kinematics.turn_at_final_speed(view)
    assert np.all(np.diff(angle) > 0.0)
    assert (angle[0], angle[-1]) == (0.0, 360.0)
    assert values["S"].max() == pytest.approx(0.031, rel=1e-6)
    assert values["S"].min() == pytest.approx(0.0, abs=1e-9)
    rate = np.gradient(values["S"], np.radians(angle)) * view.final_speed
    np.testing.assert_allclose(rate[1:-1], values["v"][1:-1], atol=1e-4 * np.abs(values["v"]).max())


def test_extremes_are_marked_with_value_and_angle():
    (view,) = views(made_up_results(samples=21))
    texts = [text.get_text() for axes in kinematics.output_figure(view).axes for text in axes.texts]
    assert "31.00 at 270°" in texts
    assert "0 at 90°" in texts
    assert "−218.3 at 270°" in texts


def test_differences_name_their_means():
    (view,) = views(made_up_results(samples=21))
    (axes,) = kinematics.difference_figure(view).axes
    assert any("9.05 %" in text.get_text() for text in axes.texts)
