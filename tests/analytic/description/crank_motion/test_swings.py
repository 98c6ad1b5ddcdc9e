"""Laws of motion against 50 digits, their joins, and sequences of them."""

import mpmath
import numpy as np
import pytest

from analytic.description.crank_motion import LAWS, RPM, Move, sequence, swing
from analytic.errors import LinkproofError, UnknownNameError

FIFTY = mpmath.mp.clone()
FIFTY.dps = 50
START, END, TIME = 0.3, -1.7, 0.37
ROUNDINGS = 1e-15  # of the peak of angle, speed or acceleration


def modified_sine(x):
    """Norton's three parts."""
    pi = FIFTY.pi
    if 8 * x <= 1:
        return (pi * x - FIFTY.sin(4 * pi * x) / 4) / (4 + pi)
    if 8 * x <= 7:
        return (2 + pi * x - 9 * FIFTY.sin((4 * pi * x + pi) / 3) / 4) / (4 + pi)
    return (4 + pi * x - FIFTY.sin(4 * pi * x) / 4) / (4 + pi)


TEXTBOOK = {
    "constant-speed": lambda x: x,
    "cubic": lambda x: 3 * x**2 - 2 * x**3,
    "polynomial": lambda x: 10 * x**3 - 15 * x**4 + 6 * x**5,
    "cycloidal": lambda x: x - FIFTY.sin(2 * FIFTY.pi * x) / (2 * FIFTY.pi),
    "modified-sine": modified_sine,
}
# The largest speed and acceleration of each in textbooks, of travel over time and over its square.
PEAKS = {
    "constant-speed": (1.0, 0.0),
    "cubic": (1.5, 6.0),
    "polynomial": (1.875, 10.0 / 3.0**0.5),
    "cycloidal": (2.0, 2.0 * np.pi),
    "modified-sine": (1.7596, 5.528),
}


@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_its_formula_in_50_digits(law):
    motion = swing(law, START, END, time=TIME)
    for order, values in enumerate((motion.angle, motion.speed, motion.acceleration)):
        time = np.linspace(0.0, TIME, 83)[1:-1]
        scale = (FIFTY.mpf(END) - FIFTY.mpf(START)) / FIFTY.mpf(TIME) ** order
        slopes = [FIFTY.diff(TEXTBOOK[law], FIFTY.mpf(float(t)) / FIFTY.mpf(TIME), order) for t in time]
        exact = [scale * slope + (START if order == 0 else 0) for slope in slopes]
        errors = [abs(FIFTY.mpf(float(got)) - of) for got, of in zip(values(time), exact, strict=True)]
        assert max(errors) <= ROUNDINGS * max(*map(abs, exact), 1e-300)


@pytest.mark.parametrize("law", LAWS)
def test_peaks_are_the_textbooks(law):
    motion = swing(law, START, END, time=TIME)
    speed, acceleration = PEAKS[law]
    assert motion.peak_speed == pytest.approx(speed * 2.0 / TIME, rel=3e-5)
    found = np.max(np.abs(motion.acceleration(np.linspace(0.0, TIME, 20001))))
    assert found == pytest.approx(acceleration * 2.0 / TIME**2, rel=3e-5, abs=0.0)
    assert swing(law, START, END, speed=3.0).peak_speed == pytest.approx(3.0, rel=1e-15)
    assert swing(law, START, END, speed=3.0).reach == pytest.approx((END, START), rel=1e-15)


def test_pieces_of_a_law_meet_without_a_jump_and_a_true_jump_is_seen():
    moves = {law: swing(law, START, END, time=TIME, dwell=0.5, back=True) for law in LAWS if law != "constant-speed"}
    assert {law for law, motion in moves.items() if motion.jumps} == {"cubic"}
    assert moves["cubic"].jumps == pytest.approx((0.0, TIME, TIME + 0.5))
    for motion in moves.values():
        for before, after in zip(motion.segments, motion.segments[1:], strict=False):
            assert before.value(before.end) == pytest.approx(after.value(after.start), abs=4e-15)
            assert before.value(before.end, 1) == pytest.approx(after.value(after.start, 1), abs=6e-14)


def test_a_sequence_goes_where_it_is_told():
    motion = sequence("tour", 0.1, [Move(0.2, 1.5, "cycloidal"), Move(0.3), Move(0.4, -0.5, "modified-sine")])
    assert motion.duration == pytest.approx(0.9)
    assert motion.angle([0.0, 0.2, 0.35, 0.5, 0.9]) == pytest.approx([0.1, 1.5, 1.5, 1.5, -0.5])
    assert motion.reach == pytest.approx((-0.5, 1.5))
    assert motion.jumps == ()


@pytest.mark.parametrize(
    ("moves", "words"),
    [
        ([], "one segment or more, got none"),
        ([Move(-1.0, 2.0)], "time of a segment: expected a positive finite number of s, got -1"),
        ([Move(1.0, float("nan"))], "angle of a segment: expected a finite number of rad, got nan"),
        ([Move(1.0, RPM), Move(1.0)], "got 1 rpm before and 0 rpm after 1 s"),
        ([Move(1.0, 1.0), Move(1.0, 0.0)], "speed without a jump"),
        ([Move(1.0, 1.0, "cycloid")], "unknown law 'cycloid': did you mean 'cycloidal'"),
    ],
)
def test_a_sequence_that_cannot_be_is_refused(moves, words):
    with pytest.raises(LinkproofError, match=words):
        sequence("tour", 0.0, moves)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"speed": 1.0, "time": 1.0}, "either a speed or a time"),
        ({}, "either a speed or a time"),
        ({"speed": 0.0}, "speed: expected a positive"),
        ({"time": 1.0, "dwell": -1.0}, "dwell: expected"),
        ({"time": 1.0, "back": True}, "speed without a jump"),
    ],
)
def test_a_swing_that_cannot_be_is_refused(given, words):
    with pytest.raises(LinkproofError, match=words):
        swing("constant-speed", 0.0, 1.0, **given)
    with pytest.raises(LinkproofError, match="the same twice"):
        swing("cubic", 1.0, 1.0, time=1.0)
    with pytest.raises(UnknownNameError):
        swing("run-up", 0.0, 1.0, time=1.0)
