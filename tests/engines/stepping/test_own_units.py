"""A scene in its own units is the same scene: the engine returns the same motion whatever the units."""

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.motion.case import scene
from engines.contract import Outcome, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import Channel, Prescribed
from engines.stepping.own_units import OwnUnits, restored, scaled
from tests.analytic.linkages import mechanism

SAME = 1e-8  # of a peak: the same numbers but for rounding and where an iteration ends
ALL = frozenset(Channel)


def _scene(name, drive=None):
    return scene(
        mechanism(name), drive or Prescribed(crank_motion("run-up-quintic", ramp_time=0.01, hold_time=0.002)), ALL
    )


@pytest.mark.parametrize(
    ("name", "units"), [("spring-and-damper", OwnUnits(1e-3, 1.0)), ("force-over-angle", OwnUnits(40.0, 1e-4))]
)
def test_an_engine_that_is_exact_returns_the_same_in_any_units(name, units):
    model = _scene(name)
    plain, other = (DirectEngine().run(each, Setting.TUNED) for each in (model, scaled(model, units)))
    assert plain.outcome is other.outcome is Outcome.FINISHED
    back = restored(other.history, units)
    pairs = [(getattr(plain.history, c.value), getattr(back, c.value)) for c in ALL - {Channel.JOINT_FORCE}]
    pairs += [(plain.history.joint_force[name], back.joint_force[name]) for name in back.joint_force]
    for one, two in pairs:
        assert two.values == pytest.approx(one.values, rel=SAME, abs=SAME * np.abs(one.values).max())
