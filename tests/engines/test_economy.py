"""Nothing is built, recorded or worked out in an engine that its scene does not need: counted as it is made."""

from collections import Counter

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from analytic.kinematics.mechanism import Mechanism
from engines.contract import Setting
from engines.direct_adapter import solution
from engines.direct_adapter.adapter import DirectEngine
from engines.direct_adapter.solution import Equations
from engines.exudyn_adapter.adapter import ExudynEngine
from engines.exudyn_adapter.model import ExudynModel
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.scene import Channel
from tests.analytic.linkages import mechanism
from tests.counting import calls
from tests.engines.closed_form import EVERYTHING, driven, history_of
from tests.engines.lighter import with_bare_slots, without_gravity, without_loads

MOTION = crank_motion("run-up-quintic", ramp_time=0.02, hold_time=0.01, start_angle=0.3)
NO_FORCES = EVERYTHING - {Channel.JOINT_FORCE}
KINEMATICS = NO_FORCES - {Channel.TORQUE}
JEQ = frozenset({Channel.VELOCITY})

SIX_BAR, LOADED, SPRUNG, SLOTTED = "rimoldi-164", "force-over-angle", "spring-and-damper", "slotted-takeup"


def _scene(name, channels=EVERYTHING, change=lambda linkage: linkage):
    return driven(Mechanism(change(mechanism(name).linkage)), MOTION, channels)


def _slot_without_mass(linkage):
    return with_bare_slots(linkage, {"slot_slider"})


def _weightless_and_unloaded(linkage):
    return without_gravity(without_loads(linkage))


# -- exudyn ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def build(monkeypatch):
    """Run a scene in exudyn and count, by type, what its system holds when it is assembled."""
    exudyn = pytest.importorskip("exudyn")
    systems, assemble = [], exudyn.MainSystem.Assemble

    def assembling(mbs):
        numbers = mbs.systemData
        parts = Counter(mbs.GetObject(k)["objectType"] for k in range(numbers.NumberOfObjects()))
        parts.update(mbs.GetLoad(k)["loadType"] for k in range(numbers.NumberOfLoads()))
        systems.append(parts + Counter(sensors=numbers.NumberOfSensors()))
        return assemble(mbs)

    monkeypatch.setattr(exudyn.MainSystem, "Assemble", assembling)

    def build(*arguments):
        systems.clear()
        history_of(ExudynEngine(), _scene(*arguments))
        return systems[-1]

    return build


@pytest.mark.parametrize(
    ("name", "more", "less", "parts"),
    [
        (SIX_BAR, without_loads, _weightless_and_unloaded, {"MassProportional": 5}),
        (
            SPRUNG,
            lambda whole: whole,
            without_loads,
            {"ConnectorSpringDamper": 2, "ConnectorCoordinateSpringDamper": 2},
        ),
        (LOADED, lambda whole: whole, without_loads, {"ForceVector": 2, "Coordinate": 2}),
    ],
)
def test_exudyn_builds_a_load_for_every_load_of_the_scene_and_none_else(build, name, more, less, parts):
    assert build(name, JEQ, more) - build(name, JEQ, less) == parts
    assert not build(name, JEQ, _weightless_and_unloaded).keys() & {*parts}


@pytest.mark.parametrize(
    ("channels", "per_body", "drive", "per_joint"),
    [(frozenset(), 0, 0, 0), (KINEMATICS, 3, 0, 0), (frozenset({Channel.TORQUE}), 0, 1, 0), (EVERYTHING, 3, 1, 1)],
)
def test_exudyn_has_a_sensor_for_every_requested_channel_and_none_else(build, channels, per_body, drive, per_joint):
    model = _scene(SIX_BAR)
    joints = len(model.pins) + 2 * len(model.guided)  # the force of a guide comes with its body's angle
    assert build(SIX_BAR, channels)["sensors"] == per_body * len(model.bodies) + drive + per_joint * joints


