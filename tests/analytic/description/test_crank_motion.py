"""Crank motions: run-ups, and swings by every law, against formulas of their own."""

import math

import mpmath
import numpy as np
import pytest

from analytic.description.crank_motion import (
    LAWS,
    RAMPS,
    RPM,
    Move,
    crank_motion,
    degrees,
    sequence,
    swing,
    table_motion,
)
from analytic.description.linkage import PrescribedRegime
from analytic.description.loading import parse
from analytic.errors import LinkproofError, UnknownNameError
from tests.analytic.linkages import JUKI
from tests.analytic.tolerances import FEW_ROUNDINGS

TIME = np.linspace(0.0, 0.7, 1401)


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


FIFTY = mpmath.mp.clone()
FIFTY.dps = 50
START, END, SWING_TIME = 0.3, -1.7, 0.37
ROUNDINGS = 1e-15  # of the peak of angle, speed or acceleration


def modified_sine(x):
    """Norton's three parts."""
    pi = FIFTY.pi
    if 8 * x <= 1:
        return (pi * x - FIFTY.sin(4 * pi * x) / 4) / (4 + pi)
    if 8 * x <= 7:
        return (2 + pi * x - 9 * FIFTY.sin((4 * pi * x + pi) / 3) / 4) / (4 + pi)
    return (4 + pi * x - FIFTY.sin(4 * pi * x) / 4) / (4 + pi)


# Each law with its largest speed and acceleration in textbooks, of travel over time and over its square.
TEXTBOOK = {
    "constant-speed": (lambda x: x, 1.0, 0.0),
    "cubic": (lambda x: 3 * x**2 - 2 * x**3, 1.5, 6.0),
    "polynomial": (lambda x: 10 * x**3 - 15 * x**4 + 6 * x**5, 1.875, 10.0 / 3.0**0.5),
    "cycloidal": (lambda x: x - FIFTY.sin(2 * FIFTY.pi * x) / (2 * FIFTY.pi), 2.0, 2.0 * np.pi),
    "modified-sine": (modified_sine, 1.7596, 5.528),
}


@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_its_formula_in_50_digits_with_the_peaks_of_textbooks(law):
    formula, speed, acceleration = TEXTBOOK[law]
    motion = swing(law, START, END, time=SWING_TIME)
    time = np.linspace(0.0, SWING_TIME, 43)[1:-1]
    for order, values in enumerate((motion.angle, motion.speed, motion.acceleration)):
        scale = (FIFTY.mpf(END) - FIFTY.mpf(START)) / FIFTY.mpf(SWING_TIME) ** order
        slopes = [FIFTY.diff(formula, FIFTY.mpf(float(t)) / FIFTY.mpf(SWING_TIME), order) for t in time]
        exact = [scale * slope + (START if order == 0 else 0) for slope in slopes]
        errors = [abs(FIFTY.mpf(float(got)) - of) for got, of in zip(values(time), exact, strict=True)]
        assert max(errors) <= ROUNDINGS * max(*map(abs, exact), 1e-300)
    peak = np.max(np.abs(motion.acceleration(np.linspace(0.0, SWING_TIME, 20001))))
    assert motion.peak_speed == pytest.approx(speed * 2.0 / SWING_TIME, rel=3e-5)
    assert peak == pytest.approx(acceleration * 2.0 / SWING_TIME**2, rel=3e-5, abs=0.0)
    assert swing(law, START, END, speed=3.0).peak_speed == pytest.approx(3.0, rel=1e-15)
    assert swing(law, START, END, speed=3.0).reach == pytest.approx((END, START), rel=1e-15)


def test_pieces_of_a_law_meet_without_a_jump_and_a_true_jump_is_seen():
    moves = {
        law: swing(law, START, END, time=SWING_TIME, dwell=0.5, back=True) for law in LAWS if law != "constant-speed"
    }
    assert {law for law, motion in moves.items() if motion.jumps} == {"cubic"}
    assert moves["cubic"].jumps == pytest.approx((0.0, SWING_TIME, SWING_TIME + 0.5))
    for motion in moves.values():
        for before, after in zip(motion.segments, motion.segments[1:], strict=False):
            assert before.value(before.end) == pytest.approx(after.value(after.start), abs=4e-15)
            assert before.value(before.end, 1) == pytest.approx(after.value(after.start, 1), abs=6e-14)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: sequence("tour", 0.0, [Move(-1.0, 2.0)]), "time of a segment: expected a positive finite number of s"),
        (lambda: sequence("tour", 0.0, [Move(1.0, math.nan)]), "angle of a segment: expected a finite number of rad"),
        (lambda: swing("constant-speed", 0.0, 1.0, time=1.0, dwell=-1.0), "dwell: expected"),
        (lambda: table_motion("bad", [0.0, 1.0, 2.0, 3.0], [0.0, math.nan, 2.0, 3.0]), "finite times and angles"),
        (lambda: table_motion("bad", [0.0, 1e-300, 2e-300, 3e-300], [0.0, 1.0, 2.0, 3.0]), "got some 1e-300 s apart"),
    ],
)
def test_a_motion_that_cannot_be_is_refused(make, words):
    """Beside what a file can say, which test_refusals has."""
    with pytest.raises(LinkproofError, match=words):
        make()


