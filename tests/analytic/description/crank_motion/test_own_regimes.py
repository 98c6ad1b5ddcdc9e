"""Regimes of a linkage file: each kind read, and what contradicts itself refused with place and cure."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import RPM
from analytic.description.linkage import PrescribedRegime
from analytic.description.loading import find, parse
from analytic.errors import DescriptionError

HEAD = find("juki-mf7923d").read_text()


def regime(text):
    linkage = parse(f"{HEAD}\n[regimes.mine]\n{text}\n", "mine", "mine.toml", None)
    (own,) = linkage.regimes
    return own


def motion(text):
    own = regime(text)
    assert isinstance(own, PrescribedRegime)
    assert own.motion.regime == "mine"
    return own.motion


def test_a_swing_goes_there_and_back_with_a_dwell():
    found = motion('from = 20\nto = 110\nspeed = 60\nlaw = "cycloidal"\ndwell = 0.2\nback = true')
    assert found.peak_speed == pytest.approx(60.0 * RPM)
    assert found.duration == pytest.approx(2 * 0.5 + 0.2)
    assert np.degrees(found.angle([0.0, 0.6, 1.2])) == pytest.approx([20.0, 110.0, 20.0])
    assert motion("from = 20\nto = -10\ntime = 0.5").speed(0.1) == pytest.approx(math.radians(-60.0))


def test_segments_follow_one_another():
    found = motion('start_angle = 10\nsegments = [{ to = 90, time = 0.2, law = "cubic" }, { dwell = 0.1 }]')
    assert np.degrees(found.angle([0.0, 0.2, 0.3])) == pytest.approx([10.0, 90.0, 90.0])
    assert found.jumps == pytest.approx((0.0, 0.2))


def test_a_table_is_met_at_its_points():
    found = motion("time = [0, 0.1, 0.2, 0.3, 0.4]\nangle = [0, 5, 20, 30, 33]")
    assert np.degrees(found.angle([0.0, 0.1, 0.2, 0.3, 0.4])) == pytest.approx([0, 5, 20, 30, 33])


def test_a_crank_is_released_under_a_torque_over_angle_or_time():
    rest = "start_angle = 30\nduration = 2"
    own = regime(f"torque = 0.5\n{rest}")
    assert (own.torque, own.over_angle, own.over_time) == (0.5, None, None)
    own = regime(f"torque = [0.1, 0.3, 0.2]\nangle = [0, 90, 180]\n{rest}")
    assert own.over_angle(math.pi / 2)[0] == pytest.approx(0.3)
    own = regime(f"torque = [0.1, 0.3]\ntime = [0.5, 1.5]\n{rest}")
    assert own.over_time([0.0, 1.0, 2.0]) == pytest.approx([0.1, 0.2, 0.3])
    assert own.over_time([0.0, 1.0, 2.0]).tolist() == pytest.approx([0.1, 0.2, 0.3])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("from = 20", "regimes.mine.to is missing: expected the angle at which the swing ends; add it"),
        ("from = 20\nto = 20\ntime = 1", "the same twice"),
        ("from = 20\nto = 30", "either a speed or a time"),
        ("from = 20\nto = 30\ntime = 1\ntorque = 2", "regimes.mine.torque: expected the keys of a swing, .*leave"),
        ('from = 20\nto = 30\ntime = 1\nlaw = "sine"', "unknown law 'sine'"),
        ("from = 20\nto = 30\ntime = 1\nback = true", "regimes.mine: expected a speed without a jump"),
        ("from = 20\nto = 30\ntime = 1\nbacck = true", "did you mean 'back'"),
        ("from = 20\nto = 30\nspeed = -5", "expected a positive finite speed in rpm, got -5"),
        ("segments = [{ to = 20, time = 1 }, { dwell = 1 }]", "got .* rpm before and 0 rpm after 1 s"),
        ("segments = [{ to = 20 }]", "segments #1: expected either a speed or a time"),
        ("segments = [{ dwell = 1, to = 3 }]", "either an angle to go to or a dwell"),
        ("segments = [{ dwell = 1, time = 3 }]", "expected a dwell alone, got time"),
        ("segments = []", "one segment or more"),
        ("time = [0, 1, 2]\nangle = [0, 1, 2]", "4 or more of each, got 3 angles and 3"),
        ("time = [0, 1, 1, 3]\nangle = [0, 1, 2, 3]", r"mine\.time: .* increase, got 1 s after 1 s .point 3."),
        (
            "time = [0, 1, 2, 3, 4]\nangle = [0, 1, 2, 90, 91]",
            r"mine\.angle: .* got 2° to 90° between 2 s and 3 s",
        ),
        ("time = [0, 1, 2, 3, 4, 5]\nangle = [0, 1, 2, 90, 4, 5]", "without a jump, got 2° to 90°"),
        ("time = [1, 2, 3, 4]\nangle = [0, 1, 2, 3]", "times from 0 on, got 1 s first"),
        ("angle = [0, 1, 2, 3]", "add time = "),
        ("torque = 1\nduration = 1", "regimes.mine.start_angle is missing"),
        ("torque = [1, 2]\nstart_angle = 1\nduration = 1", "over angle = .* or over time"),
        ("torque = 1\ntime = [1, 2]\nstart_angle = 1\nduration = 1", "expected a list of torques beside it"),
        ("torque = [1, 2]\ntime = [1, 1]\nstart_angle = 1\nduration = 1", "times that increase, got 1 s after 1 s"),
        ("torque = [1, 2]\ntime = [1]\nstart_angle = 1\nduration = 1", "got 1 times and 2 torques"),
    ],
)
def test_a_regime_that_cannot_be_is_one_sentence_with_its_place(text, words):
    with pytest.raises(DescriptionError, match=words) as raised:
        regime(text)
    line = HEAD.count("\n") + 2
    assert any(str(raised.value).startswith(f"mine.toml:{line + n}:") for n in range(6))


def test_the_name_of_a_law_is_taken():
    with pytest.raises(DescriptionError, match="a name of its own"):
        parse(f"{HEAD}\n[regimes.cycloidal]\nfrom = 1\nto = 2\ntime = 1\n", "mine", "mine.toml", None)


@pytest.mark.parametrize(
    "text",
    ["from = 1\nto = 2\ntime = 1", "torque = [1, 2]\ntime = [1, 2]\nstart_angle = 1\nduration = 1"],
)
def test_a_printed_model_needs_a_crank_released_under_a_constant_torque(text):
    erratum = '[[errata]]\nname = "k2"\nplace = "p. 1"\nregime = "mine"\nhalf_slope = "moduli"'
    with pytest.raises(DescriptionError, match=r"errata #1.regime: expected a regime in which the crank is released"):
        regime(f"{text}\n{erratum}")
