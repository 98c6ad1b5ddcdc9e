"""The crank's motion behind a rounded column: the motion itself, and a floor that holds what the rounding hides."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import LAWS, crank_motion, swing
from comparisons.filejudge.crank_column import (
    even_instants,
    motion_of_angles,
    motion_of_speeds,
    unwrap_angles,
)

DEGREE = math.pi / 180.0
AT_REST = [name for name, law in LAWS.items() if law.at_rest and name != "cycloidal"]


@pytest.mark.parametrize("name", ["constant-speed", "run-up", "run-up-quintic"])
def test_a_regime_comes_back_from_its_rounded_angles_within_what_they_hide(name):
    true = crank_motion(name, start_angle=0.4)
    time = np.linspace(0.0, 0.7, 701)
    printed = np.round(true.angle(time) / DEGREE, 3)
    found = motion_of_angles(time, printed * DEGREE, np.full(701, 0.5e-3 * DEGREE))
    away = np.abs(time - 0.6) > 2e-3
    for order in ("angle", "speed", "acceleration"):
        error = np.abs(getattr(found, order)(time) - getattr(true, order)(time))[away]
        likewise = [np.abs(getattr(o, order)(time) - getattr(found, order)(time))[away] for o in found.likewise]
        spread = np.max(likewise)
        peak = np.max(np.abs(getattr(true, order)(time)))
        assert np.max(error) <= 3.0 * spread + 1e-9 * peak, order
        assert np.max(error) <= 1e-4 * peak, order
    assert all(abs(jump - 0.6) < 2e-3 or jump == 0.0 for jump in found.jumps)
    assert any(abs(jump - 0.6) < 2e-3 for jump in found.jumps) is (name == "run-up")


def test_a_servo_with_constant_accelerations_has_its_jumps_found():
    time = np.linspace(0.0, 1.0, 1001)
    acceleration = np.where(time < 0.25, 80.0, np.where(time < 0.7, 0.0, -200.0 / 3.0))
    speed = np.interp(time, [0.0, 0.25, 0.7, 1.0], [0.0, 20.0, 20.0, 0.0])
    angle = np.where(time < 0.25, 40.0 * time**2, 2.5 + 20.0 * (time - 0.25))
    angle = np.where(time < 0.7, angle, 11.5 + 20.0 * (time - 0.7) - 100.0 / 3.0 * (time - 0.7) ** 2)
    found = motion_of_angles(time, np.round(angle, 6), np.full(1001, 5e-7))
    assert found.jumps == pytest.approx((0.0, 0.25, 0.7), abs=2e-3)  # it starts from rest
    away = (np.abs(time - 0.25) > 3e-3) & (np.abs(time - 0.7) > 3e-3)
    np.testing.assert_allclose(found.speed(time)[away], speed[away], atol=1e-4)
    np.testing.assert_allclose(found.acceleration(time)[away], acceleration[away], atol=1e-2)


def test_speeds_in_place_of_angles_come_back():
    run_up = crank_motion("run-up-quintic", start_angle=0.3)
    time = np.linspace(0.0, 0.7, 701)
    by_speed = motion_of_speeds(time, np.round(run_up.speed(time), 4), np.full(701, 5e-5), start_angle=0.3)
    np.testing.assert_allclose(by_speed.angle(time), run_up.angle(time), atol=1e-5)
    np.testing.assert_allclose(by_speed.acceleration(time), run_up.acceleration(time), atol=1e-2)


@pytest.mark.parametrize("law", ["cycloidal", *(pytest.param(law, marks=pytest.mark.nightly) for law in AT_REST)])
@pytest.mark.parametrize(
    ("back", "dwell"), [pytest.param(False, 0.05, marks=pytest.mark.nightly), (True, 0.05), (True, 0.0)]
)
@pytest.mark.parametrize("digit", [0.01, 1e-13])
def test_swings_are_known_from_their_rounded_angles(law, back, dwell, digit):
    true = swing(law, 100.0 * DEGREE, 150.0 * DEGREE, time=0.2, dwell=dwell, back=back)
    time = np.linspace(0.0, true.duration, 501)
    printed = np.round(true.angle(time) / DEGREE / digit) * digit * DEGREE
    found = motion_of_angles(time, printed, np.full(501, 0.5 * digit * DEGREE))
    assert found.regime == (f"{law} and back" if back else law)
    error = np.abs(found.acceleration(time) - true.acceleration(time))
    at_steps = np.any(np.abs(time[:, None] - np.array([0.2, 0.2 + dwell, *true.jumps])) < 1e-3, axis=1)
    assert np.max(error[~at_steps]) < 2e-4 * np.max(np.abs(true.acceleration(time)))


def test_equal_steps_are_told_from_their_rounding_and_turns_are_unwound():
    time = np.linspace(0.0, 1.0, 61)
    printed = np.round(time, 3)
    even, open_ = even_instants(printed, np.full(61, 5e-4))
    np.testing.assert_allclose(even, time, atol=2e-4)
    assert np.max(open_) < 1e-4
    uneven = printed + np.where(np.arange(61) == 30, 0.004, 0.0)
    assert even_instants(uneven, np.full(61, 5e-4))[0] is uneven
    angle = np.linspace(0.0, 20.0, 200)
    np.testing.assert_allclose(unwrap_angles((angle + math.pi) % (2.0 * math.pi) - math.pi), angle, atol=1e-12)


def test_of_a_noisy_column_the_motion_comes_back():
    time, random = np.linspace(0.0, 0.7, 5_001), np.random.default_rng(0)
    angle = 60.0 * time + 0.3 * np.sin(9.0 * time)
    found = motion_of_angles(time, angle + random.normal(0.0, 1e-3, len(time)), np.full(len(time), 1e-8))
    np.testing.assert_allclose(found.angle(time), angle, atol=2e-3)


def test_an_acceleration_that_changes_fastest_at_the_end_is_no_corner():
    time = np.linspace(0.0, 1.0, 41)
    angle = 0.01 * np.exp(6.0 * time)
    found = motion_of_angles(time, np.round(angle, 6), np.full(41, 5e-7))
    assert (found.jumps, found.is_known) == ((), False)
    np.testing.assert_allclose(found.angle(time), angle, atol=2e-6)


def test_a_constant_speed_of_few_digits_is_known_no_better_than_they_say():
    digits = 1
    true, time = 1000.0 * math.pi / 30.0, np.linspace(0.0, 0.12, 121)
    found = motion_of_speeds(time, np.full(121, round(true, digits)), np.full(121, 0.5 * 10.0**-digits))
    spread = max(np.max(np.abs(other.speed(time) - found.speed(time))) for other in found.likewise)
    assert np.max(np.abs(found.speed(time) - true)) <= 3.0 * spread


@pytest.mark.parametrize(("rpm", "digits"), [(600, 4), (1480, 6)])
def test_a_run_up_is_known_whichever_way_its_steady_part_is_rounded(rpm, digits):
    motion, time = crank_motion("run-up-quintic", speed=rpm * math.pi / 30.0), np.linspace(0.0, 0.7, 701)
    unit = 10.0 ** (np.floor(np.log10(np.maximum(motion.speed(time), 1e-6))) - digits + 1)
    found = motion_of_speeds(time, unit * np.round(motion.speed(time) / unit), np.maximum(unit, 1e-6) / 2.0)
    assert found.regime == "run-up-quintic"
