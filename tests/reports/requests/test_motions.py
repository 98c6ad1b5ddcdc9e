"""How the crank is to move, from words to polynomials of time and back, and what cannot be."""

import math

import pytest

from analytic.description.crank_motion import LAWS, REGIMES, RPM
from analytic.description.loading import load
from analytic.errors import LinkproofError
from reports.requests.motions import check_motion, own_regimes, prescribed
from reports.requests.options.declaring import stated
from reports.requests.options.motion import MotionOptions


def motions(options):
    return prescribed(options, [])[0]


SWING = {"from_angle": 20.0, "to_angle": 110.0}


def test_a_negative_speed_turns_clockwise():
    (back,) = motions(MotionOptions(speed=-300.0))
    (clockwise,) = motions(MotionOptions(speed=300.0, clockwise=True))
    assert back == clockwise
    assert MotionOptions(speed=-300.0).conditions == MotionOptions(speed=300.0, clockwise=True).conditions


def test_two_angles_alone_are_constant_speed_between_them():
    (motion,) = motions(MotionOptions(from_angle=110.0, to_angle=20.0, speed=60.0))
    assert motion.regime == "constant-speed"
    assert (motion.angle(0.0), motion.speed(0.0)) == pytest.approx((math.radians(110.0), -60.0 * RPM))
    assert motion.duration == pytest.approx(0.25)
    assert motion.angle(0.25) == pytest.approx(math.radians(20.0))


def test_the_speed_of_a_swing_is_its_largest():
    found = motions(MotionOptions(regime=("all",), speed=120.0, **SWING))
    assert [motion.regime for motion in found] == list(LAWS)
    assert [motion.peak_speed for motion in found] == pytest.approx([120.0 * RPM] * len(LAWS))
    assert [motion.regime for motion in motions(MotionOptions(regime=("all",)))] == list(REGIMES)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, {}),
        ({"speed": -300.0, "regime": ("run-up",)}, {"regime": ("run-up",), "speed": ("-300",)}),
        ({"clockwise": True, "gravity": False}, {"clockwise": (), "no-gravity": ()}),
        ({**SWING, "variant": "as-printed"}, {"variant": ("as-printed",), "from": ("20",), "to": ("110",)}),
    ],
)
def test_the_words_ask_for_the_same(given, words):
    assert stated(MotionOptions(**given)) == words


def test_conditions_tell_motions_apart():
    swings = [SWING, {"from_angle": 110.0, "to_angle": 20.0}, {**SWING, "speed": 50.0}]
    assert len({MotionOptions(**given).conditions for given in [{}, {"speed": -1000.0}, *swings]}) == 5
    assert MotionOptions(**SWING).conditions == "from 20° to 110°, at most 1000 rpm counter-clockwise"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"from_angle": 20.0}, "got only --from: add --to"),
        ({"to_angle": 20.0}, "got only --to: add --from"),
        ({"from_angle": 20.0, "to_angle": 20.0}, "got 20° twice"),
        ({"from_angle": math.nan, "to_angle": 20.0}, "--from: expected a finite number of degrees, got nan"),
        ({**SWING, "speed": -60.0}, "is counter-clockwise, and --speed -60 is not"),
        ({**SWING, "clockwise": True}, "and --clockwise is not"),
        ({**SWING, "start_angle": 5.0}, "--start-angle does not apply to a swing"),
        ({**SWING, "hold_time": 5.0}, "--hold-time does not apply to a swing"),
        ({**SWING, "regime": ("run-up",)}, "--regime run-up does not end at an angle"),
        ({"regime": ("cycloidal",)}, "--regime cycloidal .* add --from and --to"),
        ({"speed": -60.0, "clockwise": True}, "turns clockwise already"),
        ({"speed": math.inf}, "--speed: expected a finite number"),
    ],
)
def test_a_motion_that_contradicts_itself_is_one_sentence(given, words):
    with pytest.raises(LinkproofError, match=words):
        check_motion(MotionOptions(**given))


@pytest.mark.parametrize("name", ["free", "own"])
def test_a_regime_of_the_file_takes_no_other_angles(name):
    with pytest.raises(LinkproofError, match=f"--regime {name} is defined in its file"):
        own_regimes(MotionOptions(regime=(name,), **SWING), [load("slotted-takeup")])
