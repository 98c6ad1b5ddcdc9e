"""Friction of pins and guides by the forces of the frictional equilibrium itself, and where it locks a linkage."""

from math import asin, degrees

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import parse
from analytic.dynamics.friction import contacts, reactions
from analytic.dynamics.reduced import equation_of_motion, near_load_jumps
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import evaluate
from comparisons.motion.case import Case
from engines.contract import Setting
from engines.mechanics.start_check import ability_obstacle
from engines.registry import engine
from engines.scene import Channel
from tests.analytic.drawn_linkages import draw
from tests.analytic.fifty_digits import errors_at
from tests.analytic.linkages import PENDULUM, file_text, text_of
from tests.engines.closed_form import installed

PHI, SPEED = np.linspace(0.1, 6.3, 91), 7.0


def rubbing(number):
    """A random linkage with friction in every joint, as a file."""
    text = draw(number).text
    linkage, random = parse(text, "drawn", "drawn"), np.random.default_rng(number)
    size = linkage.links["crank"].points["A"][0]
    radii = size * random.uniform(0.02, 0.1, len(linkage.pins))
    pins = zip(linkage.pins, radii, strict=True)
    tables = [f"{pin.point} = {{ radius = {radius}, coefficient = 0.12 }}" for pin, radius in pins]
    tables += [f"{slider.link} = {{ coefficient = 0.1 }}" for slider in linkage.sliders]
    tables += [f"'{slot.name}' = {{ coefficient = 0.1 }}" for slot in linkage.slots]
    return f"friction = {{ {', '.join(tables)} }}\n{text}"


@pytest.mark.parametrize(
    "number", [5, 10, *(pytest.param(n, marks=pytest.mark.nightly) for n in (2, 4, 7, 8, 11, *range(20, 26)))]
)
def test_torque_and_forces_are_those_of_a_fixed_point_in_fifty_digits(number):
    sample, speed = Mechanism(parse(rubbing(number), "drawn", "drawn")), SPEED * (-1) ** number
    assert max(errors_at(sample, PHI, number, speed).values()) < 1e-13


def test_strong_friction_is_followed_from_weak_friction_on():
    """Newton's method alone goes astray at one angle; friction takes what the joints take by their own forces."""
    text = rubbing(9).replace("= 0.12 }", "= 4.8 }").replace("= 0.1 }", "= 4 }")
    sweep = Mechanism(parse(text, "strong", "strong")).sweep(PHI)
    found = reactions(sweep, SPEED, 0.0)
    power = [joint.size * np.hypot(*found.forces[joint.joint]) * np.abs(joint.rate) for joint in contacts(sweep)]
    assert found.friction == pytest.approx(np.sum(power, axis=0), rel=1e-9)


def test_a_pivot_resists_by_its_radius_and_the_weight_on_it():
    """Of a crank at rest, 2 kg at 0.5 m: M = 19.62 N · (0.5 m cos φ ± μ r), both values at which it breaks away."""
    held = Mechanism(parse(f"friction = {{ O = {{ radius = 0.03, coefficient = 0.2 }} }}\n{PENDULUM}", "x", "x"))
    sweep = held.sweep(PHI)
    for rest, sign in ((0.0, 1.0), (-0.0, -1.0)):
        found = reactions(sweep, rest, 0.0)
        assert found.torque == pytest.approx(19.62 * (0.5 * np.cos(PHI) + sign * 0.2 * 0.03), rel=1e-13)
        assert found.friction == pytest.approx(np.full(PHI.shape, sign * 19.62 * 0.2 * 0.03), rel=1e-13)


LOCKED = file_text("locking-slider-crank")


def test_a_self_locking_position_is_named_with_its_angle():
    """The rod pulls the ram against its load up to tan β = 1/μ, sin β = (30 + 50 sin φ)/100."""
    locks = degrees(asin((100.0 * np.sqrt(0.5) - 30.0) / 50.0))
    sample = Mechanism(parse(LOCKED, "locked", "locked"))
    torque = evaluate(sample, np.radians([locks - 0.01, locks - 0.001]), ["Mkr"], speed=1.0)["Mkr"]
    assert torque[1] / torque[0] == pytest.approx(10.0, rel=1e-2)  # as 1/(1 − μ tan β)
    places = np.arange(np.floor(locks), 90.0)
    with pytest.raises(LinkproofError, match=f"'locked' is self-locking at crank angle {places[1]:g}°"):
        evaluate(sample, np.radians(places), ["Mkr"], speed=1.0)


def test_forces_have_two_values_where_the_ram_turns_back():
    """There crank and rod are on one line, 100 ± 50 mm long, that ends 30 mm below the pivot."""
    places = np.array([-asin(30.0 / 150.0), np.pi - asin(30.0 / 50.0)])
    sample = Mechanism(parse(LOCKED, "locked", "locked"))
    assert near_load_jumps(sample, np.append(places, places + 1e-3)).tolist() == [True, True, False, False]


@pytest.mark.parametrize(
    ("name", "limit"), [("direct", 1e-13), pytest.param("mujoco", 1e-8, marks=pytest.mark.nightly)]
)
def test_engines_that_take_friction_find_the_same_from_rest_on(name, limit):
    joints = "D = { radius = 9, coefficient = 0.2 }, ram = { coefficient = 0.1 }"
    table = f"friction = {{ O = {{ radius = 8, coefficient = 0.1 }}, {joints} }}"
    motion = crank_motion("run-up-quintic", ramp_time=0.03, hold_time=0.06, start_angle=0.1)
    case = Case(Mechanism(parse(f"{table}\n{text_of('laden-press')}", "press", "press")), motion)
    found = installed(name).run(case.scene(frozenset(Channel)), Setting.TUNED).history.torque
    true = evaluate(case.mechanism, motion.angle(found.time), ["Mkr"], speed=motion.speed(found.time),
                    acceleration=motion.acceleration(found.time))["Mkr"]  # fmt: skip
    assert np.max(np.abs(found.values - true)) <= limit * np.max(np.abs(true))
    words = "it takes no friction that follows the force of its joint, as 'D' has"
    assert ability_obstacle(case.scene(frozenset(Channel)), engine("exudyn").abilities) == words


def test_a_released_crank_with_friction_is_refused():
    with pytest.raises(LinkproofError, match="expected joints without friction, got some with it"):
        equation_of_motion(
            Mechanism(
                parse(LOCKED.replace("links.crank.points", "links.crank.inertia = 1\nlinks.crank.points"), "x", "x")
            )
        )
