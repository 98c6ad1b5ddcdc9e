"""Linkages followed through change points: exact motions of change-point four-bars, and what is not followed."""

import mpmath as mp
import numpy as np
import pytest

from analytic.errors import AssemblyError
from analytic.kinematics.error_bounds import ErrorBounds
from tests.analytic.linkages import four_bar, from_text, mechanism

# Of poses (m, and cosines), first and second derivatives, beside change points and away from them.
EXACT = (4e-15, 2e-14, 1e-13)
# The same at the end of ten groups, each on the one before it.
CHAINED = (3e-14, 1e-12, 1e-10)
DIGITS = 120
ANGLE = np.concatenate([np.linspace(-13.0, 13.0, 90), [0.0, np.pi, 1e-9, -1e-7, np.pi - 1e-5, np.pi + 0.3, 7.0]])


def turn_of(sweep):
    """Sine and cosine of the rocker's angle and its derivatives."""
    return sweep.poses("rocker")[2:], sweep.rates("rocker")[2], sweep.accelerations("rocker")[2]


def followed(lengths, side):
    """The rocker's angle and derivatives over ANGLE in 120 digits, from the tangent form of the closure equation.

    With t = tan(ψ/2): (p - q) t² + 2 r t + (p + q) = 0 (F. Freudenstein), whose discriminant has double roots where
    the linkage passes change points. Its root is signed by the half angles that vanish there, so that it is smooth.
    """
    mp.mp.dps = DIGITS
    g, a, b, c = map(mp.mpf, lengths)

    def angle(phi):
        p = g * g + a * a + c * c - b * b - 2 * g * a * mp.cos(phi)
        u, v = 2 * c * (g - a * mp.cos(phi)), -2 * c * a * mp.sin(phi)  # p + u cos ψ + v sin ψ = 0
        root = side * signed(phi, g, a, b, c)
        return mp.atan2(-v * p - u * root, -u * p + v * root)

    return angle


def signed(phi, g, a, b, c):
    """The root of u² + v² - p², smooth through its double roots."""
    gap, total, least = g * g + a * a - 2 * g * a * mp.cos(phi), b + c, abs(b - c)
    factors = [4 * g * a * mp.cos(phi / 2) ** 2] if total == g + a else [total**2 - gap]
    root = 2 * mp.sqrt(g * a) * mp.cos(phi / 2) if total == g + a else mp.sqrt(factors[0])
    low = 2 * mp.sqrt(g * a) * mp.sin(phi / 2) if least == abs(g - a) else mp.sqrt(gap - least**2)
    return root * low


CASES = {
    "parallelogram": ("0.06", "0.025", "0.06", "0.025", 1, 2),
    "antiparallelogram": ("0.06", "0.025", "0.06", "0.025", -1, 2),
    "crank shortest": ("4", "1", "2", "3", 1, 1),
    "frame shortest": ("1", "3", "2.5", "1.5", 1, 1),
    "rhombus": ("1", "1", "1", "1", 1, 2),
}


@pytest.mark.parametrize("name", CASES)
def test_motion_through_change_points_is_that_of_a_hundred_digits(name):
    *lengths, side, points = CASES[name]
    sample, start = from_text(four_bar(*map(float, lengths), 1.5, side=side)), 1.5
    sweep = sample.sweep(ANGLE)
    (c, s), first, second = turn_of(sweep)
    ways = [followed(lengths, side) for side in (1, -1)]
    here = sample.sweep(np.array(start)).poses("rocker")[2:]
    truth = next(way for way in ways if abs(mp.cos(way(start)) - here[0]) + abs(mp.sin(way(start)) - here[1]) < 1e-9)
    assert len(sample.changes) == points
    assert round(sample.period / (2 * np.pi)) == (1 if points == 2 else 2)
    errors = np.zeros((3, len(ANGLE)))
    for number, phi in enumerate(ANGLE):
        at = mp.mpf(float(phi)) + mp.mpf(10) ** -30  # off what is 0/0 at the point itself
        psi = truth(at)
        h = mp.mpf(10) ** -12
        around = [truth(at + k * h) for k in (-1, 1)]
        around = [value + 2 * mp.pi * mp.nint((psi - value) / (2 * mp.pi)) for value in around]
        errors[0, number] = max(abs(mp.cos(psi) - c[number]), abs(mp.sin(psi) - s[number]))
        errors[1, number] = abs((around[1] - around[0]) / (2 * h) - first[number])
        errors[2, number] = abs((around[1] - 2 * psi + around[0]) / h**2 - second[number])
    peaks = [1.0, max(1.0, np.max(np.abs(first))), max(1.0, np.max(np.abs(second)))]
    assert np.all(errors.max(axis=1) / peaks <= EXACT), errors.max(axis=1) / peaks
    (_, _, *turned), first_rate, second_rate = ErrorBounds(sweep).motion_with_errors("rocker")
    bound = np.array([np.hypot(*(part.bound for part in turned)), first_rate[2].bound, second_rate[2].bound])
    assert np.all(errors <= 2.0 * bound + 1e-30)


