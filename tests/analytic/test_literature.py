"""The linkages of the literature against their sources, evaluated by themselves in 50 digits."""

import numpy as np
import pytest
from mpmath import mp, mpc, mpf

from analytic.description.loading import literature
from analytic.kinematics.crank_range import crank_range
from tests.analytic.fifty_digits import DIGITS
from tests.analytic.linkages import mechanism
from tests.analytic.literature import FORMULAS

# A hundredth of a degree from a toggle rounding errors of the lengths grow some thousandfold.
NEAR_TOGGLE = 1e-12
# rad: to which the end of a crank's range is known.
TOGGLE = mpf("1e-13")


@pytest.fixture(autouse=True)
def _fifty_digits():
    mp.dps = DIGITS


def test_every_linkage_has_its_formulas():
    assert set(FORMULAS) == set(literature())


@pytest.mark.parametrize("name", FORMULAS)
def test_points_are_the_sources(name):
    formula, unit, degrees = FORMULAS[name]
    limit = NEAR_TOGGLE * mechanism(name).linkage.extent()
    for angle in np.radians(degrees):
        sweep = mechanism(name).sweep(angle)
        for point, place in formula(mpf(float(angle))).items():
            x, y = map(float, sweep.point(point))
            assert abs(place * mpf(unit) - mpc(x, y)) <= limit, (point, angle)


@pytest.mark.parametrize("name", ["watt-six-bar", "stephenson-six-bar"])
def test_a_toggle_is_where_two_links_of_the_source_are_in_line(name):
    formula = FORMULAS[name][0]
    low, high = crank_range(mechanism(name)).limits
    for end, outward in ((low, -1), (high, 1)):
        formula(mpf(end) - outward * TOGGLE)
        with pytest.raises(ValueError, match="do not meet"):
            formula(mpf(end) + outward * TOGGLE)
