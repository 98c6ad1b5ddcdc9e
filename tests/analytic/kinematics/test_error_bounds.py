"""The closed form's error bound against its true error, taken from 50 digits: it holds, and it is not idle."""

import numpy as np
import pytest

from analytic.kinematics.error_bounds import ErrorBounds, relative_bounds
from analytic.kinematics.sweep import Sweep
from tests.analytic.drawn_linkages import draw
from tests.analytic.fifty_digits import exact
from tests.analytic.linkages import FAR, angles, from_text, mechanism, text_of
from tests.analytic.tolerances import BOUND_OVER_ERROR, FIFTY_DIGITS, ORACLE

# The linkage near toggle is nearest to it at 180°, where errors are magnified most.
TOGGLE = np.pi + np.array([0.0, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2])


TRIALS = [("near-toggle", None), ("moving-guides", None), ("shaper", None), ("rimoldi-164", "as-built")]


def _errors_and_bounds(sample, angle):
    sweep, truth = sample.sweep(angle), exact(sample, angle)
    bounds = ErrorBounds(sweep)
    for body, link in sample.linkage.links.items():
        for local in (*link.points.values(), link.centre):
            point = truth.point(body, local)
            for order in range(3):
                pairs = zip(point, sweep.local_point(body, local, order), strict=True)
                errors = [float(abs(p[order] - float(got))) for p, got in pairs]
                yield order, np.hypot(*errors), float(bounds.point(body, local, order)[0])


@pytest.mark.parametrize(("name", "variant"), TRIALS)
def test_the_bound_holds_everywhere_and_is_near_the_worst_error(name, variant):
    worst_error, worst_bound = np.zeros(3), np.zeros(3)
    for angle in [*angles(6), *TOGGLE] if name == "near-toggle" else angles(6):
        for order, error, bound in _errors_and_bounds(mechanism(name, variant), angle):
            assert error <= bound + ORACLE
            worst_error[order] = max(worst_error[order], error)
            worst_bound[order] = max(worst_bound[order], bound)
    assert np.all(worst_bound <= BOUND_OVER_ERROR * worst_error)


def test_the_needle_mechanisms_are_bound_far_below_the_accuracy_that_the_reference_needs():
    assert max(relative_bounds(mechanism("rimoldi-164").turn)) < FIFTY_DIGITS


def test_a_bound_grows_towards_a_dead_position():
    sample = mechanism("near-toggle")
    far, near = (relative_bounds(sample.sweep(np.array([angle]))) for angle in (1.5, np.pi))
    assert near[0] > 100.0 * far[0]
    assert near[2] > 100.0 * near[0]


def test_the_bound_holds_where_the_linkage_all_but_stands_dead():
    sample = from_text(text_of("near-toggle").replace("79.9999", "79.9999999999"))
    for angle in np.pi + np.array([0.0, 1e-6, 1e-5, 1e-4]):
        assert all(error <= bound + ORACLE for _, error, bound in _errors_and_bounds(sample, angle))


def test_the_bound_gives_up_where_rounding_decides_how_the_links_lie():
    assert max(relative_bounds(from_text(FAR).sweep(np.array([np.pi])))) == np.inf


@pytest.mark.parametrize("count", [8, pytest.param(1000, marks=pytest.mark.nightly)])
def test_the_bound_holds_for_random_linkages_of_four_kinds(count):
    """The same that run in every engine; of a thousand the nearest error came to half of its bound."""
    for number in range(count):
        sample = from_text(draw(number).text)
        (angle,) = np.random.default_rng(number).uniform(0.0, 2.0 * np.pi, 1)
        assert all(error <= bound + ORACLE for _, error, bound in _errors_and_bounds(sample, angle)), number


@pytest.mark.parametrize("order", range(3))
def test_an_error_of_the_solver_is_within_the_bound(order, monkeypatch):
    """A coupler misplaced by 1e-9, or its rate or acceleration: that is no rounding, and it is seen all the same."""
    step = ("poses", "rates", "accelerations")[order]
    true, slip = getattr(Sweep, step), 1e-9

    def wrong(sweep, body):
        first, *rest = true(sweep, body)
        return (first + slip if body == "coupler" else first, *rest)

    monkeypatch.setattr(Sweep, step, wrong)
    bounds = ErrorBounds(mechanism("near-toggle").sweep(angles(3)))
    assert np.all(bounds.point("coupler", (0.0, 0.0), order) >= slip)
