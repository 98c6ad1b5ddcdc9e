"""Round scales of a panel."""

import numpy as np
import pytest

from reports.charts import scales
from reports.document.chart import Curve, Mark, Panel

X = np.linspace(0.0, 1.0, 101)


def upward(values, ticks=5, **more):
    return scales.upward(Panel((Curve(X[: len(values)], np.asarray(values)),), "t, s", "F, N", **more), ticks)


def test_a_flat_curve_stands_in_the_middle_whatever_its_rounding():
    for values in (np.full(101, 3.3), 3.3 * (1.0 + 1e-15 * np.sin(1e3 * X)), np.zeros(101)):
        scale = upward(values)
        assert scale.share(values[0]) == pytest.approx(0.5)
        assert len(scale.ticks) > 2


def test_what_is_not_a_number_decides_nothing():
    assert upward([0.5, np.nan, 1.0, np.inf]) == upward([0.5, 0.75, 1.0])
    assert len(upward([np.nan]).ticks) > 1


def test_an_error_that_dips_to_zero_keeps_its_decades():
    error = 1e-9 * np.abs(X - 0.5) + 1e-30
    scale = upward(error, scale="log", marks=(Mark(1e-6, "y"),))
    assert (scale.low, scale.high) == pytest.approx((1e-11, 1e-6))
    assert scale.words[0] == "10⁻¹¹"


def test_an_axis_of_magnitudes_starts_at_zero():
    assert upward(X + 0.1).low == 0.0
    assert upward(X + 10.0).low > 9.0


@pytest.mark.parametrize(("factor", "words"), [(1.0, "F, N"), (1e6, "F, 10⁶ N"), (1e-7, "F, 10⁻⁷ N")])
def test_ticks_tell_their_values(factor, words):
    scale = upward(factor * (1.0 + X))
    assert scale.label == words
    power = 1.0 if factor == 1.0 else factor
    assert [float(word.replace("−", "-")) * power for word in scale.words] == pytest.approx(scale.ticks)
