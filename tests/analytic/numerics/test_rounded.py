"""Bounds of rounded numbers against the same formulas in 50 digits."""

import mpmath as mp
import numpy as np
import pytest

from analytic.numerics.rounded import Rounded, bound_of

FORMULAS = {
    "difference": lambda a, b, _: (a - b) * a + b,
    "quotient": lambda a, b, _: (a + b) / (a - b),
    "length": lambda a, b, m: m.sqrt(a * a + b**2) - abs(b),
    "turn": lambda a, b, m: m.cos(a) * b - m.sin(a) / b,
}


@pytest.mark.parametrize("formula", FORMULAS.values(), ids=FORMULAS)
def test_the_error_stays_below_its_bound(formula):
    near = np.random.default_rng(1)
    for a, b in near.uniform(0.5, 3.0, (50, 2)):
        error = 1e-9 * near.uniform(-1.0, 1.0)
        number = formula(Rounded(a, np.float64(1e-9)), Rounded(b, np.float64(0.0)), np)
        with mp.workdps(50):
            true = formula(mp.mpf(a) + mp.mpf(error), mp.mpf(b), mp)
            assert abs(number.value - true) <= 1.0001 * number.bound


def test_a_plain_number_is_exact_and_an_unknown_function_is_refused():
    assert bound_of(2.0) == 0.0
    with pytest.raises(TypeError):
        np.exp(Rounded(1.0))
