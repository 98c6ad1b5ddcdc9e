"""A scene's Assur groups and their assembly modes, against the closed form's dyads."""

from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.errors import AssemblyError
from analytic.kinematics.mechanism import Mechanism
from comparisons.invariants.assur_groups import AssurGroups
from comparisons.reference.case import Case
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import pose_of, with_ground
from tests.comparisons.true_motions import EVERYTHING, true_history

LINKAGES = [*catalogue(), *sorted(str(path) for path in (Path(__file__).parents[2] / "linkages").glob("*.toml"))]
TURNING = [name for name in LINKAGES if "parallelogram" not in name]


@cache
def looked_at(name):
    """A linkage's groups and its true positions at a few instants."""
    case = Case(Mechanism(load(name)), crank_motion("run-up-quintic", start_angle=0.4))
    groups = AssurGroups(JointEquations(case.scene(EVERYTHING)))
    return case, groups, true_history(case, 41).position.values


def jacobian(groups, position):
    equations = groups.equations
    return equations.jacobian(equations.arms(pose_of(with_ground(position) / equations.metres)))


@pytest.mark.parametrize("name", TURNING)
def test_every_body_is_in_one_group_and_no_group_is_larger_than_a_dyad(name):
    case, groups, _ = looked_at(name)
    columns = np.concatenate([columns for _, columns in groups.blocks])
    equations = groups.equations
    crank = equations.column[equations.index[case.mechanism.linkage.crank]]
    assert sorted([*columns, *crank]) == list(range(equations.size))
    assert max(len(columns) for _, columns in groups.blocks) <= 6


@pytest.mark.parametrize("name", TURNING)
def test_a_group_keeps_the_sign_of_its_determinant_as_long_as_it_keeps_its_mode(name):
    _, groups, position = looked_at(name)
    here = groups.determinants(jacobian(groups, position))
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
    case, groups, position = looked_at(name)
    here = groups.determinants(jacobian(groups, position))
    moved = true_history(case, 41, mechanism=other).position.values
    changed = groups.determinants(jacobian(groups, moved)) * here[0] < 0.0
    assert np.all(changed.any(axis=1))


def test_group_determinants_have_no_unit():
    _, groups, position = looked_at("rimoldi-164")
    matrix = jacobian(groups, position)
    scaled = matrix * np.linspace(0.1, 10.0, groups.equations.rows)[None, :, None]
    np.testing.assert_allclose(groups.determinants(scaled), groups.determinants(matrix), rtol=1e-12)
