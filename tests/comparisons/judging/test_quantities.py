"""The quantities, read from a perfect motion, are the closed form's."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.judging.deviations import deviation
from comparisons.judging.quantities import QUANTITIES, all_quantities, chosen_quantities
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from tests.comparisons.perfect_engine import perfect_motion


@pytest.fixture(scope="module", params=["juki-mf7923d", "rimoldi-164"])
def case(request):
    return Case(Mechanism(load(request.param)), crank_motion("run-up-quintic"))


@pytest.fixture(scope="module")
def motion(case):
    return perfect_motion(case.mechanism, case.motion)


def test_a_perfect_motion_has_no_deviation(case, motion):
    errors = {name: deviation(case, q, motion).error_max for name, q in all_quantities(case).items()}
    assert {"Jeq", "Teq", "Mkr", "Peq", "S", "v", "a"} <= set(errors)
    assert {f"joint_force:{joint}" for joint in case.joint_names()} <= set(errors)
    assert max(errors.values()) < 1e-12


@pytest.mark.parametrize("name", ["Jeq", "Teq", "v"])
def test_velocities_on_a_clock_of_their_own_are_compared_at_their_own_times(case, name):
    shifted = perfect_motion(case.mechanism, case.motion, shift=0.5)
    assert deviation(case, QUANTITIES[name], shifted).error_max < 1e-12


def test_displacement_counts_from_top_dead_centre(case, motion):
    found = deviation(case, QUANTITIES["S"], motion)
    assert found.observed.min() >= -1e-12
    assert 0.0 < found.observed.max() < 0.04


def test_an_unknown_quantity_names_the_nearest(case):
    with pytest.raises(UnknownNameError, match="did you mean 'Jeq'"):
        chosen_quantities(case, ["jeq"])


def test_joint_force_stands_for_all_joints(case):
    names = [quantity.name for quantity in chosen_quantities(case, ["joint_force"])]
    assert names == [f"joint_force:{joint}" for joint in case.joint_names()]


def test_what_the_drive_gives_is_no_result(case):
    with pytest.raises(LinkproofError, match="phi is given, not a result"):
        chosen_quantities(case, ["phi"])


def test_a_linkage_without_output_says_what_to_add():
    bare = Mechanism(dataclasses.replace(load("juki-mf7923d"), output=None))
    with pytest.raises(LinkproofError, match=r"add output = \{ point"):
        _ = Case(bare, crank_motion()).output


@pytest.mark.parametrize("samples", [141, 1401])
def test_zeros_come_from_the_engines_own_motion_where_its_samples_show_them(samples):
    """An output moved as a whole is the same to it; read between few samples it would not be."""
    case = Case(Mechanism(load("slotted-takeup")), crank_motion("run-up-quintic"))
    motion = perfect_motion(case.mechanism, case.motion, samples)
    own = motion.last_turn is not None
    assert own == (samples == 1401)
    for name in ("S", "thread_feed"):
        quantity = QUANTITIES[name]
        assert bool(quantity.shared(case, motion)) != own
        assert deviation(case, quantity, motion).error_max < 1e-11
    moved = dataclasses.replace(
        motion.history.position, values=motion.history.position.values + np.array([0.0, 1e-3, 0.0])
    )
    shifted = ObservedMotion(motion.scene, dataclasses.replace(motion.history, position=moved))
    error = deviation(case, QUANTITIES["S"], shifted).error_max
    assert (error < 1e-11) == own
