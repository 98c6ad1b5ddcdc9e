"""Nothing is built, recorded or worked out in an engine that its scene does not need: counted as it is made."""

import dataclasses
import sys
from collections import Counter

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.direct_adapter import solution
from engines.direct_adapter.adapter import DirectEngine
from engines.direct_adapter.equations import Equations
from engines.exudyn_adapter.adapter import ExudynEngine
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.scene import Channel, Prescribed
from tests.analytic.linkages import mechanism
from tests.counting import calls
from tests.engines.lighter import with_bare_slots, without_gravity, without_loads

MOTION = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02, start_angle=0.3)
EVERYTHING = frozenset(Channel)
NO_FORCES = EVERYTHING - {Channel.JOINT_FORCE}
KINEMATICS = frozenset({Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION})
JEQ = frozenset({Channel.VELOCITY})

SIX_BAR, LOADED, SPRUNG, SLOTTED = "rimoldi-164", "force-over-angle", "spring-and-damper", "slotted-takeup"


def _whole(linkage):
    return linkage


def _scene(name, channels=EVERYTHING, rest=_whole):
    return scene(Mechanism(rest(mechanism(name).linkage)), Prescribed(MOTION), channels)


def _finished(engine, model):
    run = engine.run(model, Setting.TUNED)
    assert run.outcome is Outcome.FINISHED, run.reason
    return run.history


def _slot_without_mass(linkage):
    return with_bare_slots(linkage, {"slot_slider"})


def _weightless_and_unloaded(linkage):
    return without_gravity(without_loads(linkage))


# -- exudyn ------------------------------------------------------------------------------------------------------------


@dataclasses.dataclass
class Built:
    """What an exudyn system holds when it is assembled."""

    objects: Counter
    loads: Counter
    markers: int
    sensors: int


def _built(mbs) -> Built:
    numbers = mbs.systemData
    return Built(
        Counter(mbs.GetObject(k)["objectType"] for k in range(numbers.NumberOfObjects())),
        Counter(mbs.GetLoad(k)["loadType"] for k in range(numbers.NumberOfLoads())),
        numbers.NumberOfMarkers(),
        numbers.NumberOfSensors(),
    )


@pytest.fixture
def build(monkeypatch):
    """Run a scene in exudyn and say what it was made of."""
    exudyn = pytest.importorskip("exudyn")
    systems, whole = [], exudyn.MainSystem.Assemble

    def assembling(mbs):
        systems.append(_built(mbs))
        return whole(mbs)

    monkeypatch.setattr(exudyn.MainSystem, "Assemble", assembling)

    def build(*arguments) -> Built:
        systems.clear()
        _finished(ExudynEngine(), _scene(*arguments))
        return systems[-1]

    return build


@pytest.mark.parametrize("name", [SIX_BAR, SLOTTED, "juki-mf7923d"])
def test_exudyn_builds_no_load_without_gravity_and_loads(build, name):
    bodies = len(mechanism(name).linkage.links)
    weighted, bare = build(name, JEQ, without_loads), build(name, JEQ, _weightless_and_unloaded)
    assert weighted.loads == {"MassProportional": bodies}
    assert not bare.loads
    assert weighted.markers - bare.markers == bodies
    assert weighted.objects == bare.objects


def test_exudyn_builds_no_spring_damper_or_force_where_the_scene_has_none(build):
    sprung, bare = build(SPRUNG, JEQ), build(SPRUNG, JEQ, without_loads)
    assert sprung.objects - bare.objects == {"ConnectorSpringDamper": 2, "ConnectorCoordinateSpringDamper": 2}
    loaded, bare = build(LOADED, JEQ), build(LOADED, JEQ, without_loads)
    assert loaded.loads - bare.loads == {"ForceVector": 2, "Coordinate": 2}
    assert loaded.objects == bare.objects


@pytest.mark.parametrize("name", [SIX_BAR, SLOTTED])
def test_exudyn_builds_a_body_per_link_and_a_joint_per_joint(build, name):
    model = _scene(name)
    objects = build(name, JEQ).objects
    assert objects["RigidBody2D"] == len(model.bodies)
    assert objects["JointRevolute2D"] == len(model.pins)
    assert objects["JointPrismatic2D"] == len(model.guided)
    assert objects["Ground"] == 1


def test_exudyn_builds_no_body_for_a_slot_without_a_slider(build):
    slotted, bare = build(SLOTTED, JEQ), build(SLOTTED, JEQ, _slot_without_mass)
    assert slotted.objects - bare.objects == {"RigidBody2D": 1, "JointRevolute2D": 1, "ConnectorCoordinate": 1}
    assert not bare.objects - slotted.objects


@pytest.mark.parametrize(
    ("channels", "per_body", "drive", "per_joint"),
    [
        (frozenset(), 0, 0, 0),
        (JEQ, 1, 0, 0),
        (KINEMATICS, 3, 0, 0),
        (frozenset({Channel.TORQUE}), 0, 1, 0),
        (NO_FORCES, 3, 1, 0),
        (EVERYTHING, 3, 1, 1),
    ],
)
def test_exudyn_has_a_sensor_for_what_is_asked_and_none_else(build, channels, per_body, drive, per_joint):
    model = _scene(SIX_BAR)
    joints = len(model.pins) + 2 * len(model.guided)  # the force of a guide comes with its body's angle
    assert build(SIX_BAR, channels).sensors == per_body * len(model.bodies) + drive + per_joint * joints


