"""Loads of one instant against those of many, which share no formula but the laws."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.reference.start_state import scene
from engines.mechanics.joints import applied_loads
from engines.mechanics.states import pose_of, start_motion
from engines.mujoco_adapter import EXPERT, MujocoEngine
from engines.scene import Prescribed
from tests.analytic.linkages import mechanism


@pytest.mark.parametrize("name", ["force-over-angle", "spring-and-damper"])
def test_pushes_of_an_instant_are_the_loads_without_gravity_and_dampers(name):
    pytest.importorskip("mujoco")
    from engines.mujoco_loop import load_rows  # noqa: PLC0415 - it imports MuJoCo

    motion = crank_motion("constant-speed", start_angle=0.7)
    given = dataclasses.replace(scene(mechanism(name), Prescribed(motion), frozenset()), gravity=(0.0, 0.0), dampers=())
    place, rate, _ = start_motion(given)
    pose = pose_of(place)
    centre, velocity = (values[0, :, :2] @ [1.0, 1j] for values in (place, rate))
    direction = (pose.cosine + 1j * pose.sine)[0]
    state = [values.tolist() for values in (centre, direction, velocity, rate[0, :, 2])]
    rows = load_rows(MujocoEngine().model(given, EXPERT), given.crank_angle, state)
    loads = applied_loads(given, pose, rate)[0]
    assert np.abs(loads).max() > 1.0
    np.testing.assert_allclose(rows, loads, rtol=0, atol=1e-12 * np.abs(loads).max())
