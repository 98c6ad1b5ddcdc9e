"""Limits and round scales of a panel."""

import numpy as np
import pytest

from reports.charts import draw
from reports.document.chart import Chart, Curve, Mark, Panel
from tests.reports.drawn_words import texts

X = np.linspace(0.0, 1.0, 101)


def drawn(values, **more):
    """A figure of a curve, and the limits of its y axis."""
    figure = draw.figure(Chart((Panel((Curve(X[: len(values)], np.asarray(values)),), "t, s", "F, N", **more),)))
    return figure, figure.axes[0].get_ylim()


@pytest.mark.parametrize("values", [np.full(101, 3.3), 3.3 * (1.0 + 1e-15 * np.sin(1e3 * X)), np.zeros(101), [np.nan]])
def test_a_flat_curve_stands_in_the_middle_whatever_its_rounding(values):
    figure, (low, high) = drawn(values)
    middle = np.nan_to_num(values[0], nan=0.5 * (low + high))
    assert middle - low == pytest.approx(high - middle)
    assert high - low > 1e-2 * abs(middle)
    assert len(texts(figure)) > 8


def test_an_error_that_dips_to_zero_keeps_its_decades():
    error = 1e-9 * np.abs(X - 0.5) + 1e-30
    figure, limits = drawn(error, scale="log", marks=(Mark(1e-6, "y"),))
    assert limits == pytest.approx((1e-11, 1e-6))
    assert "10⁻¹¹" in texts(figure)


@pytest.mark.parametrize(("values", "starts"), [(X + 0.1, True), (X + 10.0, False), (-X, False)])
def test_an_axis_of_magnitudes_starts_at_zero(values, starts):
    assert (drawn(values)[1][0] == 0.0) == starts


@pytest.mark.parametrize(("factor", "label"), [(1.0, "F, N"), (1e6, "F, 10⁶ N"), (1e-7, "F, 10⁻⁷ N")])
def test_small_and_large_values_share_a_power_of_ten_in_the_label(factor, label):
    words = texts(drawn(factor * (1.0 + X))[0])
    assert label in words
    assert {"0.0", "1.0", "2.0"} <= set(words)
    assert not any("e" in word for word in words)
