"""Motions of a drive along a line: in the unit of length of the linkage's file, over its range by default."""

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.datasheet.building import MARGIN
from reports.requests.campaign import request
from reports.requests.motions import prescribed
from reports.requests.options.campaign import CompareOptions
from reports.requests.options.declaring import stated
from reports.requests.options.motion import MotionOptions
from tests.analytic.drives import driven, path_of

MOTOR = driven("linear-motor")


def asked(**choice):
    (motion,), conditions = prescribed(MotionOptions(**choice), [MOTOR.linkage])
    return motion, conditions


def ends(motion):
    return [float(motion.angle(np.array(time))) for time in (0.0, motion.duration)]


def test_travels_and_speeds_are_in_millimetres_as_the_file_is():
    motion, conditions = asked(from_angle=10.0, to_angle=60.0, speed=25.0)
    assert ends(motion) == pytest.approx([0.010, 0.060])
    assert motion.peak_speed == pytest.approx(0.025)
    assert motion.duration == pytest.approx(2.0)
    assert conditions == "from 10 mm to 60 mm, at most 25 mm/s"


def test_without_a_speed_the_mean_is_that_of_a_second_and_without_ends_it_goes_over_the_range():
    low, high = MOTOR.crank_range().limits
    for backwards in (False, True):
        motion, _ = asked(clockwise=backwards)
        inside = [low + MARGIN * (high - low), high - MARGIN * (high - low)]
        assert ends(motion) == pytest.approx(inside[::-1] if backwards else inside)
        assert motion.duration == pytest.approx(1.0)


def test_what_turns_a_crank_and_what_moves_several_is_refused():
    with pytest.raises(LinkproofError, match="--regime run-up turns a crank"):
        asked(regime=("run-up",))
    with pytest.raises(LinkproofError, match="cannot share a motion with other linkages"):
        prescribed(MotionOptions(), [load("juki-mf7923d"), MOTOR.linkage])


def test_cranks_have_the_motions_they_had_and_a_campaign_takes_both():
    choice = MotionOptions(regime=("all",))
    assert prescribed(choice, [load("juki-mf7923d")]) == prescribed(choice, [])
    campaign = request(
        CompareOptions(mechanisms=(path_of("linear-motor"),), regime=("cycloidal",), from_angle=0.0, to_angle=50.0)
    )
    assert ends(campaign.motions[0]) == pytest.approx([0.0, 0.05])
    assert campaign.conditions.startswith("from 0 mm to 50 mm")


def test_a_speed_that_is_given_counts_even_if_it_is_the_default_of_a_crank():
    motion, _ = asked(from_angle=10.0, to_angle=60.0, speed=1000.0)
    assert motion.peak_speed == pytest.approx(1.0)
    assert stated(MotionOptions(speed=1000.0)) == {"speed": ("1000",)}


def test_a_start_angle_is_refused_where_nothing_turns():
    with pytest.raises(LinkproofError, match=r"--start-angle turns a crank, but 'linear-motor' is driven along a line"):
        asked(start_angle=90.0)
