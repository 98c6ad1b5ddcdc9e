"""The joints' equations: true motions fit them, and each level is the one below it differentiated."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import Case
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import pose_of, with_ground
from tests.comparisons.true_motions import EVERYTHING, true_history

LINKAGES = [*catalogue(), *sorted(str(path) for path in (Path(__file__).parents[2] / "linkages").glob("*.toml"))]
TURNING = [name for name in LINKAGES if "parallelogram" not in name]


@cache
def looked_at(name):
    """A linkage's equations and its true motion at a few instants, in the equations' unit."""
    case = Case(Mechanism(load(name)), crank_motion("run-up-quintic", start_angle=0.4))
    equations = JointEquations(case.scene(EVERYTHING))
    history = true_history(case, 41)
    signals = (history.position, history.velocity, history.acceleration)
    return case, equations, *(with_ground(signal.values) / equations.metres for signal in signals)


def residual(equations, position):
    pose = pose_of(position)
    return equations.residual(pose, equations.arms(pose))


def rate_residuals(equations, position, velocity, acceleration):
    """The residuals of velocities and accelerations, the crank's own rate left out."""
    arms = equations.arms(pose_of(position))
    matrix = equations.jacobian(arms)
    matrix[:, equations.crank_row] = 0.0
    first, second = ((matrix @ equations.gather(rate)[..., None])[..., 0] for rate in (velocity, acceleration))
    return first, second - equations.bend(arms, velocity)


@pytest.mark.parametrize("name", TURNING)
def test_there_are_as_many_equations_as_coordinates(name):
    _, equations, position, *_ = looked_at(name)
    assert equations.rows == equations.size
    assert np.all(np.abs(np.linalg.det(equations.jacobian(equations.arms(pose_of(position))))) > 0.0)


@pytest.mark.parametrize("name", TURNING)
def test_a_true_motion_fits_on_every_level(name):
    _, equations, *motion = looked_at(name)
    levels = (residual(equations, motion[0]), *rate_residuals(equations, *motion))
    for level, values in zip(levels, motion, strict=True):
        assert np.max(np.abs(level)) < 1e-12 * np.max(np.abs(values))


@pytest.mark.parametrize("name", TURNING)
def test_the_jacobian_is_the_residuals_derivative(name):
    _, equations, position, *_ = looked_at(name)
    step, found = 1e-6, equations.jacobian(equations.arms(pose_of(position)))
    for column in range(equations.size):
        unit = np.zeros((41, equations.size))
        unit[:, column] = step
        more, less = (residual(equations, position + sign * equations.spread(unit)) for sign in (1.0, -1.0))
        slopes = (more - less) / (2.0 * step)
        slopes[:, equations.crank_row] = column == equations.crank_column
        np.testing.assert_allclose(slopes, found[:, :, column], atol=1e-8)


@pytest.mark.parametrize("name", TURNING)
def test_residuals_of_rates_are_those_of_positions_over_time(name):
    """A motion that breaks the joints: its rates' residuals are the time derivatives of its positions' one."""
    _, equations, position, *_ = looked_at(name)
    rng = np.random.default_rng(7)
    speed, bend = (equations.spread(rng.normal(size=(41, equations.size))) for _ in range(2))
    step = 1e-4
    after, here, before = (
        residual(equations, position + time * speed + 0.5 * time**2 * bend) for time in (step, 0.0, -step)
    )
    first, second = rate_residuals(equations, position, speed, bend)
    np.testing.assert_allclose(first, (after - before) / (2.0 * step), atol=3e-6)
    np.testing.assert_allclose(second, (after - 2.0 * here + before) / step**2, atol=3e-6)


@pytest.mark.parametrize("name", TURNING)
def test_openings_are_lengths_and_no_angles(name):
    _, equations, position, *_ = looked_at(name)
    pushed = position.copy()
    pushed[:, :-1, :2] += 1e-3 * np.arange(1.0, position.shape[1])[None, :, None]
    openings = equations.openings(residual(equations, pushed))
    assert openings.shape == (41, len(equations.joints))
    assert np.all(openings >= 0.0)
    assert np.max(equations.openings(residual(equations, position))) < 1e-14
