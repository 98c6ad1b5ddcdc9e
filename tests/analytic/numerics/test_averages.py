"""Means against integrals in closed form: smooth curves, spikes, kinks, jumps at an edge, and nothing but rounding."""

import math

import numpy as np
import pytest
from mpmath import mp, mpf

from analytic.numerics.averages import averages

SPIKE = 1e-5
CURVES = {  # of a curve over 0 to 2 its mean
    "smooth": (lambda x: np.exp(np.sin(20.0 * x) + x), None),
    "a spike between any samples": (lambda x: SPIKE / ((x - 0.123) ** 2 + SPIKE**2), None),
    "kinks": (lambda x: np.abs(np.sin(7.0 * x)), (2.0 * 4 + 1.0 - math.cos(14.0 - 4.0 * math.pi)) / 14.0),
    "a jump at an edge": (lambda x: np.where(x < 1.5, 1.0, 5.0), 2.0),
    "zero": (np.zeros_like, 0.0),
}


def truth(name):
    """Integrals that are known, or worked out in 30 digits."""
    with mp.workdps(30):
        if name == "smooth":
            return float(mp.quad(lambda x: mp.exp(mp.sin(20 * x) + x), mp.linspace(0, 2, 41)) / 2)
        ends = [(mpf(end) - mpf(0.123)) / mpf(SPIKE) for end in (0, 2)]
        return float((mp.atan(ends[1]) - mp.atan(ends[0])) / 2)


@pytest.mark.parametrize("name", CURVES)
def test_a_mean_is_the_integral(name):
    curve, known = CURVES[name]
    expected = truth(name) if known is None else known
    (result,) = averages(lambda _, x: curve(x)[None], np.linspace(0.0, 2.0, 13))
    assert result == pytest.approx(expected, rel=1e-10, abs=1e-15)


def test_rows_have_curves_of_their_own_and_nan_stays_with_them():
    shift = np.array([0.1, np.nan, 0.7])
    result = averages(lambda row, x: np.stack([(x - shift[row, None]) ** 2, x + 0.0 * shift[row, None]]),
                     np.array([0.0, 0.5, 1.0]), 3)  # fmt: skip
    expected = [[((1.0 - s) ** 3 + s**3) / 3.0 for s in shift], [0.5, np.nan, 0.5]]
    np.testing.assert_allclose(result, expected, rtol=1e-14)


def test_what_is_nothing_but_rounding_ends():
    seen = []

    def curves(_, x):
        seen.append(x.size)
        return np.stack([1e-20 * np.sin(1e9 * x), 1.0 / (x + 1e-3)])

    rounding, mean = averages(curves, np.linspace(0.0, 1.0, 13))[:, 0]
    assert abs(rounding) < 1e-20
    assert mean == pytest.approx(math.log(1001.0), rel=1e-12)
    assert sum(seen) < 20_000


def test_of_an_interval_without_length_it_is_the_value_there():
    assert averages(lambda _, x: np.cos(x)[None], np.full(13, 0.3)) == pytest.approx(math.cos(0.3), rel=1e-15)
