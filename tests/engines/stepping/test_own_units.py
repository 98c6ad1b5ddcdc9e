"""A scene in its own units is the same scene: the engine returns the same motion whatever the units."""

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.case import scene
from engines.contract import History, Outcome, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.mechanics.joints import scene_size
from engines.mechanics.start_check import start_misfit
from engines.scene import Channel, Free, Prescribed
from engines.stepping.own_units import LARGEST_MASS, OwnUnits, own_units, restored, scaled
from tests.analytic.linkages import mechanism

SAME = 1e-8  # of a peak: the same numbers but for rounding and where an iteration ends
ALL = frozenset(Channel)


def _scene(name, drive=None):
    return scene(mechanism(name), drive or Prescribed(crank_motion("run-up-quintic", ramp_time=0.05)), ALL)


@pytest.mark.parametrize("name", ["rimoldi-164", "spring-and-damper", "force-over-angle", "moving-guides"])
def test_own_units_make_size_and_masses_what_they_promise(name):
    model = _scene(name)
    own = scaled(model, own_units(model))
    assert scene_size(own) == pytest.approx(1.0)
    assert max(body.mass for body in own.bodies) == pytest.approx(LARGEST_MASS)
    assert start_misfit(own) is None


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


def test_a_free_drives_torque_is_scaled_too():
    model = _scene("juki-mf7923d", Free(0.02, 0.1))
    units = OwnUnits(0.05, 2.0)
    assert scaled(model, units).drive == Free(0.02 / (2.0 * 0.05**2), 0.1)


def test_channels_that_were_not_recorded_stay_absent():
    assert restored(History(), OwnUnits(2.0, 3.0)) == History()
