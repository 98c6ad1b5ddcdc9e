"""Quantities by name: the same numbers as one by one, in pieces of any size."""

import numpy as np
import pytest

from analytic import evaluation
from analytic.dynamics import reduced
from analytic.errors import LinkproofError, UnknownNameError
from analytic.evaluation import evaluate
from tests.analytic.linkages import angles, mechanism


def test_pieces_make_up_the_whole(monkeypatch):
    sample, angle = mechanism("rimoldi-164"), angles(17)
    motion = {"speed": angles(17, seed=2), "acceleration": angles(17, seed=3)}
    names = ("Jeq", "Mkr", "S", "a", "joint_force:A:x", "link:rod:angle")
    whole = evaluate(sample, angle, names, **motion)
    assert np.array_equal(whole["Mkr"], reduced.drive_torque(sample.sweep(angle), *motion.values()))
    monkeypatch.setattr(evaluation, "PIECE", 5)
    for name, values in evaluate(sample, angle, names, **motion).items():
        assert np.array_equal(values, whole[name]), name


def test_results_have_the_shape_of_the_angles_and_scalars_spread():
    result = evaluate(mechanism("juki-mf7923d"), angles(6).reshape(2, 3), ["Mkr", "S"], speed=10.0)
    assert {name: values.shape for name, values in result.items()} == {"Mkr": (2, 3), "S": (2, 3)}
    assert evaluate(mechanism("juki-mf7923d"), 0.3, ["Jeq"])["Jeq"].shape == ()


def test_an_unknown_quantity_a_missing_speed_and_a_speed_of_another_shape():
    sample = mechanism("juki-mf7923d")
    with pytest.raises(UnknownNameError, match="unknown quantity 'jeq': did you mean 'Jeq'"):
        evaluate(sample, 0.0, ["jeq"])
    with pytest.raises(LinkproofError, match="speed: expected the crank's speed in rad/s for Mkr, Teq, got none"):
        evaluate(sample, 0.0, ["Jeq", "Mkr", "Teq"])
    with pytest.raises(LinkproofError, match=r"expected a number or an array of the crank angles' shape \(3,\)"):
        evaluate(sample, angles(3), ["Teq"], speed=angles(4))
