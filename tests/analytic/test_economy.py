"""Nothing is worked out in the closed form that is not asked for: operations on arrays counted, calls counted."""

import dataclasses
from collections import Counter

import numpy as np
import pytest

from analytic.description.law import Law
from analytic.description.linkage import Linkage
from analytic.dynamics import joint_forces, reduced
from analytic.dynamics.link_loads import LoadedSweep
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from tests.analytic.chains import chain_of_dyads, nearly_parallelograms
from tests.analytic.linkages import angles, from_text, mechanism
from tests.counting import calls, counted

LOADED = "force-over-angle"  # forces and torques over the crank angle
SPRUNG = "spring-and-damper"  # springs, a dashpot and dampers
SIX_BAR = "rimoldi-164"  # two dyads
SLOTTED = "slotted-takeup"


def _changed(sample: Mechanism, **changes) -> Mechanism:
    return Mechanism(dataclasses.replace(sample.linkage, **changes))


def _unloaded(linkage: Linkage) -> dict:
    return {"forces": (), "torques": (), "springs": (), "dampers": ()}


def _operations(sample: Mechanism, ask) -> int:
    """Operations on arrays that an evaluation at some crank angles takes."""
    tally = Counter()
    ask(Sweep(sample.linkage, sample.structure, counted(angles(5), tally)))
    return sum(tally.values())


def _torque(sweep):
    return reduced.drive_torque(sweep, 3.0, 2.0)


@pytest.fixture
def steps(monkeypatch):
    """Calls that solve dyads, by step."""
    return {step: calls(monkeypatch, DyadSolver, step) for step in ("poses", "rates", "accelerations")}


def _solved(steps) -> dict[str, int]:
    return {step: len(seen) for step, seen in steps.items()}


@pytest.mark.parametrize("name", [SIX_BAR, SLOTTED, SPRUNG, LOADED])
def test_each_question_takes_less_work_than_the_one_that_contains_it(name):
    sample = mechanism(name)
    place = _operations(sample, lambda sweep: sweep.output())
    velocity = _operations(sample, lambda sweep: sweep.output(1))
    acceleration = _operations(sample, lambda sweep: sweep.output(2))
    inertia = _operations(sample, reduced.reduced_inertia)
    slope = _operations(sample, reduced.half_inertia_derivative)
    torque = _operations(sample, _torque)
    assert 0 < place < velocity < acceleration < slope < torque
    assert velocity < inertia < slope


def test_the_reduced_inertia_asks_for_no_second_derivative_and_no_load(monkeypatch, steps):
    asked = [
        calls(monkeypatch, owner, name)
        for owner, name in (
            (Law, "__call__"),
            (reduced, "spring_length"),
            (reduced, "gravity_force"),
            (reduced, "load_force"),
            (reduced, "damping_coefficient"),
        )
    ]
    for name in (LOADED, SPRUNG):
        reduced.reduced_inertia(mechanism(name).sweep(angles(5)))
    assert _solved(steps)["accelerations"] == 0
    assert not any(asked)


def test_a_place_asks_for_no_rate_and_no_mass_centre(monkeypatch, steps):
    sample = mechanism(SIX_BAR)
    centres, before = calls(monkeypatch, Sweep, "centre"), _solved(steps)["poses"]
    sample.sweep(angles(5)).output()
    found = _solved(steps)
    assert (found["poses"] - before, found["rates"], found["accelerations"]) == (2, 0, 0)
    assert centres == []


def test_a_point_of_the_first_dyad_leaves_the_later_ones_unsolved(steps):
    sample = mechanism(SIX_BAR)
    first, second = sample.structure.dyads
    early = {point for link in first.links for point in sample.structure.bodies[link].points}
    late = {point for link in second.links for point in sample.structure.bodies[link].points} - early
    before = _solved(steps)["poses"]
    sweep = sample.sweep(angles(5))
    for point in early:
        sweep.point(point, 2)
    assert _solved(steps) == {"poses": before + 1, "rates": 1, "accelerations": 1}
    for point in late:
        sweep.point(point, 2)
    assert _solved(steps) == {"poses": before + 2, "rates": 2, "accelerations": 2}


@pytest.mark.parametrize("name", [SIX_BAR, "moving-guides"])
def test_without_gravity_there_is_nothing_of_it(monkeypatch, name):
    floating = _changed(mechanism(name), gravity=(0.0, 0.0))
    sweep = floating.sweep(angles(5))
    centres = calls(monkeypatch, Sweep, "centre")
    assert not np.any(reduced.gravity_force(sweep))
    assert not np.any(reduced.potential_energy(sweep))
    assert centres == []
    inertia_forces = _operations(
        floating, lambda at: reduced.reduced_inertia(at) * 2.0 + reduced.half_inertia_derivative(at) * 9.0
    )
    assert _operations(floating, _torque) == inertia_forces + 1  # less nothing
    assert _operations(mechanism(name), _torque) > inertia_forces + 1


