"""The check of a start state: true ones pass at any angle in any linkage, a slip in any joint is found."""

import dataclasses

import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.motion.case import scene
from engines.contract import Abilities
from engines.mechanics.start_check import ability_obstacle, data_obstacle, misfits, start_misfit
from engines.mechanics.states import start_motion
from engines.scene import (
    AppliedForce,
    AppliedTorque,
    Free,
    PointSpring,
    Prescribed,
    SliderJoint,
    SlotJoint,
    TurnDamper,
)
from tests.analytic.linkages import EVERY, mechanism
from tests.engines.closed_form import with_body

SLIP = 1e-3  # of whatever is changed


def _scene(name, variant=None):
    return scene(mechanism(name, variant), Prescribed(crank_motion("constant-speed", start_angle=0.3)), ())


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_a_true_start_fits_in_position_velocity_and_acceleration(name, variant):
    model = _scene(name, variant)
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


def _with(part, **changes):
    """A scene with its first part of a kind changed."""
    return lambda model: dataclasses.replace(
        model, **{part: (dataclasses.replace(getattr(model, part)[0], **changes), *getattr(model, part)[1:])}
    )


NAN, INFINITE = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        # Each of these ends a process where an engine gets it, or runs on as nonsense.
        *(("juki-mf7923d", _with("bodies", mass=mass), f"mass {mass:g} kg") for mass in (0.0, -1.0, NAN, INFINITE)),
        ("juki-mf7923d", _with("bodies", inertia=NAN), "inertia nan kg m²; expected a finite positive one"),
        ("juki-mf7923d", _with("bodies", position=(NAN, 0.0)), "body 'coupler' has a number that is not finite"),
        ("juki-mf7923d", _with("bodies", position=(0.001, 0.02)), "in position; give one that fits every joint"),
        ("juki-mf7923d", _with("bodies", velocity=(0.1, 0.0)), "in velocity; give one that fits every joint"),
        ("juki-mf7923d", _with("bodies", name="crank"), "the bodies' names are not distinct: crank, crank, needle_bar"),
        ("juki-mf7923d", lambda model: with_body(model, "crank", inertia=None), "the crank 'crank' has no inertia"),
        ("juki-mf7923d", _with("pins", first="nobody"), "names a body 'nobody' that is not in the scene"),
        ("juki-mf7923d", _with("sliders", along=(0.0, 0.0)), "has a line without a direction"),
        ("juki-mf7923d", lambda model: dataclasses.replace(model, pins=model.pins[:1]), "is not pinned to the ground"),
        ("juki-mf7923d", lambda model: dataclasses.replace(model, gravity=(NAN, 0.0)), "gravity is not finite"),
        ("juki-mf7923d", lambda model: dataclasses.replace(model, drive=Free(0.1, 0.0)), "a duration that is not"),
        ("carried-slider", lambda model: with_body(model, "slider", inertia=None), "and so needs an inertia"),
        ("spring-and-damper", _with("springs", stiffness=-1.0), "has a number that is negative"),
        ("spring-and-damper", _with("dampers", coefficient=-1.0), "has a coefficient of -1"),
    ],
)
def test_data_that_no_engine_may_get_are_named_in_one_sentence(name, change, words):
    assert data_obstacle(_scene(name), massless=False) is None
    assert words in (data_obstacle(change(_scene(name)), massless=False) or "")


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
        ("juki-mf7923d", {"joints": frozenset({SlotJoint})}, "it has no slider joint, which slider joint 'needle_bar"),
        ("scotch-yoke", {"joints": frozenset({SliderJoint})}, "it has no slot joint, which slot joint 'A in yoke'"),
        ("slotted-takeup", {"loads": ALL.loads - {TurnDamper}}, "it has no turn damper, which turn damper on 'crank'"),
        ("spring-and-damper", {"loads": ALL.loads - {PointSpring}}, "it has no point spring, which point spring on"),
        ("force-over-angle", {"loads": ALL.loads - {AppliedForce}}, "it has no applied force, which applied force on"),
        ("force-over-angle", {"varying_loads": False}, "it takes no load that changes with the crank angle, as"),
    ],
)
def test_what_goes_beyond_an_engines_abilities_is_said_in_one_sentence(name, less, reason):
    model = _scene(name)
    assert ability_obstacle(model, ALL) is None
    assert (ability_obstacle(model, dataclasses.replace(ALL, **less)) or "").startswith(reason)
