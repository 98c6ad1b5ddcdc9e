"""The linkages of the literature against their sources, evaluated by themselves in 50 digits."""

import numpy as np
import pytest
from mpmath import mp, mpc, mpf

from analytic.description.loading import literature
from analytic.dynamics.released import free_motion
from tests.analytic.andrews import accelerations, state_after
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
    low, high = mechanism(name).crank_range().limits
    for end, outward in ((low, -1), (high, 1)):
        formula(mpf(end) - outward * TOGGLE)
        with pytest.raises(ValueError, match="do not meet"):
            formula(mpf(end) + outward * TOGGLE)


@pytest.mark.nightly
def test_andrews_mechanism_moves_as_by_the_seven_equations_of_its_source():
    sample = mechanism("andrews-squeezer")
    (regime,) = sample.linkage.regimes
    motion = free_motion(
        sample, torque=regime.torque, start_angle=regime.start_angle, start_speed=0.0, duration=regime.duration
    )
    angles, rates = state_after(regime.duration)
    assert motion.angle(regime.duration) == pytest.approx(angles[0], rel=1e-13)
    assert motion.speed(regime.duration) == pytest.approx(rates[0], rel=1e-12)
    assert motion.acceleration(regime.duration) == pytest.approx(accelerations(angles, rates)[0][0], rel=1e-10)
    sweep = sample.sweep(motion.angle(regime.duration))
    absolute = {"K3": angles[2], "K4": angles[3] + angles[4], "K5": angles[4], "K6": angles[5] + angles[6]}
    for link, angle in absolute.items():
        assert sweep.angles(link) == pytest.approx(angle, rel=1e-12)
