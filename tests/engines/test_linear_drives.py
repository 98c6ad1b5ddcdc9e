"""A slider of the ground and a cylinder as the driver: every engine is within its limits, prescribed and released."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import swing
from analytic.description.law import TimeLaw
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import free_motion
from comparisons.campaign.campaign import judged
from comparisons.conformance.samples import case as sample_case
from comparisons.reference.case import Case
from comparisons.reference.channels import truth
from engines.contract import Outcome, Setting
from engines.mechanics.driver import driven as travelled
from engines.mechanics.states import with_ground
from engines.registry import engine as engine_of
from engines.scene import Channel, Free
from tests.analytic.drives import driven

ENGINES = ["exudyn", "mujoco", "ondsel", "pymunk", "simbody"]
SAMPLES = ["driven slider", "cylinder"]  # of the conformance test; gravity alone, which every engine takes
LOADED = ["linear-motor", "cylinder-in-the-loop"]  # forces over the travel, springs, dampers, and a host that is driven
RELEASED = {"linear-motor": (0.02, 4.0, 0.12), "cylinder-in-the-loop": (0.08, 10.0, 0.1)}  # start, force, duration
FREE = 1e-4  # of the travel's reach


def _engine(name):
    engine = engine_of(name)
    if engine.version() is None:
        pytest.skip(f"{name} is not installed")
    return engine


def _within_limits(name, case):
    assert case.mechanism.linkage.driver in _engine(name).abilities.drivers
    case.check_motion()
    result = judged(pickle.dumps(case), name, Setting.TUNED, (), True)
    outcomes = {record.quantity: record.outcome for record in (*result.records, *result.invariants)}
    assert set(outcomes.values()) <= {"passed", "not-provided"}, outcomes
    assert outcomes["Mkr"] == outcomes["energy_balance"] == "passed"


@pytest.mark.parametrize("sample", SAMPLES)
@pytest.mark.parametrize("name", ENGINES)
def test_every_engine_is_within_its_limits(name, sample):
    _within_limits(name, sample_case(sample))


@pytest.mark.parametrize(
    ("sample", "start", "end"), [("linear-motor", 0.0, 0.03), ("cylinder-in-the-loop", 0.08, 0.11)]
)
@pytest.mark.parametrize("name", ENGINES)
def test_a_carried_guide_and_a_cylinder_between_moving_links_are_held_alike(name, sample, start, end):
    """Without their loads, so that every engine takes them."""
    linkage = replace(driven(sample).linkage, forces=(), springs=(), dampers=())
    _within_limits(name, Case(Mechanism(linkage), swing("cycloidal", start, end, time=0.25, regime="swing")))


@pytest.mark.parametrize(("sample", "timed"), [(LOADED[0], True), *((sample, False) for sample in LOADED)])
@pytest.mark.parametrize("name", ENGINES)
def test_a_released_driver_under_a_constant_force_moves_as_the_equation_of_motion_says(name, sample, timed):
    """The force is a number, or a law over time that stays the same."""
    engine, mechanism, (start, force, duration) = _engine(name), driven(sample), RELEASED[sample]
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
        true = truth(case, Channel.JOINT_FORCE, joint, signal.time)
        seen = np.hypot(*true.T) if signal.values.ndim == 1 else true
        assert np.abs(signal.values - seen).max() < 10.0 * FREE * np.abs(true).max(), joint
