"""Masses that go with lengths: the rule of a bar, wherever designs are made."""

from dataclasses import replace

import numpy as np
import pytest

import linkproof
from analytic.description.changes import numbers, with_numbers, without
from analytic.description.loading import load, parse
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import named_figures, steady_motion
from tests.analytic.drives import driven
from tests.analytic.linkages import mechanism

FIGURES = ("Mkr.peak", "Mkr.rms", "Jeq.mean", "joint_force.peak", "shaking_moment.max", "Mkr@30")
BAR = "points = {{ A = [0, 0], D = [{0!r}, 0] }}\nmass = {1!r}\ncentre = [{2!r}, 0]\ninertia = {3!r}\n"


def scaled(sample):
    """The same linkage, whose designs have masses that go with lengths."""
    return Mechanism(replace(sample.linkage, scales_mass=True))


def slender(length):
    """A coupler of the Juki mechanism that is a slender bar of so many mm: its mass as the length, inertia m l²/12."""
    mass, text = 5e-4 * length, load("juki-mf7923d").text
    begin, end = text.index("[links.coupler]"), text.index("[links.needle_bar]")
    own = BAR.format(length, mass, 0.5 * length, mass * (1e-3 * length) ** 2 / 12.0)
    return Mechanism(parse(f"{text[:begin]}[links.coupler]\n{own}{text[end:]}", "slender", "slender"))


@pytest.mark.parametrize("path", ["numpy", pytest.param("compiled", marks=pytest.mark.nightly)])
def test_a_slender_bar_of_another_length_is_the_one_that_a_file_has(path):
    lengths, sample = np.array([54.5, 50.0, 70.0]), scaled(slender(54.5))
    motion = steady_motion(sample, 100.0, samples=36)
    figures = [one.figure for one in named_figures(sample, FIGURES[:-1])]
    found = motion.figures(sample, {"coupler.D.x": 1e-3 * lengths}, figures, refine=path == "numpy", path=path)
    for column, length in enumerate(lengths):
        alone = slender(float(length))
        own = {"coupler.D.x": np.array([1e-3 * length])}
        expected = motion.figures(alone, own, figures, refine=path == "numpy", path="numpy")
        np.testing.assert_allclose(found[:, column], expected[:, 0], rtol=1e-12)


@pytest.mark.parametrize(
    ("sample", "link", "point", "tight"),
    [
        (mechanism("rimoldi-164", "as-built"), "rod", "B", 1e-11),
        (mechanism("rimoldi-164", "as-built"), "rocker", "C", 1e-11),
        pytest.param(driven("ternary-on-rods"), "plate", "D", 1e-6, marks=pytest.mark.nightly),
    ],
)
def test_derivatives_are_those_of_the_chain_rule_and_a_mass_that_is_named_is_as_given(sample, link, point, tight):
    name = f"{link}.{point}.x"
    motion, old = steady_motion(sample, 30.0, samples=24), numbers(sample.linkage)
    figures = [one.figure for one in named_figures(sample, FIGURES)]
    value, whole = 1.01 * old[name], sum(np.hypot(x, y) for x, y in sample.linkage.links[link].points.values())
    radius, grown = (np.hypot(x, old[f"{link}.{point}.y"]) for x in (old[name], value))
    scale, rate = 1.0 + (grown - radius) / whole, value / grown / whole
    parts = {f"{link}.mass": 1, f"{link}.centre.x": 1, f"{link}.centre.y": 1, f"{link}.inertia": 3}
    own = {name: value, **{one: old[one] * scale**power for one, power in parts.items()}}
    rates = np.array([1.0, *(power * old[one] * scale ** (power - 1) * rate for one, power in parts.items())])
    values, slopes = motion.gradients(sample, own, figures)
    found, total = motion.gradients(scaled(sample), {name: value}, figures)
    np.testing.assert_allclose(found, values, rtol=1e-12)
    sizes = np.max(np.abs(slopes * rates), axis=1)
    assert np.all(np.abs(total[:, 0] - slopes @ rates) <= tight * sizes)
    given = with_numbers(scaled(sample).linkage, {name: value, f"{link}.mass": 3.0, f"{link}.centre.x": 0.5})
    assert (given.links[link].mass, given.links[link].centre[0]) == (3.0, 0.5)
    assert given.links[link].inertia == pytest.approx(own[f"{link}.inertia"], rel=1e-14)


def test_the_file_of_an_optimum_has_the_masses_and_so_the_figures():
    over = {"rod.B.x": (172, 178), "rocker.B.x": (20, 23), "rod.mass": (0.16, 0.18)}
    found = linkproof.optimise(
        "rimoldi-164", minimise="Mkr.peak", over=over, scale_mass=True, gravity=False, step="0.1mm"
    )
    assert found.attrs["conditions"].endswith(", masses scaled with lengths")
    assert "--scale-mass" in found.attrs["command"]
    after, own = found.sel(design="after"), Mechanism(parse(found.attrs["toml"], "best", "best"))
    assert own.linkage.links["rod"].mass == pytest.approx(float(after["rod.mass"]), rel=1e-15)
    still = Mechanism(without(own.linkage, "gravity"))
    named = named_figures(still, ["Mkr.peak", "Jeq.mean", "joint_force:O2.peak", "stroke"])
    motion = steady_motion(still, 1000.0 * np.pi / 30.0)
    values = motion.figures(
        still, {"rod.mass": np.array([own.linkage.links["rod"].mass])}, [one.figure for one in named]
    )
    for one, (value,) in zip(named, values, strict=True):
        assert value / one.unit.size == pytest.approx(float(after[one.name]), rel=1e-12)
