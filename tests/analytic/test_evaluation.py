"""Quantities by name: the same numbers as one by one, and nothing computed that was not asked for."""

import numpy as np
import pytest

from analytic import evaluation
from analytic.description.crank_motion import crank_motion
from analytic.dynamics import reduced
from analytic.errors import LinkproofError, UnknownNameError
from analytic.evaluation import PIECE, evaluate
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.sweep import Sweep
from analytic.turn.farthest import top_of_turn
from analytic.turn.unit_functions import top_dead_centre
from tests.analytic.linkages import angles, mechanism
from tests.analytic.tolerances import FOUR_DIGITS


@pytest.mark.parametrize("count", [1, PIECE - 1, PIECE, 2 * PIECE + 7])
def test_pieces_make_up_the_whole(count):
    sample, angle = mechanism("rimoldi-164"), angles(count)
    speed, acceleration = angles(count, seed=2), angles(count, seed=3)
    names = ("Jeq", "half_slope", "Q", "damping", "Mkr", "Teq", "Peq", "S", "v", "a", "link:rod:angle")
    found = evaluate(sample, angle, names, speed=speed, acceleration=acceleration, path="numpy")
    sweep = sample.sweep(angle)
    assert np.array_equal(found["Jeq"], reduced.reduced_inertia(sweep))
    assert np.array_equal(found["half_slope"], reduced.half_inertia_derivative(sweep))
    assert np.array_equal(found["Q"], reduced.generalised_force(sweep))
    assert np.array_equal(found["damping"], reduced.damping_coefficient(sweep))
    assert np.array_equal(found["Mkr"], reduced.drive_torque(sweep, speed, acceleration))
    assert np.array_equal(found["Teq"], reduced.kinetic_energy(sweep, speed))
    assert np.array_equal(found["Peq"], found["Mkr"] * speed)
    assert np.array_equal(found["S"], top_dead_centre(sample).coordinate - sweep.output())
    assert np.array_equal(found["v"], -sweep.output(1) * speed)
    assert np.array_equal(found["a"], -(sweep.output(2) * (speed * speed) + sweep.output(1) * acceleration))
    assert np.array_equal(found["link:rod:angle"], sweep.angles("rod"))


def test_shapes_are_kept_and_scalars_spread():
    found = evaluate(mechanism("juki-mf7923d"), angles(6).reshape(2, 3), ["Mkr", "S"], speed=10.0)
    assert {name: values.shape for name, values in found.items()} == {"Mkr": (2, 3), "S": (2, 3)}
    assert evaluate(mechanism("juki-mf7923d"), 0.3, ["Jeq"])["Jeq"].shape == ()


@pytest.fixture
def solved(monkeypatch):
    """Counts of the steps in which dyads are solved."""
    counts = {"poses": 0, "rates": 0, "accelerations": 0}
    for step in counts:
        monkeypatch.setattr(DyadSolver, step, _counted(counts, step, getattr(DyadSolver, step)))
    return counts


def _counted(counts, step, whole):
    def counting(*args):
        counts[step] += 1
        return whole(*args)

    return counting


@pytest.mark.parametrize(
    ("quantities", "expected"),
    [
        (["S"], {"poses": 2, "rates": 0, "accelerations": 0}),
        (["v"], {"poses": 2, "rates": 2, "accelerations": 0}),
        (["Jeq"], {"poses": 2, "rates": 2, "accelerations": 0}),
        (["Teq", "Q", "S", "v"], {"poses": 2, "rates": 2, "accelerations": 0}),
        (["Mkr", "Jeq", "Peq", "a"], {"poses": 2, "rates": 2, "accelerations": 2}),
    ],
)
def test_only_what_is_asked_for_is_computed_and_only_once(solved, quantities, expected):
    sample = mechanism("rimoldi-164")
    top_of_turn(sample)
    solved.update(dict.fromkeys(solved, 0))
    found = evaluate(sample, angles(10), quantities, speed=1.0, acceleration=1.0)
    assert solved == expected
    assert list(found) == quantities


def test_no_gravity_is_computed_where_there_is_none(monkeypatch):
    asked = []
    monkeypatch.setattr(Sweep, "centre", lambda _sweep, body, order=0: asked.append((body, order)))
    reduced.gravity_force(mechanism("centric-slider-crank").sweep(angles(3)))
    assert asked == []


@pytest.mark.parametrize(
    ("name", "regime", "torque", "power"),
    [
        ("juki-mf7923d", "run-up", 0.1654, 17.07),
        ("juki-mf7923d", "run-up-cubic", 0.1565, 16.38),
        ("juki-mf7923d", "run-up-quintic", 0.1562, 16.28),
        ("rimoldi-164", "run-up", 0.2704, 24.91),
        ("rimoldi-164", "run-up-cubic", 0.2704, 24.91),
        ("rimoldi-164", "run-up-quintic", 0.2704, 24.93),
    ],
)
def test_peak_torque_and_largest_driving_power_of_the_run_up(name, regime, torque, power):
    motion = crank_motion(regime)
    time = np.linspace(0.0, motion.duration, 140_001)
    found = evaluate(
        mechanism(name, "as-built"),
        motion.angle(time),
        ["Mkr", "Peq"],
        speed=motion.speed(time),
        acceleration=motion.acceleration(time),
    )
    assert np.max(np.abs(found["Mkr"])) == pytest.approx(torque, rel=FOUR_DIGITS)
    assert np.max(found["Peq"]) == pytest.approx(power, rel=FOUR_DIGITS)


@pytest.mark.parametrize(("name", "torque", "power"), [("juki-mf7923d", 0.125, 12.9), ("rimoldi-164", 0.179, 16.6)])
def test_peak_torque_and_power_as_printed(name, torque, power):
    motion = crank_motion("run-up")
    time = np.linspace(0.0, motion.duration, 140_001)
    found = evaluate(
        mechanism(name, "as-printed"),
        motion.angle(time),
        ["Mkr", "Peq"],
        speed=motion.speed(time),
        acceleration=motion.acceleration(time),
    )
    assert np.max(np.abs(found["Mkr"])) == pytest.approx(torque, abs=0.5e-3)  # printed with three decimals
    assert np.max(found["Peq"]) == pytest.approx(power, abs=0.05)  # with one


def test_an_unknown_quantity():
    with pytest.raises(UnknownNameError, match="unknown quantity 'jeq': did you mean 'Jeq'"):
        evaluate(mechanism("juki-mf7923d"), 0.0, ["jeq"])


def test_a_moving_quantity_needs_a_speed():
    with pytest.raises(LinkproofError, match="speed: expected the crank's speed in rad/s for Mkr, Teq, got none"):
        evaluate(mechanism("juki-mf7923d"), 0.0, ["Jeq", "Mkr", "Teq"])


def test_a_speed_of_another_shape():
    with pytest.raises(LinkproofError, match=r"expected a number or an array of the crank angles' shape \(3,\)"):
        evaluate(mechanism("juki-mf7923d"), angles(3), ["Teq"], speed=angles(4))


def test_the_size_of_a_piece_changes_not_one_bit(monkeypatch):
    sample, angle = mechanism("rimoldi-164"), angles(3000)
    whole = evaluate(sample, angle, ["Mkr"], speed=3.0)["Mkr"]
    monkeypatch.setattr(evaluation, "PIECE", 517)
    assert np.array_equal(evaluate(sample, angle, ["Mkr"], speed=3.0)["Mkr"], whole)
