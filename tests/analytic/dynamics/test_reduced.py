"""Reduced inertia, generalised force, drive torque: against 50 digits, by energy, and however the linkage is drawn."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.dynamics import reduced
from analytic.numerics.refine import grid
from tests.analytic.drawn_linkages import draw, placed
from tests.analytic.fifty_digits import exact
from tests.analytic.linkages import EVERY, FULL_TURN, angles, from_text, mechanism
from tests.analytic.tolerances import FIFTY_DIGITS, FULL_TURN_WORK, SAME_FIGURES

SPEED, ACCELERATION = -37.0, 410.0  # rad/s, rad/s²: inertia, gravity and damping all matter


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_reduced_quantities_agree_with_fifty_digits(name, variant):
    sample = mechanism(name, variant)
    truths = [exact(sample, angle) for angle in angles(3)]
    exactly = {
        "Jeq": [t.inertia() for t in truths],
        "½Jeq'": [t.half_slope() for t in truths],
        "Q": [t.force() for t in truths],
        "b": [t.damping() for t in truths],
        "V": [t.states[0].potential() for t in truths],
        "Mkr": [t.torque(SPEED, ACCELERATION) for t in truths],
    }
    got = _reduced(sample.sweep(angles(3)))
    turn = _reduced(sample.turn if (name, variant) in FULL_TURN else sample.sweep(angles(40)))
    peaks = {quantity: np.max(np.abs(values)) for quantity, values in turn.items()}
    # Where a part of Mkr vanishes (the parallelogram's ½Jeq', the yoke's Q) rounding is judged by what does not.
    floor = {"½Jeq'": peaks["Jeq"], "Q": peaks["Mkr"]}
    for quantity, truth in exactly.items():
        error = np.max(np.abs(got[quantity] - np.array(truth, dtype=float)))
        assert error <= FIFTY_DIGITS * max(peaks[quantity], floor.get(quantity, 0.0)), quantity


def _reduced(sweep):
    return {
        "Jeq": reduced.reduced_inertia(sweep),
        "½Jeq'": reduced.half_inertia_derivative(sweep),
        "Q": reduced.generalised_force(sweep),
        "b": reduced.damping_coefficient(sweep),
        "V": reduced.potential_energy(sweep),
        "Mkr": reduced.drive_torque(sweep, SPEED, ACCELERATION),
    }


def test_parts_add_up_to_the_whole():
    sweep = mechanism("rimoldi-164").turn
    whole = reduced.reduced_inertia(sweep)
    links = sum(reduced.link_inertia(sweep, link) for link in sweep.linkage.links)
    assert np.allclose(links, whole, rtol=FIFTY_DIGITS)
    assert np.allclose(sum(reduced.group_inertia(sweep).values()), whole, rtol=FIFTY_DIGITS)
    assert np.allclose(reduced.kinetic_energy(sweep, 3.0), 4.5 * whole, rtol=FIFTY_DIGITS)


@pytest.mark.parametrize("name", ["near-toggle", "moving-guides", "rimoldi-164"])
def test_conservative_linkages_take_no_work_over_a_turn_at_constant_speed(name):
    angle = grid(7200)  # enough for the linkage near toggle, whose torque peaks sharply
    torque = reduced.drive_torque(mechanism(name).sweep(angle), 40.0, 0.0)
    assert abs(np.mean(torque)) <= FULL_TURN_WORK * np.max(np.abs(torque)) * len(angle) ** 0.5


def _figures(sample, angle, speed, acceleration):
    sweep = sample.sweep(angle)
    return np.array([reduced.reduced_inertia(sweep), reduced.drive_torque(sweep, speed, acceleration)])


def _assert_same(one, two):
    assert np.all(np.abs(one - two) <= SAME_FIGURES * np.max(np.abs(one), axis=1, keepdims=True))


@settings(max_examples=8)
@given(st.integers(0, 10**6), st.floats(-3.0, 3.0), st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)))
def test_order_placement_units_and_mirroring_of_the_drawing_change_nothing(number, turn, shift):
    text = draw(number).text
    shift = np.array(shift) * from_text(text).linkage.shortest_length()

    def figures(phi, motion=(25.0, 130.0), **change):
        return _figures(from_text(placed(text, **change)), phi, *motion)

    plain = figures(angles(20))
    assert np.array_equal(plain, figures(angles(20), reverse=True))
    _assert_same(plain, figures(angles(20) + turn, turn=turn, shift=shift))
    _assert_same(plain, figures(angles(20), unit=("in", 0.0254)))
    mirrored = figures(-angles(20), (-25.0, -130.0), mirrored=True)
    _assert_same(plain, mirrored * [[1.0], [-1.0]])
