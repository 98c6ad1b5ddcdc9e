"""The transmission angle against the cosine rule, the textbook's slider-crank, and the dead positions."""

import numpy as np
import pytest

from analytic.kinematics.transmission import transmission_angle
from tests.analytic.linkages import FULL_TURN, from_text, mechanism
from tests.analytic.textbook import DOUBLE_ROCKER
from tests.analytic.tolerances import FIFTY_DIGITS


def test_between_two_rods_it_is_the_angle_of_the_cosine_rule():
    sample, phi = from_text(DOUBLE_ROCKER), np.radians(np.linspace(45.0, 100.0, 12))
    (dyad,) = sample.structure.dyads
    gap = 80.0**2 + 100.0**2 - 2 * 80.0 * 100.0 * np.cos(phi)
    expected = np.arccos(np.abs(60.0**2 + 90.0**2 - gap) / (2 * 60.0 * 90.0))  # the acute one
    assert transmission_angle(sample.sweep(phi), dyad) == pytest.approx(expected, rel=FIFTY_DIGITS)


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_its_sine_is_the_determinant_of_the_group_s_closure_over_its_lengths(name, variant):
    """Both vanish in the dead positions only: their ratio, a product of lengths, is bounded over a turn."""
    sample = mechanism(name, variant)
    sweep = sample.sweep(np.linspace(0.0, 2 * np.pi, 91))
    for dyad in sample.structure.dyads:
        sine = np.sin(transmission_angle(sweep, dyad))
        determinant = np.abs(np.broadcast_to(sweep._solvers[dyad.first].closure.determinant, sine.shape))
        ratio = determinant / sine
        if dyad.kind in ("RRR", "RPP", "PRP"):  # of constant lengths
            assert ratio == pytest.approx(np.full(sine.shape, ratio[0]), rel=1e-9)
        else:
            assert np.all(ratio > 0.0)
