"""Means of designs against quadrature that shares nothing with theirs: the same whatever the samples and the path."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from analytic import signals
from analytic.compiled import choice
from analytic.description.law import FULL_TURN
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.evaluation import MovingSweep
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.loaded_linkages import on_trial
from tests.analytic.swinging import double_rocker

SPEED = 20.0
VARIANTS = dict.fromkeys(("juki-mf7923d", "rimoldi-164"), "as-built")
PATHS = ["numpy", *(["compiled"] if choice.is_installed() else [])]
SWING = (math.radians(-10.0), math.radians(65.0))
TURN = (0.0, FULL_TURN)


def integral(sample, one, span):
    """A mean by QUADPACK's adaptive quadrature; S from the highest of very many places."""
    output = sample.sweep(np.linspace(*span, 2_000_001)).output() if one.signal == "S" else np.zeros(1)

    def integrand(phi):
        at = MovingSweep(sample, sample.sweep(np.array([phi])), np.asarray(SPEED), np.asarray(0.0), float(output.max()))
        return float(signals.signal_or_magnitude(at, one.signal)[0]) ** (2 if one.reduction is Reduction.RMS else 1)

    edges = np.linspace(*span, 41)
    parts = [quad(integrand, *ends, epsabs=0.0, epsrel=1e-11, limit=500)[0] for ends in itertools.pairwise(edges)]
    mean = math.fsum(parts) / (span[1] - span[0])
    return math.sqrt(mean) if one.reduction is Reduction.RMS else mean


def figure_of(sample, name, how):
    group = sample.structure.dyads[0].name
    return Figure(name.replace("GROUP", group), how)


@pytest.mark.filterwarnings("ignore::scipy.integrate.IntegrationWarning")
@pytest.mark.parametrize(
    ("name", "figures"),
    [
        ("near-toggle", [("Mkr", Reduction.RMS), ("joint_force:B:magnitude", Reduction.MEAN)]),
        ("juki-mf7923d", [("S", Reduction.MEAN), ("S", Reduction.RMS), ("Jeq", Reduction.MEAN)]),
        ("rimoldi-164", [("transmission_angle:GROUP", Reduction.MEAN), ("link:rod:angle", Reduction.MEAN)]),
        ("double rocker", [("transmission_angle:GROUP", Reduction.RMS), ("S", Reduction.MEAN)]),
    ],
)
def test_a_mean_is_the_integral_over_the_motion(name, figures):
    swings = name == "double rocker"
    sample = Mechanism(double_rocker(along=(-1.0, 0.0))) if swings else on_trial(name, VARIANTS.get(name), False)
    wanted, span = [figure_of(sample, *one) for one in figures], SWING if swings else TURN
    expected = np.array([integral(sample, one, span) for one in wanted])
    numbers = {"crank.mass": np.full(2, sample.linkage.links["crank"].mass)}
    for path, (count, refine) in itertools.product(PATHS, ((60, False), (181, False), (180, True))):
        places = np.linspace(*span, count, endpoint=swings)
        found = design_figures(sample, numbers, wanted, places, speed=SPEED, refine=refine, path=path)
        np.testing.assert_allclose(found, np.stack([expected] * 2, axis=1), rtol=1e-9, err_msg=f"{count} {refine}")


@pytest.mark.parametrize("path", PATHS)
def test_the_mean_torque_of_a_steady_turn_without_friction_is_zero(path):
    """What gravity and inertia take they give back: the energy is the same after a turn."""
    sample = on_trial("near-toggle", None, False)
    figures = [Figure("Mkr", how) for how in (Reduction.MEAN, Reduction.RMS)]
    places = np.linspace(*TURN, 180, endpoint=False)
    mean, size = design_figures(sample, {"crank.mass": [0.3, 0.4]}, figures, places, speed=SPEED, path=path)
    assert np.all(np.abs(mean) < 1e-9 * size)