def test_exudyn_takes_no_more_steps_for_a_mass_in_a_slot_than_for_a_bare_pin():
    """The mass cannot turn: started as if it did, it shook so that no step was ever short enough."""
    pytest.importorskip("exudyn")
    scenes = (_scene(SLOTTED, NO_FORCES), _scene(SLOTTED, NO_FORCES, _slot_without_mass))
    steps = [ExudynEngine().run(model, Setting.TUNED).steps for model in scenes]
    assert steps[0] == steps[1] > 0


def test_exudyn_is_given_functions_of_ours_only_for_loads_over_the_crank_angle():
    for name, change, is_called in ((LOADED, lambda whole: whole, True), (LOADED, without_loads, False)):
        assert any(law for *_, law in ExudynModel(_scene(name, change=change)).as_data()["items"]) == is_called


# -- pymunk ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def spaces(monkeypatch):
    """Spaces of the latest run in pymunk, each with the kinds of what was added to it."""
    pymunk = pytest.importorskip("pymunk")
    found, add = {}, pymunk.Space.add

    def adding(space, *objects):
        found.setdefault(space, Counter()).update(type(each).__name__ for each in objects)
        return add(space, *objects)

    monkeypatch.setattr(pymunk.Space, "add", adding)

    def run(*arguments):
        found.clear()
        history_of(PymunkEngine(), _scene(*arguments))
        return dict(found)

    return run


def test_pymunk_builds_the_links_the_joints_and_one_drive(spaces):
    model = _scene(SIX_BAR)
    ((space, added),) = spaces(SIX_BAR, JEQ).items()
    points = added["Body"] - len(model.bodies)  # of the bodies that turn about the ground
    assert points <= sum(GROUND in (pin.first, pin.second) for pin in model.pins)
    joints = {"PivotJoint": len(model.pins) + points, "GrooveJoint": 1, "SimpleMotor": 1}
    assert dict(added) == {"Body": len(model.bodies) + points} | joints
    assert space.gravity.normalized() == (0.0, -1.0)  # in units of its own
    assert {tuple(space.gravity) for space in spaces(SIX_BAR, JEQ, without_gravity)} == {(0.0, 0.0)}


def test_pymunk_reads_states_only_where_a_channel_needs_them(monkeypatch):
    looks = calls(monkeypatch, pytest.importorskip("engines.pymunk_adapter.loop"), "body_states")
    history_of(PymunkEngine(), _scene(SIX_BAR, frozenset({Channel.TORQUE, Channel.JOINT_FORCE})))
    assert len(looks) == 0
    history_of(PymunkEngine(), _scene(SIX_BAR, JEQ))
    assert len(looks) > 0


# -- direct ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("channels", "taken"),
    [
        (frozenset({Channel.POSITION}), (False, False, False, False)),
        (JEQ, (True, False, False, False)),
        (KINEMATICS, (True, True, False, False)),
        (NO_FORCES, (True, True, True, False)),
        (EVERYTHING, (True, True, True, True)),
    ],
)
def test_direct_solves_no_further_than_the_channels_need(monkeypatch, channels, taken):
    """Velocities, accelerations, loads, joint forces."""
    steps = calls(monkeypatch, solution, "transfer"), calls(monkeypatch, solution, "velocity_terms")
    steps += calls(monkeypatch, solution, "applied_loads"), calls(monkeypatch, Equations, "joint_forces")
    history_of(DirectEngine(), _scene(LOADED, channels))
    assert tuple(map(bool, steps)) == taken


def test_direct_has_equations_for_what_moves_alone():
    slotted, bare = Equations(_scene(SLOTTED)), Equations(_scene(SLOTTED, change=_slot_without_mass))
    assert (slotted.size - bare.size, slotted.rows - bare.rows) == (2, 2)  # a mass at a pin has no angle
    bar = next(k for k, body in enumerate(bare.scene.bodies) if body.inertia is None)
    assert bare.column[bar, 2] == bare.size  # nor has what slides on the ground
