"""The speed as a number of designs: where nothing but inertia acts every figure is a power of it."""

import numpy as np
import pytest

from analytic.description.changes import LOADS, without
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import named_figures, steady_motion
from tests.analytic.drives import path_of

POWERS = {"Mkr": 2, "Teq": 2, "Peq": 3, "joint_force": 2, "stroke": 0}
FIGURES = ("Mkr.peak", "Mkr@30", "Mkr.rms", "Teq.max", "Teq.mean", "Peq.max", "joint_force.peak", "stroke")
SPEEDS = np.array([20.0, 50.0, 80.0])


def _by_inertia_alone(name):
    return Mechanism(without(load(name), "gravity", *LOADS))


@pytest.mark.parametrize(
    ("name", "turn"),
    [("rimoldi-164", -1.0), pytest.param(path_of("ternary-on-rods"), 1.0, marks=pytest.mark.nightly)],
)
def test_every_figure_and_its_derivative_is_that_of_a_power_of_the_speed(name, turn):
    sample = _by_inertia_alone(name)
    motion = steady_motion(sample, turn * 50.0, samples=24)
    named = named_figures(sample, FIGURES)
    figures = [one.figure for one in named]
    powers = np.array([POWERS[one.name.replace("@", ".").replace(":", ".").partition(".")[0]] for one in named])
    for options in ({}, {"refine": False, "path": "numpy"}):
        found = motion.figures(sample, {"speed": SPEEDS}, figures, **options)
        expected = found[:, 1:2] * (SPEEDS / 50.0) ** powers[:, None]
        np.testing.assert_allclose(found, expected, rtol=1e-11)
    values, slopes = motion.gradients(sample, {"speed": 50.0}, figures)
    np.testing.assert_allclose(slopes[:, 0], powers * values / 50.0, rtol=1e-11 if not sample.is_numerical else 1e-8)
