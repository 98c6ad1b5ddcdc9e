"""Positions and derivatives of whole linkages against 50 digits, special cases with known answers, loop closure."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp

from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import transmission_angle
from tests.analytic.drawn_linkages import draw, placed
from tests.analytic.fifty_digits import Exact, exact
from tests.analytic.linkages import (
    DOUBLE_ROCKER,
    EVERY,
    FULL_TURN,
    angles,
    double_rocker,
    from_text,
    mechanism,
    modes,
    text_of,
)
from tests.analytic.tolerances import CLOSURE, FIFTY_DIGITS


def _motion(sweep):
    """Everything there is to know of the motion: (order, coordinate, angle); θ itself as cosine and sine."""
    links = sweep.linkage.links
    places = [(name, local) for name, link in links.items() for local in (*link.points.values(), link.centre)]
    points = [[part for place in places for part in sweep.local_point(*place, order)] for order in range(3)]
    turns = [[sweep.poses(n)[i] for i in (2, 3) for n in links]] + [
        [motion(n)[2] for n in links] * 2 for motion in (sweep.rates, sweep.accelerations)
    ]
    shape = sweep.angle.shape
    return [[np.broadcast_to(row, shape) for row in (*points[k], *turns[k])] for k in range(3)]


def _exact_motion(sweep, truth):
    links = sweep.linkage.links
    places = [(name, local) for name, link in links.items() for local in (*link.points.values(), link.centre)]
    points = [part for place in places for part in truth.point(*place)]
    turns = [truth.turn(n) for n in links]
    circle = [mp.cos(turn[0]) for turn in turns] + [mp.sin(turn[0]) for turn in turns]
    return [[p[0] for p in points] + circle] + [[q[k] for q in points] + [q[k] for q in turns] * 2 for k in (1, 2)]


def _peaks(motion, places):
    """Largest coordinate and largest turn of each order, in every column; the crank itself turns by 1 rad per rad."""
    sizes = np.abs(np.array(motion)).max(axis=2)
    sizes[:, :places] = sizes[:, :places].max(axis=1, keepdims=True)
    sizes[:, places:] = np.maximum(sizes[:, places:].max(axis=1, keepdims=True), 1.0)
    return sizes


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_points_and_angles_agree_with_fifty_digits_in_every_assembly_mode(name, variant):
    sample = mechanism(name, variant)
    places = 2 * sum(len(link.points) + 1 for link in sample.linkage.links.values())
    peaks = _peaks(_motion(sample.turn), places) if (name, variant) in FULL_TURN else 0.0
    for angle in angles(3):
        for sweep in modes(sample, angle):
            truth = exact(sample, angle) if sweep.structure == sample.structure and not sample.changes else Exact(sweep)
            got = np.array(_motion(sweep))
            errors = np.abs(np.array(_exact_motion(sweep, truth)) - got).astype(float)
            own = _peaks(got[..., None], places)
            assert np.all(errors <= FIFTY_DIGITS * np.maximum(own, peaks))


@settings(max_examples=15)
@given(st.integers(0, 10**6))
def test_random_linkages_close_to_a_few_roundings(number):
    sample = from_text(placed(draw(number).text, shift=(0.1, -0.3), turn=0.4))
    assert np.max(sample.turn.closure_error()) <= CLOSURE * sample.linkage.extent()


def test_the_transmission_angle_between_two_rods_is_that_of_the_cosine_rule():
    sample, phi = from_text(DOUBLE_ROCKER), np.radians(np.linspace(45.0, 100.0, 12))
    (dyad,) = sample.structure.dyads
    gap = 80.0**2 + 100.0**2 - 2 * 80.0 * 100.0 * np.cos(phi)
    expected = np.arccos(np.abs(60.0**2 + 90.0**2 - gap) / (2 * 60.0 * 90.0))  # the acute one
    assert transmission_angle(sample.sweep(phi), dyad) == pytest.approx(expected, rel=FIFTY_DIGITS)


@pytest.mark.parametrize("name", ["moving-guides", "scotch-yoke", "shaper"])
def test_the_sine_of_the_transmission_angle_vanishes_with_the_determinant_of_the_closure(name):
    """Their ratio is a product of lengths, constant where those are."""
    sweep = mechanism(name).sweep(np.linspace(0.0, 2 * np.pi, 91))
    for dyad in mechanism(name).structure.dyads:
        ratio = np.abs(sweep.determinant(dyad)) / np.sin(transmission_angle(sweep, dyad))
        if dyad.kind in ("RRR", "RPP", "PRP"):
            assert ratio == pytest.approx(np.full(91, ratio.flat[0]), rel=1e-9)
        else:
            assert np.all(ratio > 0.0)


def test_unknown_names_and_a_missing_output():
    with pytest.raises(UnknownNameError, match="unknown link 'rokcer': did you mean 'rocker'"):
        mechanism("rimoldi-164").sweep(0.0).poses("rokcer")
    with pytest.raises(UnknownNameError, match="unknown point 'Q'"):
        mechanism("rimoldi-164").sweep(0.0).point("Q")
    text = text_of("scotch-yoke").replace('output  = { point = "Y" }', "")
    with pytest.raises(LinkproofError, match=r"names no output.*add output"):
        from_text(text).sweep(0.0).output()


def test_a_linkage_that_cannot_be_assembled_fails_at_every_call():
    sweep = Mechanism(double_rocker()).sweep(np.array([0.0, np.pi]))
    for _ in range(2):
        with pytest.raises(AssemblyError, match="cannot be assembled at 180°"):
            sweep.poses("coupler")
