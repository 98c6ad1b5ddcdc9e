"""PyBullet's own: what its bodies weigh, and a start at full speed."""

import pytest

from analytic.description.crank_motion import crank_motion
from engines.contract import Setting
from engines.pybullet_adapter import PybulletEngine
from engines.scene import Prescribed
from engines.stepping.stepped_engine import plain
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import driven, errors_of, run_of

FULL_SPEED = crank_motion("constant-speed", ramp_time=0.06, hold_time=0.0, start_angle=0.3)
RECIPES = PybulletEngine.settings[Prescribed]


@pytest.fixture(autouse=True)
def pybullet():
    return pytest.importorskip("pybullet")


@pytest.mark.parametrize("setting", [Setting.NAIVE, Setting.TUNED])
def test_bodies_have_the_inertia_that_they_are_given(setting, pybullet):
    """PyBullet 3.2.7 forgets one that it is given in one call with a damping."""
    loop, scene = pytest.importorskip("engines.pybullet_loop"), driven(mechanism("slotted-takeup"), FULL_SPEED)
    world = loop.World(plain(PybulletEngine().model(scene, RECIPES[setting])))
    inertias = [pybullet.getDynamicsInfo(body, -1, world.client)[2][2] for body in world.bodies[:-1]]
    pybullet.disconnect(world.client)
    assert inertias == [body.inertia or body.mass for body in scene.bodies]


def test_the_first_samples_of_a_start_at_full_speed_are_as_good_as_the_others():
    linkage = mechanism("slotted-takeup")
    history = run_of(PybulletEngine(), linkage, FULL_SPEED, Setting.TUNED)
    signals = (history.position, history.acceleration, history.torque, *history.joint_force.values())
    assert [signal.time[0] for signal in signals] == [0.0] * len(signals)
    assert max(errors_of(history, linkage, FULL_SPEED).values()) < 5e-5
