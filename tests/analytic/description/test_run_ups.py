"""Run-ups to a constant speed: derivatives that belong together, exact ends, jumps only where the ramp has them."""

import numpy as np
import pytest
from numpy.polynomial import polynomial

from analytic.description.crank_motion import RAMPS, REGIMES, RPM, crank_motion, degrees
from analytic.errors import LinkproofError, UnknownNameError
from tests.analytic.tolerances import FEW_ROUNDINGS

TIME = np.linspace(0.0, 0.7, 1401)


@pytest.mark.parametrize("regime", REGIMES)
def test_a_segment_is_its_polynomial_to_the_last_bit(regime):
    """Steppers compare clocks and kinks to rounding: NumPy's own evaluation, derivatives of any order included."""
    for segment in crank_motion(regime, clockwise=True, start_angle=0.3).segments:
        for order in range(4):
            series = polynomial.polyder(np.array(segment.coefficients), order)
            for time in (TIME, TIME.reshape(3, -1), TIME[:0], np.float64(0.3), 0.3):
                expected = polynomial.polyval(np.asarray(time) - segment.start, series)
                assert np.array_equal(segment.value(time, order), expected)


@pytest.mark.parametrize("regime", RAMPS)
def test_a_run_up_ends_at_its_speed_and_continues_at_it(regime):
    motion = crank_motion(regime)
    step, inside = 1e-4, TIME[(np.abs(TIME - 0.6) > 2e-4) & (TIME > 1e-3) & (TIME < 0.699)]
    for value, slope in ((motion.angle, motion.speed), (motion.speed, motion.acceleration)):
        difference = (value(inside + step) - value(inside - step)) / (2.0 * step)
        assert slope(inside) == pytest.approx(difference, abs=1e-6 * np.max(np.abs(slope(inside))))
    assert motion.speed(0.0) == 0.0
    assert motion.speed(TIME[TIME >= 0.6]) == pytest.approx(1000.0 * RPM, rel=FEW_ROUNDINGS)
    assert np.all(np.diff(motion.speed(TIME)) >= -FEW_ROUNDINGS * 1000.0)
    assert motion.angle(0.6) == pytest.approx(0.5 * 0.6 * 1000.0 * RPM, rel=FEW_ROUNDINGS)  # each ramp's mean is half
    assert motion.duration == pytest.approx(0.7)
    assert motion.peak_speed == pytest.approx(1000.0 * RPM, rel=FEW_ROUNDINGS)
    assert motion.jumps == ((0.0, 0.6) if regime == "run-up" else ())


def test_constant_speed_either_way_and_a_ramp_without_a_hold():
    motion = crank_motion("constant-speed", speed=3.0, start_angle=0.4, clockwise=True)
    assert motion.angle(0.5) == pytest.approx(0.4 - 1.5)
    assert np.all(motion.acceleration(TIME) == 0.0)
    assert motion.jumps == ()
    assert crank_motion(hold_time=0.0).duration == 0.6


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"speed": -3.0}, "speed: expected a positive finite number of rad/s, got -3; correct it"),
        ({"ramp_time": np.nan}, "ramp time: expected a positive finite number of s, got nan"),
        ({"ramp_time": 1e-300}, "ramp time: expected a positive finite number of s, got 1e-300"),
        ({"hold_time": -0.1}, "hold time: expected a finite, not negative number of s, got -0.1"),
        ({"start_angle": np.nan}, "start angle: expected a finite number of rad, got nan"),
    ],
)
def test_numbers_that_make_no_motion(values, message):
    with pytest.raises(LinkproofError, match=message):
        crank_motion(**values)
    with pytest.raises(UnknownNameError, match="unknown regime 'runup': did you mean 'run-up'"):
        crank_motion("runup")


@pytest.mark.parametrize(
    ("angle", "written"), [(np.pi, "180°"), (-1e-9, "0°"), (2.0 * np.pi - 1e-7, "0°"), (7.0, "41.07°")]
)
def test_an_angle_is_written_below_a_full_turn(angle, written):
    assert degrees(angle) == written
