"""Where both can be had, Radau's method and the closed form's own integration are one motion."""

import numpy as np
import pytest

from analytic.description.linkage import ReleasedRegime
from analytic.dynamics.reduced import damping_coefficient
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import FreeMotion
from comparisons.reference.case import own_motion
from comparisons.stress import scenes
from comparisons.stress.scenes import Conditions, case, linkage
from comparisons.stress.stiff_motion import MOST_RELAXATIONS, StiffMotion, relaxations, stiff_motion


def damped(factor, turns=0.5):
    return Conditions(
        "sprung-crank-rocker", motion="released", start_angle=60.0, spinning=False, turns=turns, torque=0.2,
        load="dampers", load_factor=factor,
    )  # fmt: skip


@pytest.mark.parametrize("factor", [100.0, 1000.0])
def test_both_integrations_are_one_motion(factor):
    mechanism = Mechanism(linkage(damped(factor)))
    own = ReleasedRegime("driven", 0.2, np.pi / 3.0, 0.0, 0.03)
    stiff, exact = stiff_motion(mechanism, own), own_motion(mechanism, own)
    time = np.linspace(0.0, 0.03, 501)
    assert np.max(np.abs(stiff.angle(time) - exact.angle(time))) < 1e-10
    assert np.max(np.abs(stiff.speed(time) - exact.speed(time))) < 1e-9 * exact.peak_speed
    assert stiff.peak_speed == pytest.approx(exact.peak_speed, rel=1e-2)
    assert stiff.speed(0.01).shape == ()


def test_the_slow_motion_under_a_stiff_damper_is_torque_over_damping():
    """Inertia is forgotten at once: ω = (M + Q) / b from the first millisecond on."""
    one = case(damped(1e8))
    assert isinstance(one.motion, StiffMotion)
    time = np.linspace(1e-3, one.motion.duration, 50)
    sweep = one.mechanism.sweep(one.motion.angle(time))
    equation = one.motion.equation
    push = equation.terms(one.motion.angle(time))
    np.testing.assert_allclose(one.motion.speed(time), push[0] / push[1], rtol=1e-6)
    assert np.all(damping_coefficient(sweep) > 0.0)


def test_the_closed_forms_own_integration_is_taken_as_long_as_it_is_cheap():
    assert isinstance(case(damped(1.0)).motion, FreeMotion)
    soft, hard = (Mechanism(linkage(damped(factor))) for factor in (1.0, 1e6))
    assert relaxations(soft, 0.03) < MOST_RELAXATIONS < relaxations(hard, 0.03)
    assert relaxations(hard, 0.06) == pytest.approx(2.0 * relaxations(hard, 0.03))
    assert scenes.MOST_RELAXATIONS == MOST_RELAXATIONS
