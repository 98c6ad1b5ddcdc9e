"""The places of a judgement's worst errors, as a reader knows them."""

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion, swing
from analytic.description.loading import load
from comparisons.imported.judge import judge
from reports.document.terminal import rendered
from reports.imported import printout
from tests.comparisons.imported.layouts import exported

JUKI = load("juki-mf7923d")


def printed(linkage, motion, time, sample):
    """What is printed of a velocity that is wrong at one sample."""

    def change(values, _):
        wrong = values["Teq"].copy()
        wrong[sample] += 0.5 * np.max(np.abs(wrong))
        return {"Teq": wrong}

    judgement = judge(linkage, exported(linkage, motion, ("Teq",), time, change=change), motion)
    return rendered(*printout(judgement, "").tables)


@pytest.mark.parametrize(("ends", "degrees"), [((-40.0, 40.0), "-24.0°"), ((0.0, 720.0), "144.0°")])
def test_an_angle_is_within_a_turn_only_where_the_crank_makes_one(ends, degrees):
    motion = swing("constant-speed", *np.radians(ends), speed=1000 * RPM)
    assert f" {degrees} " in printed(JUKI, motion, np.linspace(0.0, motion.duration, 101), 20)


def test_an_instant_that_is_nothing_but_rounding_is_zero():
    motion = crank_motion("constant-speed", speed=1000 * RPM, ramp_time=0.06, hold_time=0.0)
    time = np.linspace(0.0, 0.06, 101) - 6e-18
    assert " 0 s " in printed(JUKI, motion, time, 0)
