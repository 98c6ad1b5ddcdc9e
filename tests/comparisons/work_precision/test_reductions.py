"""A reduction takes out what it says and changes nothing else."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.description.linkage import PointForce
from analytic.description.loading import catalogue, load
from analytic.dynamics import reduced as reduced_dynamics
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from comparisons.work_precision.reductions import (
    QUERIES,
    REDUCTIONS,
    reduced,
    without_gravity,
    without_loads,
    without_slot_masses,
)
from engines.mechanics.joints import JointEquations
from engines.scene import Prescribed
from tests.analytic.linkages import FULL_TURN, angles, mechanism

SLOTTED = "slotted-takeup"


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_a_linkage_with_bare_pins_in_its_slots_moves_as_before(name, variant):
    whole = mechanism(name, variant)
    bare = Mechanism(without_slot_masses(whole.linkage))
    left = list(bare.linkage.links)
    sweeps = [sample.sweep(angles(20)) for sample in (whole, bare)]
    for link in left:
        one, other = (sweep.local_point(link, (0.01, 0.02), 2) for sweep in sweeps)
        assert all(np.allclose(a, b, rtol=1e-9, atol=1e-9) for a, b in zip(one, other, strict=True))
    inertias = [reduced_dynamics.reduced_inertia(sweep, left) for sweep in sweeps]
    assert np.allclose(*inertias, rtol=1e-12)


def test_a_slot_mass_that_is_pulled_at_stays():
    linkage = load(SLOTTED)
    assert "slot_slider" not in without_slot_masses(linkage).links
    pull = PointForce("P4", "slot_slider", Law(np.array([1.0, 2.0])))
    assert "slot_slider" in without_slot_masses(dataclasses.replace(linkage, forces=(pull,))).links


def test_a_reduction_that_takes_nothing_out_leaves_nothing_to_compare():
    bare = without_loads(mechanism("centric-slider-crank").linkage)  # no gravity either, and no slot
    assert [part for part in REDUCTIONS if reduced(bare, part)] == [part for part in REDUCTIONS if part.rest is None]
    assert all(reduced(load(SLOTTED), part) for part in REDUCTIONS)


def test_a_linkage_keeps_all_but_what_is_left_out():
    whole = load(SLOTTED)
    weightless, unloaded, bare = without_gravity(whole), without_loads(whole), without_slot_masses(whole)
    assert (weightless.gravity, weightless.dampers) == ((0.0, 0.0), whole.dampers)
    assert (unloaded.gravity, unloaded.dampers) == (whole.gravity, ())
    assert (len(bare.links), bare.dampers) == (len(whole.links) - 1, whole.dampers)
    assert whole.dampers


def test_a_query_asks_for_what_the_linkage_has():
    without_output = dataclasses.replace(load("juki-mf7923d"), output=None)
    names = {query.name: query.names(without_output) for query in QUERIES}
    assert names["everything"] == ("Jeq", "Teq", "Q", "Mkr", "Peq")
    assert names["S"] == names["v"] == names["a"] == ()


@pytest.mark.parametrize("name", catalogue())
def test_every_mechanism_of_the_catalogue_can_be_reduced(name):
    for part in REDUCTIONS:
        rest = reduced(load(name), part)
        if rest is not None:
            model = scene(Mechanism(rest), Prescribed(crank_motion(start_angle=0.7)), part.channels)
            equations = JointEquations(model)
            assert equations.rows == equations.size