def test_pins_that_cross_in_every_window_add_up_no_rounding():
    """At 0° the outer pins of all forty windows lie on top of each other; each window is driven by the one before."""
    sample = mechanism("n-four-bar")
    assert sample.changes == pytest.approx((0.0, np.pi), abs=1e-8)
    sweep = sample.sweep(np.array([-13.0, -1e-7, 0.0, 1e-9, 0.3, np.pi - 1e-5, np.pi, 7.0]))
    c, s = sweep.poses("rocker40")[2:]
    assert max(np.max(np.abs(c - np.cos(sweep.angle))), np.max(np.abs(s - np.sin(sweep.angle)))) <= CHAINED[0]
    assert np.max(np.abs(sweep.rates("rocker40")[2] - 1.0)) <= CHAINED[1]
    assert np.max(np.abs(sweep.accelerations("rocker40")[2])) <= CHAINED[2]


@pytest.mark.parametrize("share", [1e-6, -1e-6, 1e-12])
def test_a_miss_is_no_change_point(share):
    """A rocker longer than the crank all but closes the linkage; a shorter one cannot be assembled there."""
    sample = from_text(four_bar(0.06, 0.025, 0.06, 0.025 * (1.0 + share), 1.5))
    assert sample.changes == ()


def test_lengths_that_rounding_makes_unequal_are_equal():
    sample = from_text(four_bar(0.1 + 0.2, 0.1, 0.3, 0.1, 1.5))
    assert len(sample.changes) == 2


def test_a_folded_kite_is_undetermined():
    kite = from_text(four_bar(1.0, 1.0, 0.75, 0.75, 1.0))
    assert kite.changes == ()
    with pytest.raises(AssemblyError, match=r"is undetermined at 0°: .* outer pins on top of each other"):
        kite.check_determined(-1.0, 1.0)
    kite.check_determined(0.5, 1.0)


def test_on_a_change_point_nothing_may_rest():
    sample = mechanism("parallelogram")
    with pytest.raises(AssemblyError, match=r"is at rest on a change point at 180°, from which 'coupler' and 'rocker'"):
        sample.check_rest(-np.pi)
    sample.check_rest(0.01)


FIRST = four_bar(4.0, 1.0, 3.5, 2.5, 1.5)
NEXT = """
[links.second]
points = { D = [0, 0], E = [3, 0] }
[links.third]
points = { O3 = [0, 0], E = [1, 0] }
"""


@pytest.mark.parametrize(("over", "points"), [(1e-4, 0), (-1e-4, 2), (-1e-5, None)])
def test_a_rocker_that_turns_round_at_a_change_point_of_the_next_dyad_is_followed_or_refused(over, points):
    """Its rocker drives a parallelogram and turns round ``over`` before its change point, rad, or beyond it."""
    most = mp.mpf("4.5")  # crank and coupler in one line
    turn = float(mp.atan2(mp.sqrt(most**2 - ((most**2 + 9.75) / 8) ** 2), (most**2 + 9.75) / 8 - 4))
    place = 7.0 + np.exp(1j * (float(from_text(FIRST).sweep(1.5).angles("rocker")) + over - turn))
    text = FIRST
    for old, new in (
        ("C = [2.5, 0]", f"C = [2.5, 0], D = [{np.cos(over - turn)}, {np.sin(over - turn)}]"),
        ("B = [4.0, 0]", "B = [4.0, 0], O3 = [7, 0]"),
        ("points = { C = [3", f"points = {{ E = [{place.real}, {place.imag}], C = [3"),
        ("[sketch]", f"{NEXT}[sketch]"),
    ):
        assert old in text
        text = text.replace(old, new)
    sample = from_text(text)
    if points is None:
        with pytest.raises(AssemblyError, match="is undetermined at 33"):
            sample.check_full_turn()
        return
    assert len(sample.changes) == points
    sweep = sample.sweep(np.linspace(-13.0, 13.0, 301))
    assert np.max(np.abs(np.subtract(sweep.rates("third")[2], sweep.rates("rocker")[2]))) < 1e-7
    off = np.angle(np.exp(1j * (sweep.angles("third") - sweep.angles("rocker") - over + turn)))
    assert np.max(np.abs(off)) < 1e-10
