"""The files of catalogue and literature against their sources' formulas, evaluated by themselves in 50 digits."""

import numpy as np
import pytest
from mpmath import mp, mpc, mpf

from analytic.description.loading import catalogue, literature, load
from analytic.dynamics import reduced
from analytic.dynamics.released import free_motion
from analytic.numerics.refine import zeros
from tests.analytic.andrews import accelerations, state_after
from tests.analytic.articles import FORMULAS, reduced_inertia
from tests.analytic.fifty_digits import DIGITS
from tests.analytic.linkages import angles, mechanism
from tests.analytic.literature import FORMULAS as LITERATURE
from tests.analytic.tolerances import FIFTY_DIGITS


@pytest.fixture(autouse=True)
def _fifty_digits():
    mp.dps = DIGITS


def test_every_file_and_variant_has_its_formulas():
    # y-along is a second reading of Table 1 that leaves Jeq and all positions as they are.
    known = {(name, variant) for name in catalogue() for variant in load(name).variants}
    assert known - set(FORMULAS) == {("rimoldi-164", "y-along")}


@pytest.mark.parametrize(("name", "variant"), FORMULAS)
def test_points_and_mass_centres_are_the_articles(name, variant):
    for angle in angles(4):
        drawn = FORMULAS[name, variant](mpf(float(angle)))
        sweep = mechanism(name, variant).sweep(angle)
        pairs = [(sweep.point(point), place) for point, place in drawn.points.items()]
        pairs += [(sweep.centre(link), centre) for link, (_, _, centre, _) in drawn.links.items()]
        limit = FIFTY_DIGITS * mechanism(name, variant).linkage.extent()
        for (x, y), place in pairs:
            assert abs(float(place.real / 1000 - mpf(float(x)))) <= limit
            assert abs(float(place.imag / 1000 - mpf(float(y)))) <= limit


@pytest.mark.parametrize(("name", "variant"), [pair for pair in FORMULAS if pair[0] != "fork-takeup"])
def test_reduced_inertia_is_the_articles(name, variant):
    got = reduced.reduced_inertia(mechanism(name, variant).sweep(angles(4)))
    exact = [float(reduced_inertia(FORMULAS[name, variant], mpf(float(angle)))) for angle in angles(4)]
    assert got == pytest.approx(exact, rel=FIFTY_DIGITS)


@pytest.mark.parametrize(
    ("name", "variant", "degrees"),
    [
        ("slotted-takeup", "corrected", 268.77),
        ("two-crank-takeup", "corrected", 105.42),
        ("two-crank-takeup", "as-printed", 102.09),
    ],
)
def test_gravity_equilibria_are_the_specifications(name, variant, degrees):
    # Article 000 prints 269.18°, article 001 101°; the specification finds 268.77° and 102-105°.
    sample = mechanism(name, variant)

    result = zeros(lambda phi: reduced.gravity_force(sample.sweep(phi)))
    assert np.min(np.abs(np.degrees(result) - degrees)) <= 0.005  # two decimals


def test_the_two_readings_of_rimoldis_table_differ_in_gravity_alone():
    built, along = (mechanism("rimoldi-164", variant).sweep(angles(20)) for variant in ("as-built", "y-along"))
    assert np.allclose(reduced.reduced_inertia(built), reduced.reduced_inertia(along), rtol=FIFTY_DIGITS)
    assert not np.allclose(reduced.gravity_force(built), reduced.gravity_force(along), rtol=1e-3)


# The linkages of the literature.


# A hundredth of a degree from a toggle rounding errors of the lengths grow some thousandfold.
NEAR_TOGGLE = 1e-12
# rad: to which the end of a crank's range is known.
TOGGLE = mpf("1e-13")


def test_every_linkage_of_the_literature_has_its_formulas():
    assert set(LITERATURE) == set(literature())


@pytest.mark.parametrize("name", LITERATURE)
def test_points_are_the_sources(name):
    formula, unit, degrees = LITERATURE[name]
    limit = NEAR_TOGGLE * mechanism(name).linkage.extent()
    for angle in np.radians(degrees):
        sweep = mechanism(name).sweep(angle)
        for point, place in formula(mpf(float(angle))).items():
            x, y = map(float, sweep.point(point))
            assert abs(place * mpf(unit) - mpc(x, y)) <= limit, (point, angle)


@pytest.mark.parametrize("name", ["watt-six-bar", "stephenson-six-bar"])
def test_a_toggle_is_where_two_links_of_the_source_are_in_line(name):
    formula = LITERATURE[name][0]
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
