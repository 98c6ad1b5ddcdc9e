"""The joints' equations: their Jacobian against differences, their groups against the closed form's dyads."""

from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.errors import AssemblyError
from analytic.kinematics.mechanism import Mechanism
from comparisons.invariants.joint_equations import JointEquations
from comparisons.observation.body_states import States
from comparisons.reference.case import Case
from tests.comparisons.true_motions import EVERYTHING, true_history

LINKAGES = [*catalogue(), *sorted(str(path) for path in (Path(__file__).parents[2] / "linkages").glob("*.toml"))]
TURNING = [name for name in LINKAGES if "parallelogram" not in name]


@cache
def looked_at(name):
    """A linkage's equations and its true states at a few instants."""
    case = Case(Mechanism(load(name)), crank_motion("run-up-quintic", start_angle=0.4))
    equations = JointEquations(case.scene(EVERYTHING))
    history = true_history(case, 41)
    unit = np.array([equations.size, equations.size, 1.0])
    signals = (history.position, history.velocity, history.acceleration)
    return case, equations, States(equations.numbers, equations.size, *(s.values / unit for s in signals))


@pytest.mark.parametrize("name", TURNING)
def test_there_are_as_many_equations_as_coordinates(name):
    _, equations, states = looked_at(name)
    assert equations.count == equations.coordinates
    assert np.all(np.abs(np.linalg.det(equations.jacobian(states))) > 0.0)


@pytest.mark.parametrize("name", TURNING)
def test_a_true_state_fits_on_every_level(name):
    case, equations, states = looked_at(name)
    time = np.linspace(0.0, case.motion.duration, 41)
    drive = (case.motion.angle(time), case.motion.speed(time), case.motion.acceleration(time))
    for order, target in enumerate(drive):
        residual = equations.residual(states, order)
        residual[:, -1] -= target
        scale = np.max(np.abs((states.position, states.velocity, states.acceleration)[order]))
        assert np.max(np.abs(residual)) < 1e-12 * scale


@pytest.mark.parametrize("name", TURNING)
def test_the_jacobian_is_the_residuals_derivative(name):
    _, equations, states = looked_at(name)
    step, found = 1e-6, equations.jacobian(states)
    for column in range(equations.coordinates):
        unit = np.zeros((41, equations.coordinates))
        unit[:, column] = step
        moved = [
            equations.residual(
                States(equations.numbers, equations.size, states.position + sign * equations.spread(unit)), 0
            )
            for sign in (1.0, -1.0)
        ]
        np.testing.assert_allclose((moved[0] - moved[1]) / (2.0 * step), found[:, :, column], atol=1e-8)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", TURNING)
def test_residuals_of_rates_are_those_of_positions_over_time(name, order):
    """A motion that breaks the joints: its rates' residuals are the time derivatives of its positions' one."""
    _, equations, states = looked_at(name)
    rng = np.random.default_rng(7)
    shape = states.position.shape
    speed, bend = (rng.normal(size=shape) * equations.free for _ in range(2))
    step = 1e-4

    def residual(time):
        position = states.position + time * speed + 0.5 * time**2 * bend
        return equations.residual(States(equations.numbers, equations.size, position), 0)

    now = States(equations.numbers, equations.size, states.position, speed, bend)
    after, here, before = residual(step), residual(0.0), residual(-step)
    slopes = {1: (after - before) / (2.0 * step), 2: (after - 2.0 * here + before) / step**2}
    np.testing.assert_allclose(equations.residual(now, order), slopes[order], atol=3e-6)


@pytest.mark.parametrize("name", TURNING)
def test_every_body_is_in_one_group_and_no_group_is_larger_than_a_dyad(name):
    case, equations, _ = looked_at(name)
    columns = np.concatenate([columns for _, columns in equations.groups])
    crank = equations.columns[equations.numbers[case.mechanism.linkage.crank]]
    assert sorted([*columns, *crank]) == list(range(equations.coordinates))
    assert max(len(columns) for _, columns in equations.groups) <= 6


@pytest.mark.parametrize("name", TURNING)
def test_a_group_keeps_the_sign_of_its_determinant_as_long_as_it_keeps_its_mode(name):
    _, equations, states = looked_at(name)
    here = equations.group_determinants(equations.jacobian(states))
    assert np.all(here * here[0] > 0.0)
    assert np.all(np.abs(here) <= 1.0 + 1e-12)


def other_modes():
    """Every linkage with one dyad in its other mode, where that can be assembled for a whole turn."""
    for name in TURNING:
        dyads = Mechanism(load(name)).structure.dyads
        for number, dyad in enumerate(dyads):
            other = Mechanism(load(name))
            signs = [-d.sign if n == number else d.sign for n, d in enumerate(dyads)]
            other.structure = other.structure.with_signs(tuple(signs))
            if dyad.sign:
                with suppress(AssemblyError):
                    other.check_full_turn()
                    yield pytest.param(name, other, id=f"{Path(name).stem}: {dyad.name}")


@pytest.mark.parametrize(("name", "other"), list(other_modes()))
def test_the_other_mode_of_a_dyad_shows_in_a_determinant(name, other):
    case, equations, states = looked_at(name)
    here = equations.group_determinants(equations.jacobian(states))
    moved = true_history(case, 41, mechanism=other)
    unit = np.array([equations.size, equations.size, 1.0])
    there = States(equations.numbers, equations.size, moved.position.values / unit)
    changed = equations.group_determinants(equations.jacobian(there)) * here[0] < 0.0
    assert np.all(changed.any(axis=1))


def test_group_determinants_have_no_unit():
    one = looked_at("rimoldi-164")
    rows = one[1].group_determinants(one[1].jacobian(one[2]))
    jacobian = one[1].jacobian(one[2]) * np.linspace(0.1, 10.0, one[1].count)[None, :, None]
    np.testing.assert_allclose(one[1].group_determinants(jacobian), rows, rtol=1e-12)