def test_exudyn_takes_no_more_steps_for_a_mass_in_a_slot_than_for_a_bare_pin():
    """The mass is told not to turn: started as if it did, it shook so that no step was ever short enough."""
    pytest.importorskip("exudyn")
    motion = crank_motion("constant-speed", ramp_time=0.1, hold_time=0.0)
    steps = []
    for rest in (_whole, _slot_without_mass):
        model = scene(Mechanism(rest(mechanism(SLOTTED).linkage)), Prescribed(motion), NO_FORCES)
        steps.append(ExudynEngine().run(model, Setting.TUNED).steps)
    assert steps[0] == steps[1] > 0


def _python_called_while_stepping(model) -> int:
    """Calls of Python functions from within exudyn's own solver."""
    inside, found = False, 0

    def watch(_frame, event, argument):
        nonlocal inside, found
        if event.startswith("c_") and getattr(argument, "__name__", "") == "SolveSystem":
            inside = event == "c_call"
        found += inside and event == "call"

    before = sys.getprofile()
    sys.setprofile(watch)
    try:
        _finished(ExudynEngine(), model)
    finally:
        sys.setprofile(before)
    return found


def test_exudyn_calls_back_only_for_loads_over_the_crank_angle():
    pytest.importorskip("exudyn")
    assert _python_called_while_stepping(_scene(LOADED)) > 0
    assert _python_called_while_stepping(_scene(LOADED, EVERYTHING, without_loads)) == 0
    assert _python_called_while_stepping(_scene(SPRUNG)) == 0
    assert _python_called_while_stepping(_scene(SIX_BAR)) == 0


# -- pymunk ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def worlds(monkeypatch):
    """Spaces of the latest run in pymunk, each with the kinds of what was added to it."""
    pymunk = pytest.importorskip("pymunk")
    found, whole = {}, pymunk.Space.add

    def adding(space, *objects):
        found.setdefault(space, Counter()).update(type(one).__name__ for one in objects)
        return whole(space, *objects)

    monkeypatch.setattr(pymunk.Space, "add", adding)

    def run(*arguments):
        found.clear()
        _finished(PymunkEngine(), _scene(*arguments))
        return dict(found)

    return run


def test_pymunk_builds_the_links_the_joints_and_one_drive(worlds):
    model = _scene(SIX_BAR)
    (added,) = worlds(SIX_BAR, JEQ).values()
    points = added["Body"] - len(model.bodies)  # of the bodies that turn about the ground
    assert points <= sum(GROUND in (pin.first, pin.second) for pin in model.pins)
    joints = {"PivotJoint": len(model.pins) + points, "GrooveJoint": 1, "SimpleMotor": 1}
    assert dict(added) == {"Body": len(model.bodies) + points} | joints


def test_pymunk_has_gravity_only_where_there_is_any(worlds):
    (space,) = worlds(SIX_BAR, JEQ)  # in units of its own
    assert space.gravity.normalized() == (0.0, -1.0)
    assert {tuple(space.gravity) for space in worlds(SIX_BAR, JEQ, without_gravity)} == {(0.0, 0.0)}


def test_pymunk_builds_no_spring_where_the_scene_has_neither_springs_nor_weights(worlds):
    (sprung,), (bare,) = (worlds(SPRUNG, JEQ, rest).values() for rest in (without_gravity, _weightless_and_unloaded))
    assert "DampedSpring" not in bare
    assert sprung - bare == {"DampedSpring": 2}


def test_pymunk_makes_no_more_of_a_slot_without_a_slider_than_of_one_with_it(worlds):
    """A groove is right only for a body centred on it, so pymunk has a part at the pin whatever the scene has there."""
    slotted, bare = (list(worlds(SLOTTED, JEQ, rest).values())[-1] for rest in (_whole, _slot_without_mass))
    assert bare == slotted


def test_pymunk_reads_no_more_than_the_channels_need(monkeypatch):
    looks = calls(monkeypatch, pytest.importorskip("engines.pymunk_adapter.loop"), "look")

    def count(channels):
        looks.clear()
        _finished(PymunkEngine(), _scene(SIX_BAR, channels))
        return len(looks)

    assert count(frozenset()) == count(frozenset({Channel.TORQUE, Channel.JOINT_FORCE})) == 0
    assert count(JEQ) > 0


# -- direct ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("channels", "taken"),
    [
        (frozenset(), (False, False, False, False)),
        (frozenset({Channel.POSITION}), (False, False, False, False)),
        (JEQ, (True, False, False, False)),
        (KINEMATICS, (True, True, False, False)),
        (NO_FORCES, (True, True, True, False)),
        (EVERYTHING, (True, True, True, True)),
    ],
)
def test_direct_solves_no_further_than_the_channels_need(monkeypatch, channels, taken):
    """Velocities, accelerations, loads, joint forces."""
    steps = calls(monkeypatch, solution, "transfer"), calls(monkeypatch, solution, "bends")
    steps += calls(monkeypatch, solution, "applied_loads"), calls(monkeypatch, Equations, "joint_forces")
    history = _finished(DirectEngine(), _scene(LOADED, channels))
    assert tuple(map(bool, steps)) == taken
    assert (history.position is not None) is (Channel.POSITION in channels)


def test_direct_has_equations_for_what_moves_alone():
    slotted, bare = (Equations(_scene(SLOTTED, rest=rest)) for rest in (_whole, _slot_without_mass))
    assert (slotted.size - bare.size, slotted.rows - bare.rows) == (2, 2)  # a mass at a pin has no angle
    bar = next(k for k, body in enumerate(bare.scene.bodies) if body.inertia is None)
    assert bare.column[bar, 2] == bare.size  # nor has what slides on the ground
    assert np.count_nonzero(bare.column[:-1] != bare.size) == bare.size
