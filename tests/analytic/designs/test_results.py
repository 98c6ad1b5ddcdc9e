"""Figures of many designs against linkages built one by one."""

import numpy as np
import pytest

from analytic import signals
from analytic.compiled import choice
from analytic.compiled.flat_linkage import flatten
from analytic.description.changes import changed
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.errors import AssemblyError, UnknownNameError
from analytic.evaluation import MovingSweep
from analytic.kinematics.sweep import Sweep
from tests.analytic.linkages import mechanism
from tests.analytic.loaded_linkages import ALL, on_trial

# Other orders of the same operations; of the peak.
SAME = 1e-13
ANGLES = np.arange(24) * (2.0 * np.pi / 24)
SPEED = 7.0


def varied(sample, seed, count, share):
    """Parameters for every number of a linkage, each changed by a share of itself and of the drawing's size."""
    draw = np.random.default_rng(seed)
    kinds = {}
    changed(sample.linkage, lambda name, kind, value: kinds.setdefault(name, (kind, value))[1])
    parameters = {}
    for name, (kind, value) in kinds.items():
        if name.startswith("sketch."):
            continue
        values = value * (1.0 + share * draw.normal(size=count))
        if kind in ("length", "direction"):
            values += share * (sample.linkage.extent() if kind == "length" else 1.0) * draw.normal(size=count)
        parameters[name] = np.abs(values) if kind in ("mass", "inertia") else values
    return parameters


def built(sample, parameters, number):
    """One of the designs, in the assembly modes of the original."""
    own = {name: float(values[number]) for name, values in parameters.items()}
    return sample.redesigned(changed(sample.linkage, lambda name, _, value: own.get(name, value)))


def every_signal(sample, design, angle):
    """All signals of a design at crank angles, S from its largest output there; raises AssemblyError."""
    sweep = Sweep(design.linkage, design.structure, angle)
    for body in design.structure.bodies:
        sweep.rates(body)
    top = float(np.max(sweep.output())) if sample.linkage.output else 0.0
    at = MovingSweep(sample, sweep, np.asarray(SPEED), np.asarray(0.0), top)
    return {name: signals.signal(at, name) for name in signals.names(sample)}


def reduced(values, reduction, middle):
    """One figure of a sampled signal."""
    return {
        Reduction.PEAK: lambda: values[np.argmax(np.abs(values - middle))],
        Reduction.MEAN: lambda: np.mean(values),
        Reduction.RMS: lambda: np.sqrt(np.mean(values**2)),
        Reduction.MAX: lambda: np.max(values),
        Reduction.MIN: lambda: np.min(values),
        Reduction.RANGE: lambda: np.ptp(values),
    }[reduction]()


@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_figures_are_those_of_linkages_built_one_by_one(case, is_laden):
    sample, count = on_trial(*case, is_laden), 4
    parameters = varied(sample, 3, count, 0.02)
    angle = sample.turn.angle[:: len(sample.turn.angle) // 24]
    ways = [one for one in Reduction if one is not Reduction.AT]
    figures = [Figure(name, ways[row % len(ways)]) for row, name in enumerate(signals.names(sample))]
    found = design_figures(sample, parameters, figures, angle, speed=SPEED)
    for number in range(count):
        try:
            expected = every_signal(sample, built(sample, parameters, number), angle)
        except AssemblyError:
            assert np.all(np.isnan(found[:, number]))
            continue
        for row, one in enumerate(figures):
            values = expected[one.signal]
            middle = 0.5 * np.pi if one.signal.startswith("transmission_angle:") else 0.0
            value = reduced(values, one.reduction, middle)
            assert abs(found[row, number] - value) <= SAME * np.max(np.abs(values)), one


def both_paths(sample, parameters, names, **settings):
    figures = [Figure(name, Reduction.PEAK) for name in names]
    return [
        design_figures(sample, parameters, figures, ANGLES, speed=SPEED, path=path, **settings)
        for path in ("numpy", "compiled")
    ]


@pytest.mark.skipif(not choice.is_installed(), reason="numba is not installed")
def test_either_path_gives_the_figures():
    sample = mechanism("rimoldi-164")
    parameters = varied(sample, 5, 200, 0.02)
    names = ["Mkr", "S", "joint_force:A:magnitude", "shaking_force:magnitude", "point:B:vx"]
    plain, compiled = both_paths(sample, parameters, names)
    assert 0 < np.count_nonzero(np.isnan(plain[0])) < 200
    np.testing.assert_array_equal(np.isnan(plain), np.isnan(compiled))
    assert np.nanmax(np.abs(plain - compiled) / np.nanmax(np.abs(plain), axis=1, keepdims=True)) <= SAME


@pytest.mark.skipif(not choice.is_installed(), reason="numba is not installed")
def test_what_the_kernels_do_not_know_is_numpy_s():
    sample = mechanism("rimoldi-164")
    parameters = varied(sample, 5, 5, 1e-3)
    for settings, names in (({"refine": True}, ["Mkr"]), ({}, ["Mkr", "link:rod:angle"])):
        np.testing.assert_array_equal(*both_paths(sample, parameters, names, **settings))
    laden = on_trial("pin in two slots", None, True)
    tabled = varied(laden, 5, 5, 1e-3)
    assert not set(tabled) <= set(flatten(laden).places)  # loads that are tables
    np.testing.assert_array_equal(*both_paths(laden, tabled, ["Mkr"]))


def test_a_signal_that_is_not_there_is_named():
    sample = mechanism("rimoldi-164")
    for name in ("Mrk", "point:B:magnitude", "joint_force:Q:magnitude"):
        with pytest.raises(UnknownNameError, match="signal"):
            design_figures(sample, {"rod.mass": [1.0]}, [Figure(name, Reduction.PEAK)], ANGLES, speed=SPEED)