@pytest.mark.parametrize("name", [LOADED, SPRUNG])
def test_without_loads_none_is_looked_at(monkeypatch, name):
    sample = mechanism(name)
    bare = _changed(sample, **_unloaded(sample.linkage))
    asked = [
        calls(monkeypatch, Law, "__call__"),
        calls(monkeypatch, reduced, "spring_length"),
        calls(monkeypatch, reduced, "load_force"),
        calls(monkeypatch, reduced, "damping_coefficient"),
        calls(monkeypatch, LoadedSweep, "_of_spring"),
        calls(monkeypatch, LoadedSweep, "_of_damper"),
    ]
    sweep = bare.sweep(angles(5))
    _torque(sweep)
    joint_forces.reactions(sweep, 3.0, 2.0)
    assert not any(asked)
    _torque(sample.sweep(angles(5)))
    assert any(asked)
    assert _operations(bare, _torque) < _operations(sample, _torque)


def test_links_without_mass_have_no_mass_centre_to_follow(monkeypatch, steps):
    """A dyad of links without mass and inertia is not even solved for what only masses feel."""
    sample = mechanism(SIX_BAR)
    last = sample.structure.dyads[-1].links
    light = {
        name: dataclasses.replace(link, mass=0.0, inertia=None if link.inertia is None else 0.0)
        if name in last
        else link
        for name, link in sample.linkage.links.items()
    }
    airy = _changed(sample, links=light)
    centres, before = calls(monkeypatch, Sweep, "centre"), _solved(steps)
    sweep = airy.sweep(angles(5))
    found = [reduced.reduced_inertia(sweep), reduced.half_inertia_derivative(sweep), reduced.gravity_force(sweep)]
    reduced.potential_energy(sweep)
    assert {args[1] for args in centres}.isdisjoint(last)
    assert {step: count - before[step] for step, count in _solved(steps).items()} == dict.fromkeys(steps, 1)
    alone = sample.sweep(angles(5))
    heavy = [name for name in sample.linkage.links if name not in last]
    assert np.array_equal(found[0], reduced.reduced_inertia(alone, heavy))


def test_a_slot_without_a_slider_has_no_mass_to_follow(monkeypatch):
    sample = mechanism("slot-without-mass")
    centres = calls(monkeypatch, Sweep, "centre")
    reduced.half_inertia_derivative(sample.sweep(angles(5)))
    assert {args[1] for args in centres} == set(sample.linkage.links) - {sample.linkage.crank}


@pytest.mark.parametrize("name", [SIX_BAR, LOADED, SPRUNG])
def test_a_crank_at_rest_asks_for_no_second_derivative(steps, name):
    sweep = mechanism(name).sweep(angles(5))
    torque = reduced.drive_torque(sweep, 0.0, 0.0)
    held = joint_forces.reactions(sweep, 0.0, 0.0).torque
    assert _solved(steps)["accelerations"] == 0
    assert np.allclose(torque, held, rtol=1e-12, atol=1e-12 * np.max(np.abs(torque)))


def test_a_steady_crank_asks_for_no_inertia_and_a_starting_one_for_no_slope(monkeypatch):
    sweep = mechanism(SIX_BAR).sweep(angles(5))
    inertias, slopes = (
        calls(monkeypatch, reduced, "reduced_inertia"),
        calls(monkeypatch, reduced, "half_inertia_derivative"),
    )
    reduced.drive_torque(sweep, 3.0, 0.0)
    assert (len(inertias), len(slopes)) == (0, 1)
    reduced.drive_torque(sweep, np.zeros(5), 2.0)
    assert (len(inertias), len(slopes)) == (1, 1)


def test_a_second_question_costs_only_what_is_new(steps):
    sweep = mechanism(SIX_BAR).sweep(angles(5))
    before = _solved(steps)["poses"]
    for _ in range(3):
        _torque(sweep)
        sweep.output(2)
        joint_forces.reactions(sweep, 3.0, 2.0)
    assert _solved(steps) == {"poses": before + 2, "rates": 2, "accelerations": 2}


@pytest.mark.parametrize(("text", "most"), [(chain_of_dyads, 15), (nearly_parallelograms, 100)])
def test_a_chain_is_assembled_and_its_range_found_in_some_solutions_of_each_dyad(steps, text, most):
    from_text(text(40)).crank_range()
    assert len(steps["poses"]) < most * 40
