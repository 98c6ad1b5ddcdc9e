"""The check of a start state: true ones pass at any angle in any linkage, a slip in any joint is found."""

import dataclasses

import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.reference.start_state import scene
from engines.contract import Abilities
from engines.mechanics.start_check import ability_obstacle, misfits, start_misfit
from engines.mechanics.states import start_motion
from engines.scene import AppliedForce, AppliedTorque, Free, PointSpring, Prescribed, SliderJoint, SlotJoint, TurnDamper
from tests.analytic.linkages import EVERY, mechanism

SLIP = 1e-3  # of whatever is changed
ANGLES = (0.3, 1.9, 4.4)


def _scene(name, variant=None, angle=0.3):
    return scene(mechanism(name, variant), Prescribed(crank_motion("constant-speed", start_angle=angle)), ())


@pytest.mark.parametrize(("name", "variant"), EVERY)
@pytest.mark.parametrize("angle", ANGLES)
def test_a_true_start_fits_in_position_velocity_and_acceleration(name, variant, angle):
    model = _scene(name, variant, angle)
    assert start_misfit(model) is None
    orders = {miss.order for miss in misfits(model, *start_motion(model))}
    assert orders == {0, 1, 2}


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(
    ("name", "body", "joint"),
    [
        ("juki-mf7923d", "needle_bar", "needle_bar on ground"),
        ("carried-slider", "slider", "slider on rocker"),
        ("scotch-yoke", "yoke", "yoke on ground"),
        ("ground-pin-in-slot", "coupler", "G in coupler"),
    ],
)
def test_a_slip_in_any_kind_of_joint_is_found(name, body, joint, order):
    model = _scene(name)
    field = ("position", "velocity", "acceleration")[order]
    bodies = []
    for item in model.bodies:
        x, y = getattr(item, field)
        change = (1.0 + abs(x) + abs(y)) * SLIP
        bodies.append(dataclasses.replace(item, **{field: (x + change, y + change)}) if item.name == body else item)
    broken = dataclasses.replace(model, bodies=tuple(bodies))
    assert field in (start_misfit(broken) or "")
    before = {(m.joint, m.order): m.size for m in misfits(model, *start_motion(model))}
    grown = {
        m.joint for m in misfits(broken, *start_motion(broken)) if m.size > 2.0 * before[m.joint, m.order] + SLIP / 2
    }
    assert joint in grown


def test_a_slider_that_turns_against_its_host_is_found():
    model = _scene("carried-slider")
    turned = tuple(
        dataclasses.replace(b, angular_velocity=b.angular_velocity + 1.0) if b.name == "slider" else b
        for b in model.bodies
    )
    assert "in velocity" in (start_misfit(dataclasses.replace(model, bodies=turned)) or "")


ALL = Abilities(
    {},
    drives=frozenset({Prescribed, Free}),
    joints=frozenset({SliderJoint, SlotJoint}),
    loads=frozenset({AppliedForce, AppliedTorque, PointSpring, TurnDamper}),
)


@pytest.mark.parametrize(
    ("name", "less", "reason"),
    [
        ("juki-mf7923d", {"drives": frozenset({Free})}, "it takes no prescribed drive"),
        (
            "juki-mf7923d",
            {"joints": frozenset({SlotJoint})},
            "it has no slider joint, which slider joint 'needle_bar on",
        ),
        ("scotch-yoke", {"joints": frozenset({SliderJoint})}, "it has no slot joint, which slot joint 'A in yoke'"),
        (
            "slotted-takeup",
            {"loads": ALL.loads - {TurnDamper}},
            "it has no turn damper, which turn damper on 'crank' and",
        ),
        ("spring-and-damper", {"loads": ALL.loads - {PointSpring}}, "it has no point spring, which point spring on"),
        ("force-over-angle", {"loads": ALL.loads - {AppliedForce}}, "it has no applied force, which applied force on"),
        (
            "force-over-angle",
            {"varying_loads": False},
            "it takes no load that changes with the crank angle, as applied",
        ),
    ],
)
def test_what_goes_beyond_an_engines_abilities_is_said_in_one_sentence(name, less, reason):
    model = _scene(name)
    assert ability_obstacle(model, ALL) is None
    assert (ability_obstacle(model, dataclasses.replace(ALL, **less)) or "").startswith(reason)