@pytest.mark.parametrize(("points", "error"), [(21, 2e-4), (161, 5e-8)])
def test_a_table_of_a_law_is_that_law_to_the_fourth_order(points, error):
    """A cubic spline errs by h⁴, at its ends, where its slopes are unknown, by a little more."""
    law, time = swing("cycloidal", 0.2, 1.7, time=0.5), np.linspace(0.0, 0.5, points)
    motion = table_motion("read", time.tolist(), law.angle(time).tolist())
    assert motion.angle(time) == pytest.approx(law.angle(time), abs=1e-15)
    dense = np.linspace(0.0, 0.5, 2003)
    assert motion.angle(dense) == pytest.approx(law.angle(dense), abs=error)
    assert motion.peak_speed == pytest.approx(law.peak_speed, rel=20 * error)


def test_a_table_has_no_jump_but_the_start():
    motion = table_motion("uneven", [0.0, 0.1, 0.15, 0.3, 0.5], [0.2, 0.3, 0.4, 1.1, 1.7])
    assert set(motion.jumps) <= {0.0}
    for before, after in zip(motion.segments, motion.segments[1:], strict=False):
        for order in range(3):
            assert before.value(before.end, order) == pytest.approx(after.value(after.start, order), abs=1e-11)
    table_motion("fast", [0.0, 1.0, 2.0, 2.1, 2.2, 2.3, 3.0, 4.0], [0.0, 0.0, 0.0, 0.3, 0.8, 1.0, 1.0, 1.0])


def regime(text):
    """The regime that a linkage file describes by this text."""
    (only,) = parse(f"{JUKI}\n[regimes.mine]\n{text}\n", "mine", "mine.toml", None).regimes
    return only


def test_a_file_describes_swings_segments_and_tables():
    swinging = regime('from = 20\nto = 110\nspeed = 60\nlaw = "cycloidal"\ndwell = 0.2\nback = true')
    assert isinstance(swinging, PrescribedRegime)
    assert swinging.motion.regime == "mine"
    assert swinging.motion.peak_speed == pytest.approx(60.0 * RPM)
    assert swinging.motion.duration == pytest.approx(2 * 0.5 + 0.2)
    assert np.degrees(swinging.motion.angle([0.0, 0.6, 1.2])) == pytest.approx([20.0, 110.0, 20.0])
    assert regime("from = 20\nto = -10\ntime = 0.5").motion.speed(0.1) == pytest.approx(math.radians(-60.0))
    parts = regime('start_angle = 10\nsegments = [{ to = 90, time = 0.2, law = "cubic" }, { dwell = 0.1 }]').motion
    assert np.degrees(parts.angle([0.0, 0.2, 0.3])) == pytest.approx([10.0, 90.0, 90.0])
    assert parts.jumps == pytest.approx((0.0, 0.2))
    table = regime("time = [0, 0.1, 0.2, 0.3, 0.4]\nangle = [0, 5, 20, 30, 33]").motion
    assert np.degrees(table.angle([0.0, 0.1, 0.2, 0.3, 0.4])) == pytest.approx([0, 5, 20, 30, 33])


def test_a_file_releases_the_crank_under_a_torque_over_angle_or_time():
    constant = regime("torque = 0.5\nstart_angle = 30\nduration = 2")
    assert (constant.torque, constant.over_angle, constant.over_time) == (0.5, None, None)
    over_angle = regime("torque = [0.1, 0.3, 0.2]\nangle = [0, 90, 180]\nstart_angle = 30\nduration = 2").over_angle
    assert over_angle(math.pi / 2)[0] == pytest.approx(0.3)
    over_time = regime("torque = [0.1, 0.3]\ntime = [0.5, 1.5]\nstart_angle = 30\nduration = 2").over_time
    assert over_time([0.0, 1.0, 2.0]) == pytest.approx([0.1, 0.2, 0.3])


@pytest.mark.parametrize("at", [0, 3, 9])
def test_a_step_that_no_other_explains_is_refused_wherever_it_is(at):
    angle = np.linspace(0.0, 1.0, 11)
    angle[at + 1 :] += 5.0
    with pytest.raises(LinkproofError, match=rf"between {at} s and {at + 1} s"):
        table_motion("jump", np.arange(11.0), angle)
    angle = np.linspace(0.0, 1.0, 11)
    angle[at] += 5.0  # a point off
    with pytest.raises(LinkproofError, match="without a jump"):
        table_motion("spike", np.arange(11.0), angle)
