"""The compiled integration of a released crank: against NumPy, exact solutions and conservation; its way back."""

import dataclasses
import math

import numpy as np
import pytest
from analytic.compiled import choice
from analytic.compiled import motion as compiled_motion
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ellipj, ellipk

from analytic.description.law import Law
from analytic.description.loading import catalogue, load
from analytic.dynamics.equation_of_motion import equation_of_motion
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.energy import energy_imbalance
from analytic.motion.released import free_motion
from analytic.numerics import integration
from tests.analytic.linkages import from_text, mechanism
from tests.analytic.motion.test_released import (
    AFTER_A_DWELL,
    BALANCE,
    DENSE,
    EXACT,
    HALF_STEP,
    LOOSE,
    SLOTTED_DRIVEN,
    SLOTTED_FREE,
)
from tests.analytic.textbook import DOUBLE_ROCKER, PENDULUM, PENDULUM_RATE, ROTOR

pytest.importorskip("numba")

OWN = [(name, own) for name in catalogue() for own in load(name).regimes]
# rad. Two integrations of a short motion, each to the tightest tolerance.
SHORT = 1e-11
# A loose tolerance is one of speed, and adds up over the windows.
PILED_UP = 1e3


def _both(sample, **how):
    return [free_motion(sample, path=path, **how) for path in ("numpy", "compiled")]


def _difference(one, two):
    time = np.linspace(0.0, one.duration, 4001)
    return float(np.max(np.abs(one.angle(time) - two.angle(time))))


@pytest.mark.parametrize(("name", "own"), OWN, ids=[f"{name}-{own.name}" for name, own in OWN])
def test_own_regimes_agree_with_numpy_within_both_bounds(name, own):
    keys = ("torque", "start_angle", "start_speed", "duration")
    plain, quick = _both(mechanism(name), **{key: getattr(own, key) for key in keys})
    assert (plain.path, quick.path) == ("numpy", "compiled")
    assert _difference(plain, quick) <= plain.error_bound + quick.error_bound
    assert energy_imbalance(quick) < BALANCE


@settings(max_examples=25)
@given(
    name=st.sampled_from([*catalogue(), "spring-and-damper", "force-over-angle", "carried-slider", "scotch-yoke"]),
    angle=st.floats(-10.0, 10.0),
    speed=st.floats(-60.0, 60.0),
    torque=st.floats(-0.2, 0.2),
)
def test_any_start_agrees_with_numpy(name, angle, speed, torque):
    plain, quick = _both(mechanism(name), start_angle=angle, start_speed=speed, torque=torque, duration=0.1)
    assert quick.path == "compiled"
    assert _difference(plain, quick) < SHORT * max(1.0, plain.peak_speed)


@pytest.mark.parametrize("name", [*catalogue(), "force-over-angle"])
def test_the_table_and_the_linkage_s_own_kernels_are_one_equation(name):
    """Backwards, over the table's edges; the crank's torque is a load in the one, and in the other's table."""
    equation = equation_of_motion(mechanism(name), 0.02)
    plain, tabled = (
        compiled_motion.integrate(each, (0.4, -60.0), 0.3, tolerance=1e-12, rounding=2e-14 * equation.peak_moment)
        for each in (equation, equation.tabulated())
    )
    time = np.linspace(0.0, 0.3, 301)
    assert np.ptp(tabled.angle_at(time)) > 2.0 * math.pi
    assert np.max(np.abs(plain.angle_at(time) - tabled.angle_at(time))) < SHORT * max(
        1.0, np.ptp(tabled.angle_at(time))
    )


@pytest.mark.parametrize("name", catalogue())
def test_energy_is_conserved_without_damping(name):
    linkage = dataclasses.replace(load(name), dampers=(), springs=())
    motion = free_motion(Mechanism(linkage), start_angle=0.5, start_speed=20.0, duration=2.0, path="compiled")
    assert motion.path == "compiled"
    assert energy_imbalance(motion) < BALANCE


def test_a_crank_torque_over_the_angle():
    torque = Law(np.array([[0.1], [-0.02], [0.05], [0.0]]), np.array([0.2, 1.9, 3.3, 5.0]))
    plain, quick = _both(mechanism("juki-mf7923d"), torque=torque, start_angle=-2.0, start_speed=5.0, duration=0.2)
    assert quick.path == "compiled"
    assert quick.regime == "driven"
    assert _difference(plain, quick) < SHORT
    assert energy_imbalance(quick) < BALANCE


@pytest.mark.parametrize("released", [0.5, 3.1])
def test_pendulum_swings_as_the_elliptic_functions_say(released):
    motion = free_motion(from_text(PENDULUM), start_angle=released - 0.5 * math.pi, duration=8.0, path="compiled")
    time, modulus = np.linspace(0.0, 8.0, 301), math.sin(0.5 * released) ** 2
    sn, *_ = ellipj(float(ellipk(modulus)) - PENDULUM_RATE * time, modulus)
    assert np.max(np.abs(motion.angle(time) + 0.5 * math.pi - 2.0 * np.arcsin(math.sin(0.5 * released) * sn))) < (
        AFTER_A_DWELL
    )


