"""Reduced inertia, generalised force, drive torque: against 50 digits, by energy, and however the linkage is drawn."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.dynamics import reduced
from analytic.numerics.extremes import grid
from tests.analytic.fifty_digits import exact
from tests.analytic.linkages import (
    EVERY,
    FULL_TURN,
    angles,
    four_bars,
    from_text,
    mechanism,
    slider_cranks,
    text_of,
)
from tests.analytic.tolerances import DIFFERENCED, FIFTY_DIGITS, FULL_TURN_WORK, SAME_FIGURES

SPEED, ACCELERATION = -37.0, 410.0  # rad/s, rad/s²: inertia, gravity and damping all matter


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_reduced_quantities_agree_with_fifty_digits(name, variant):
    sample = mechanism(name, variant)
    truths = [exact(sample, angle) for angle in angles(6)]
    exactly = {
        "Jeq": [t.inertia() for t in truths],
        "½Jeq'": [t.half_slope() for t in truths],
        "Q": [t.force() for t in truths],
        "b": [t.damping() for t in truths],
        "V": [t.states[0].potential() for t in truths],
        "Mkr": [t.torque(SPEED, ACCELERATION) for t in truths],
    }
    got = _reduced(sample.sweep(angles(6)))
    turn = _reduced(sample.turn if (name, variant) in FULL_TURN else sample.sweep(angles(6)))
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


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_parts_add_up_to_the_whole(name, variant):
    sweep = mechanism(name, variant).turn
    whole = reduced.reduced_inertia(sweep)
    links = sum(reduced.link_inertia(sweep, link) for link in sweep.linkage.links)
    groups = sum(reduced.group_inertia(sweep).values())
    assert np.allclose(links, whole, rtol=FIFTY_DIGITS)
    assert np.allclose(groups, whole, rtol=FIFTY_DIGITS)


def _slope(function, angle, step=1e-3):
    """Seven-point difference, independent of every derivative of the closed form."""
    weights = {1: 45.0, 2: -9.0, 3: 1.0}
    return sum(w * (function(angle + k * step) - function(angle - k * step)) for k, w in weights.items()) / (60 * step)


@settings(max_examples=30)
@given(four_bars() | slider_cranks())
def test_energy_balances_along_the_crank_angle(sample):
    linkage = from_text(sample if isinstance(sample, str) else sample.text())
    angle = angles(40)
    sweep = linkage.sweep(angle)
    inertia_slope = _slope(lambda phi: reduced.reduced_inertia(linkage.sweep(phi)), angle)
    energy_slope = _slope(lambda phi: reduced.potential_energy(linkage.sweep(phi)), angle)
    peak = np.max(reduced.reduced_inertia(sweep))
    assert np.allclose(reduced.half_inertia_derivative(sweep), 0.5 * inertia_slope, rtol=0.0, atol=DIFFERENCED * peak)
    work = np.max(np.abs(reduced.potential_energy(sweep)))
    assert np.allclose(reduced.generalised_force(sweep), -energy_slope, rtol=0.0, atol=DIFFERENCED * work)


def _is_conservative(linkage):
    return not (linkage.forces or linkage.torques or reduced.is_damped(linkage))


@pytest.mark.parametrize(
    ("name", "variant"), [pair for pair in FULL_TURN if _is_conservative(mechanism(*pair).linkage)]
)
def test_conservative_linkages_take_no_work_over_a_turn_at_constant_speed(name, variant):
    angle = grid(7200)  # enough for the linkage near toggle, whose torque peaks sharply
    torque = reduced.drive_torque(mechanism(name, variant).sweep(angle), 40.0, 0.0)
    assert abs(np.mean(torque)) <= FULL_TURN_WORK * np.max(np.abs(torque)) * len(angle) ** 0.5


def test_dampers_take_what_the_damping_coefficient_says():
    angle = grid()
    sweep = mechanism("spring-and-damper").sweep(angle)
    work = np.mean(reduced.drive_torque(sweep, 12.0, 0.0))
    assert work == pytest.approx(np.mean(reduced.damping_coefficient(sweep)) * 12.0, rel=FIFTY_DIGITS)


def test_a_damper_on_the_crank_alone_is_its_coefficient():
    between = 'between     = ["coupler", "rocker"]\ncoefficient = 5e-4'
    text = text_of("spring-and-damper").replace(between, between.replace("5e-4", "0")).replace("1.5", "0")
    assert np.allclose(reduced.damping_coefficient(from_text(text).turn), 2e-4, rtol=FIFTY_DIGITS)


def test_without_gravity_its_force_is_exactly_nothing():
    assert np.all(reduced.generalised_force(mechanism("centric-slider-crank").turn) == 0.0)


def _figures(sample, angle, speed=25.0, acceleration=130.0):
    sweep = sample.sweep(angle)
    return np.array([reduced.reduced_inertia(sweep), reduced.drive_torque(sweep, speed, acceleration)])


def _assert_same(one, two):
    assert np.all(np.abs(one - two) <= SAME_FIGURES * np.max(np.abs(one), axis=1, keepdims=True))


@settings(max_examples=25)
@given(four_bars())
def test_listing_order_changes_not_one_bit(four_bar):
    one, two = (_figures(from_text(four_bar.text(reverse=r)), angles(20)) for r in (False, True))
    assert np.array_equal(one, two)


def test_listing_order_of_loads_and_joints_changes_not_one_bit():
    for name in ("spring-and-damper", "force-over-angle", "moving-guides"):
        text = text_of(name)
        head, *tables = text.split("\n[")
        turned = "\n[".join([head, *reversed(tables)])
        assert np.array_equal(_figures(from_text(text), angles(20)), _figures(from_text(turned), angles(20)))


@settings(max_examples=25)
@given(four_bars(), st.floats(-3.0, 3.0), st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)))
def test_turning_and_shifting_the_drawing_changes_nothing(four_bar, turn, shift):
    moved = from_text(four_bar.text(turn=turn, shift=shift))
    _assert_same(_figures(from_text(four_bar.text()), angles(20)), _figures(moved, angles(20) + turn))


@settings(max_examples=25)
@given(four_bars(), st.sampled_from([("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("um", 1e-6)]))
def test_units_change_nothing(four_bar, unit):
    converted = from_text(four_bar.text(unit=unit))
    _assert_same(_figures(from_text(four_bar.text()), angles(20)), _figures(converted, angles(20)))


@settings(max_examples=25)
@given(four_bars())
def test_the_mirrored_linkage_turned_the_other_way_does_the_same(four_bar):
    plain = _figures(from_text(four_bar.text()), angles(20))
    mirrored = _figures(from_text(four_bar.text(mirrored=True)), -angles(20), speed=-25.0, acceleration=-130.0)
    _assert_same(plain, mirrored * [[1.0], [-1.0]])


def test_kinetic_energy_is_half_of_jeq_times_speed_squared():
    sweep = mechanism("juki-mf7923d").turn
    assert np.allclose(reduced.kinetic_energy(sweep, 3.0), 4.5 * reduced.reduced_inertia(sweep), rtol=FIFTY_DIGITS)
