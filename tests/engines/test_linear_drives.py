"""A slider of the ground and a cylinder as the driver: every engine is within its limits, prescribed and released.

Plain linkages with these drivers are among the samples of the conformance test.
"""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import swing
from analytic.description.law import TimeLaw
from analytic.dynamics.released import free_motion
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, channel_truth
from comparisons.trials.campaign.campaign import judged
from engines.contract import Outcome, Setting
from engines.mechanics.states import driven as travelled
from engines.mechanics.states import with_ground
from engines.scene import Channel, Free
from tests.analytic.linkages import driven
from tests.engines.closed_form import installed

ENGINES = ["exudyn", "mujoco", "ondsel", "pymunk", "simbody"]
FREE = 1e-4  # of the travel's reach
# Forces over the travel, springs, dampers, and a host that is driven: start, m, force, N, duration, s.
RELEASED = {"linear-motor": (0.02, 4.0, 0.06), "cylinder-in-the-loop": (0.08, 10.0, 0.05)}


def _swing(sample, start, end):
    """The sample without its loads, so that every engine takes it, in a swing of its driver."""
    linkage = replace(driven(sample).linkage, forces=(), springs=(), dampers=())
    return Case(Mechanism(linkage), swing("cycloidal", start, end, time=0.1, regime="swing"))


@pytest.mark.parametrize(
    "name",
    ["mujoco", "ondsel", "simbody", *(pytest.param(name, marks=pytest.mark.nightly) for name in ("exudyn", "pymunk"))],
)
def test_the_force_on_a_prescribed_driver_is_that_of_the_closed_form(name):
    case = _swing("linear-motor", 0.0, 0.03)
    run = installed(name).run(case.scene(frozenset({Channel.TORQUE})), Setting.TUNED)
    assert run.outcome is Outcome.FINISHED, run.reason
    signal = run.history.torque
    true = channel_truth(case, Channel.TORQUE, "", signal.time)
    assert np.abs(signal.values - true).max() < FREE * np.abs(true).max()


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("sample", "start", "end"), [("linear-motor", 0.0, 0.03), ("cylinder-in-the-loop", 0.08, 0.11)]
)
@pytest.mark.parametrize("name", ENGINES)
def test_a_carried_guide_and_a_cylinder_between_moving_links_are_within_the_limits(name, sample, start, end):
    case = _swing(sample, start, end)
    assert case.mechanism.linkage.driver in installed(name).abilities.drivers
    result = judged(pickle.dumps(case), name, Setting.TUNED, (), True)
    outcomes = {record.quantity: record.outcome for record in (*result.errors, *result.invariants)}
    assert set(outcomes.values()) <= {"passed", "not-provided"}, outcomes
    assert outcomes["Mkr"] == outcomes["energy_balance"] == "passed"


# pymunk takes 33 000 steps at least, in each of which springs and forces over the travel call back.
SLOW = pytest.param("pymunk", "linear-motor", True, marks=pytest.mark.nightly)


@pytest.mark.parametrize(
    ("name", "sample", "timed"),
    [
        *((name, "linear-motor", True) for name in ENGINES if name != "pymunk"),
        *((name, "cylinder-in-the-loop", False) for name in ENGINES if name != "pymunk"),
        pytest.param("pymunk", "cylinder-in-the-loop", False, marks=pytest.mark.nightly),
        SLOW,
    ],
)
def test_a_released_driver_under_a_constant_force_moves_as_the_equation_of_motion_says(name, sample, timed):
    """The force is a number, or a law over time that stays the same."""
    engine, mechanism, (start, force, duration) = installed(name), driven(sample), RELEASED[sample]
    motion = free_motion(mechanism, torque=force, start_angle=start, start_speed=0.0, duration=duration)
    over_time = TimeLaw((0.0, duration), (force, force)) if timed else None
    case = Case(mechanism, motion, Free(0.0 if timed else force, duration, over_time=over_time))
    scene = case.scene(Channel)
    run = engine.run(scene, Setting.TUNED)
    if run.history is None:
        assert run.outcome is Outcome.UNSUPPORTED
        assert "drive" in run.reason or "crank" in run.reason
        return
    place, rate = run.history.position, run.history.velocity
    travel = travelled(scene, with_ground(place.values))[0]
    assert np.abs(travel - motion.angle(place.time)).max() < FREE * np.ptp(motion.angle(place.time))
    if np.array_equal(place.time, rate.time):
        speed = travelled(scene, with_ground(place.values), with_ground(rate.values))[1]
        assert np.abs(speed - motion.speed(rate.time)).max() < FREE * np.abs(motion.speed(rate.time)).max()
    for joint, signal in run.history.joint_force.items():
        true = channel_truth(case, Channel.JOINT_FORCE, joint, signal.time)
        seen = np.hypot(*true.T) if signal.values.ndim == 1 else true
        assert np.abs(signal.values - seen).max() < 10.0 * FREE * np.abs(true).max(), joint
