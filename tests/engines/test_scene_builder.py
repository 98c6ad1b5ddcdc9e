"""The scene of a linkage: bodies that cannot turn do not, and joints have the names of the closed form."""

import math

import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.case import scene
from engines.mechanics.start_check import start_misfit
from engines.scene import Channel, Prescribed, is_pin_mass
from tests.analytic.linkages import FULL_TURN, mechanism

MOTION = crank_motion("constant-speed", start_angle=0.7)
EVERYTHING = frozenset(Channel)


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_a_body_that_cannot_turn_does_not_start_as_if_it_did(name, variant):
    model = scene(mechanism(name, variant), Prescribed(MOTION), EVERYTHING)
    straight = [body for body in model.bodies if body.inertia is None]
    assert all(body.angular_velocity == body.angular_acceleration == 0.0 for body in straight)
    assert all(math.hypot(*body.velocity) > 0.0 for body in straight)
    assert start_misfit(model) is None


def test_the_inertia_of_a_mass_in_a_slot_goes_to_the_slot():
    linkage = mechanism("slotted-takeup").linkage
    (slider,) = (slider for slider in linkage.sliders if is_pin_mass(linkage, slider))
    bodies = {body.name: body for body in scene(mechanism("slotted-takeup"), Prescribed(MOTION), EVERYTHING).bodies}
    host = linkage.links[slider.guide.host]
    assert bodies[slider.link].inertia is None
    assert bodies[slider.link].mass == linkage.links[slider.link].mass
    assert bodies[host.name].inertia == host.inertia + linkage.links[slider.link].inertia


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_joint_names_are_those_of_the_scene(name, variant):
    model = scene(mechanism(name, variant), Prescribed(MOTION), EVERYTHING)
    named = mechanism(name, variant).linkage.joint_names
    assert len(set(named)) == len(named)
    assert set(named) == {joint.name for joint in (*model.pins, *model.guided)}
