"""Nothing is computed in the closed form that a quantity does not need: calls are counted."""

import dataclasses

import numpy as np
import pytest

from analytic.description.law import Law
from analytic.dynamics import joint_forces, reduced
from analytic.dynamics.link_loads import LoadedSweep
from analytic.evaluation import evaluate
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.motion.dead_centres import top_of_turn
from tests.analytic.chains import chain_of_dyads, nearly_parallelograms
from tests.analytic.linkages import angles, from_text, mechanism
from tests.counting import calls

LOADED = "force-over-angle"  # forces and torques over the crank angle
SPRUNG = "spring-and-damper"  # springs, a dashpot and dampers
SIX_BAR = "rimoldi-164"  # two dyads
STEPS = ("poses", "rates", "accelerations")


def _changed(sample, **changes):
    return Mechanism(dataclasses.replace(sample.linkage, **changes))


def _torque(sweep):
    return reduced.drive_torque(sweep, 3.0, 2.0)


@pytest.fixture
def solved(monkeypatch):
    """How often dyads are solved from now on: a function that returns the numbers for ``STEPS`` since its last call."""
    seen = {step: calls(monkeypatch, DyadSolver, step) for step in STEPS}

    def since():
        counts = tuple(len(seen[step]) for step in STEPS)
        for step in STEPS:
            seen[step].clear()
        return counts

    return since


# Quantities and how often the two dyads of the six-bar are solved for poses, rates and accelerations.
EVALUATIONS = [
    (["S"], (2, 0, 0)),
    (["v"], (2, 2, 0)),
    (["Teq", "Q", "S", "v"], (2, 2, 0)),
    (["Mkr", "Jeq", "Peq", "a"], (2, 2, 2)),
]


@pytest.mark.parametrize(("quantities", "expected"), EVALUATIONS)
def test_each_dyad_is_solved_once_and_no_further_than_the_quantities_need(solved, quantities, expected):
    sample = mechanism(SIX_BAR)
    top_of_turn(sample)
    solved()
    assert list(evaluate(sample, angles(10), quantities, speed=1.0, acceleration=1.0)) == quantities
    assert solved() == expected


@pytest.mark.parametrize("name", [SIX_BAR, SPRUNG])
def test_a_crank_at_rest_needs_no_second_derivative(solved, name):
    sweep = mechanism(name).sweep(angles(5))
    torque = reduced.drive_torque(sweep, 0.0, 0.0)
    at_rest = joint_forces.reactions(sweep, 0.0, 0.0).torque
    assert solved()[2] == 0
    assert np.allclose(torque, at_rest, rtol=1e-12, atol=1e-12 * np.max(np.abs(torque)))


def test_without_gravity_and_loads_nothing_of_them_is_computed(monkeypatch):
    floating = _changed(mechanism("moving-guides"), gravity=(0.0, 0.0))
    parts = ((Law, "__call__"), (reduced, "spring_length"), (reduced, "load_force"), (reduced, "damping_coefficient"))
    parts += ((LoadedSweep, "_spring_loads"), (LoadedSweep, "_damper_loads"))
    seen, centres = [calls(monkeypatch, *part) for part in parts], calls(monkeypatch, Sweep, "centre")
    sweep = floating.sweep(angles(5))
    assert not np.any(reduced.gravity_force(sweep))
    assert not np.any(reduced.potential_energy(sweep))
    assert centres == []
    for name in (LOADED, SPRUNG):
        bare = _changed(mechanism(name), forces=(), torques=(), springs=(), dampers=()).sweep(angles(5))
        _torque(bare)
        joint_forces.reactions(bare, 3.0, 2.0)
        reduced.reduced_inertia(mechanism(name).sweep(angles(5)))
    assert not any(seen)
    _torque(mechanism(SPRUNG).sweep(angles(5)))
    assert any(seen)


def test_links_without_mass_have_no_mass_centre_to_follow(monkeypatch, solved):
    """A dyad of links without mass and inertia is not even solved where only masses count."""
    sample = mechanism(SIX_BAR)
    last = sample.structure.dyads[-1].links
    links = {
        name: dataclasses.replace(link, mass=0.0, inertia=link.inertia and 0.0) if name in last else link
        for name, link in sample.linkage.links.items()
    }
    sweep, centres = _changed(sample, links=links).sweep(angles(5)), calls(monkeypatch, Sweep, "centre")
    solved()
    reduced.half_inertia_derivative(sweep)
    reduced.potential_energy(sweep)
    assert {args[1] for args in centres}.isdisjoint(last)
    assert solved() == (1, 1, 1)
    heavy = [name for name in sample.linkage.links if name not in last]
    assert np.array_equal(reduced.reduced_inertia(sweep), reduced.reduced_inertia(sample.sweep(angles(5)), heavy))


@pytest.mark.parametrize(("text", "most"), [(chain_of_dyads, 15), (nearly_parallelograms, 100)])
def test_a_chain_and_its_crank_range_take_few_solutions_of_each_dyad(solved, text, most):
    from_text(text(40)).crank_range()
    assert solved()[0] < most * 40