def test_rotor_under_torque_and_damping():
    motion = free_motion(from_text(ROTOR), torque=0.3, start_speed=-4.0, duration=20.0, path="compiled")
    time, rate = np.linspace(0.0, 20.0, 101), 0.05 / 0.1
    left = (-4.0 - 6.0) * np.exp(-rate * time)  # of the steady speed 0.3/0.05
    assert motion.path == "compiled"
    assert motion.speed(time) == pytest.approx(6.0 + left, rel=EXACT, abs=EXACT)


def test_rest_at_a_place_without_moment_stays_rest():
    still = Mechanism(dataclasses.replace(from_text(ROTOR).linkage, dampers=()))
    motion = free_motion(still, start_angle=1.25, duration=3.0, path="compiled")
    assert motion.path == "compiled"
    assert np.all(motion.angle(np.linspace(0.0, 3.0, 7)) == 1.25)


def test_a_crank_that_only_swings():
    plain, quick = _both(from_text(DOUBLE_ROCKER), start_angle=math.radians(60), duration=0.5)
    assert quick.path == "compiled"
    assert _difference(plain, quick) < SHORT


@pytest.mark.parametrize("tolerance", LOOSE)
def test_a_loose_tolerance_takes_fewer_windows_and_keeps_its_word(tolerance):
    sample = mechanism("slotted-takeup")
    rough = free_motion(sample, **SLOTTED_FREE, tolerance=tolerance, path="compiled")
    fine = free_motion(sample, **SLOTTED_FREE, path="compiled")
    assert len(rough.windows.base) < len(fine.windows.base)
    assert _difference(rough, fine) < PILED_UP * tolerance


def test_windows_join_and_end_at_the_duration():
    windows = free_motion(mechanism("slotted-takeup"), **SLOTTED_FREE, path="compiled").windows
    joints = windows.starts[1:-1]
    before, after = np.nextafter(joints, 0.0), joints
    assert windows.starts[-1] == SLOTTED_FREE["duration"]
    assert windows.angle_at(before) == pytest.approx(windows.angle_at(after), abs=EXACT)
    assert windows.speed_at(before) == pytest.approx(windows.speed_at(after), abs=EXACT)


def _sentence(sample, path, **how):
    with pytest.raises(LinkproofError) as caught:
        free_motion(sample, path=path, **how)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "how"),
    [
        (
            DOUBLE_ROCKER,
            {"start_angle": math.radians(60), "start_speed": 25.0, "duration": 3.0},
        ),  # into a dead position
        (DOUBLE_ROCKER, {"start_angle": math.pi, "duration": 1.0}),  # cannot be assembled
        (PENDULUM, {"duration": -1.0}),
        (PENDULUM, {"start_speed": math.inf, "duration": 1.0}),
        (PENDULUM, {"torque": math.nan, "duration": 1.0}),
    ],
    ids=["dead-position", "not-assembled", "duration", "start-speed", "torque"],
)
def test_errors_are_those_of_numpy(text, how):
    assert _sentence(from_text(text), "compiled", **how) == _sentence(from_text(text), "numpy", **how)


def test_too_many_windows_are_numpys_to_refuse(monkeypatch):
    monkeypatch.setattr(integration, "MOST_WINDOWS", 10)
    assert "at most 10 windows" in _sentence(mechanism("slotted-takeup"), "compiled", **SLOTTED_FREE)


def test_the_slope_from_moduli_stays_on_numpy():
    sample = mechanism("slotted-takeup")
    assert free_motion(sample, duration=0.1, half_slope="moduli").path == "numpy"
    with pytest.raises(LinkproofError, match="half slope 'moduli'"):
        free_motion(sample, duration=0.1, half_slope="moduli", path="compiled")


@pytest.mark.parametrize(("cost", "path"), [(choice.CALLING, "compiled"), (math.inf, "numpy")])
def test_kernels_are_taken_where_numpy_is_likely_to_be_slower(monkeypatch, cost, path):
    monkeypatch.setattr(choice, "cost_of_start", lambda _: cost)
    assert free_motion(mechanism("slotted-takeup"), **SLOTTED_FREE).path == path


def test_the_equation_integrated_is_the_mechanisms_own():
    equation = equation_of_motion(mechanism("slotted-takeup"), SLOTTED_DRIVEN["torque"])
    windows = compiled_motion.integrate(equation, (1.0, 2.0), 0.5, tolerance=1e-12, rounding=0.0)
    time, step = np.linspace(0.01, 0.49, 50), HALF_STEP
    slope = sum(
        weight * (windows.speed_at(time + k * step) - windows.speed_at(time - k * step))
        for k, weight in ((1, 45.0), (2, -9.0), (3, 1.0))
    ) / (60.0 * step)
    truth = equation.acceleration(windows.angle_at(time), windows.speed_at(time))
    assert slope == pytest.approx(truth, abs=DENSE * np.max(np.abs(truth)))
