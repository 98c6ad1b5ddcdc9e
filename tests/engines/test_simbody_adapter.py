"""What Simbody alone has: loops on moving bodies, steps that it divides, masses on pins that carry a body."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from engines.contract import Setting
from engines.scene import PinJoint
from engines.simbody_adapter import SimbodyEngine
from tests.analytic.linkages import file_text, from_text, mechanism
from tests.engines.closed_form import driven, errors_of, history_of, run_of, torque_error

pytest.importorskip("opensim")

ENGINE = SimbodyEngine()
# Its second loop is closed between bodies that the crank carries: there Simbody tells forces in the axes of the crank.
ON_THE_CRANK = file_text("dyad-on-the-crank")


def test_forces_of_a_loop_on_moving_bodies_are_those_of_the_closed_form():
    linkage, motion = from_text(ON_THE_CRANK), crank_motion("run-up", ramp_time=0.06, hold_time=0.02, start_angle=0.3)
    assert max(errors_of(run_of(ENGINE, linkage, motion, Setting.TUNED), linkage, motion).values()) < 1e-9


@pytest.mark.parametrize(
    ("name", "motion", "limit"),
    [
        # near-toggle: steps of this length must be divided
        ("near-toggle", crank_motion("run-up", ramp_time=0.06, hold_time=0.02, start_angle=0.3), 1e-6),
        ("rimoldi-164", crank_motion("run-up-quintic", speed=1e5, ramp_time=6e-4, hold_time=1e-4), 1e-8),
    ],
)
def test_sharp_linkages_and_fast_cranks_follow_the_closed_form(name, motion, limit):
    linkage = mechanism(name)
    assert torque_error(run_of(ENGINE, linkage, motion, Setting.TUNED), linkage, motion) < limit


def test_a_mass_on_a_pin_may_carry_another_body():
    linkage, motion = mechanism("slotted-takeup"), crank_motion("constant-speed", ramp_time=0.06, hold_time=0.0)
    given = driven(linkage, motion)
    (on_pin,) = (pin for pin in given.pins if "slot_slider" in (pin.first, pin.second))
    coupler = next(body for body in given.bodies if body.name == "coupler")
    anchor = on_pin.second_anchor if on_pin.second == "coupler" else on_pin.first_anchor
    # A wheel on the same pin, balanced and at rest: the mass on the pin carries it, and it moves as the pin does.
    cosine, sine = np.cos(coupler.angle), np.sin(coupler.angle)
    place = tuple(coupler.position + np.array([[cosine, -sine], [sine, cosine]]) @ anchor)
    slider = next(body for body in given.bodies if body.name == "slot_slider")
    assert place == pytest.approx(slider.position, abs=1e-12)
    wheel = dataclasses.replace(slider, name="wheel", mass=0.01, inertia=1e-6, angle=0.2)
    joint = PinJoint("wheel", "wheel", "slot_slider", (0.0, 0.0), (0.0, 0.0))
    model = dataclasses.replace(given, bodies=(*given.bodies, wheel), pins=(*given.pins, joint))
    history = history_of(ENGINE, model)
    names = [*(body.name for body in given.bodies), "wheel"]
    at = {name: history.position.values[:, names.index(name)] for name in ("wheel", "slot_slider")}
    np.testing.assert_allclose(at["wheel"][:, :2], at["slot_slider"][:, :2], atol=1e-12)
    np.testing.assert_allclose(at["wheel"][:, 2], 0.2, atol=1e-6)  # nothing turns it
    np.testing.assert_allclose(at["slot_slider"][:, 2], slider.angle, atol=1e-12)
    acceleration = history.acceleration.values[:, names.index("wheel"), :2]
    weight = acceleration - given.gravity
    np.testing.assert_allclose(history.joint_force["wheel"].values, 0.01 * weight, atol=1e-8 * np.abs(weight).max())
