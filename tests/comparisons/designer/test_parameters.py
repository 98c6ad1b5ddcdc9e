"""Figures of designs by name: what a linkage cannot have, powers of the speed, masses that go with lengths."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import linkproof
from analytic.description.changes import LOADS, numbers, with_numbers, without
from analytic.description.loading import load, parse
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.parameters import case_at_speed, named_figures
from comparisons.designer.problem import constraint_texts
from comparisons.designer.sweep import parameter_range
from reports.document.templates import worded
from tests.analytic.linkages import from_text, path_of
from tests.comparisons.designer.sweeps import BARE


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stroke", "stroke: expected a linkage with an output point, got '"),
        ("Mkr@30", "Mkr: expected a linkage with masses of all links, got '"),
        ("joint_force.peak", "joint_force: expected a linkage with masses of all links, got '"),
    ],
)
def test_a_figure_that_needs_what_the_file_does_not_have_says_what(name, words):
    with pytest.raises(LinkproofError) as told:
        named_figures(from_text(BARE), [name])
    assert str(told.value).startswith(words)


@pytest.mark.parametrize(
    ("unit", "place", "angle"),
    [("deg", "30", math.pi / 6.0), ("rad", "30", math.pi / 6.0), ("rad", "-90", -0.5 * math.pi), ("deg", "2rad", 2.0)],
)
def test_a_place_is_in_degrees_whatever_the_unit_of_the_file(unit, place, angle):
    mechanism = from_text(BARE.replace('"deg"', f'"{unit}"').replace("angle = 60", "angle = 1"))
    (found,) = named_figures(mechanism, [f"point:B:y@{place}"])
    assert found.figure.angle == pytest.approx(angle, rel=1e-15)


@pytest.mark.parametrize(
    ("name", "meant"),
    [("Mkr", "Mkr.peak"), ("force.mean", "joint_force.mean"), ("strok", "stroke"), ("Mkr.pek", "Mkr.peak")],
)
def test_a_wrong_name_has_the_nearest_few(name, meant):
    with pytest.raises(LinkproofError) as told:
        named_figures(Mechanism(load("rimoldi-164")), [name])
    assert f"unknown figure '{name}': did you mean '{meant}'" in str(told.value)
    assert "more" not in str(told.value)
    assert len(str(told.value)) < 320


POWERS = {"Mkr": 2, "Teq": 2, "Peq": 3, "joint_force": 2, "stroke": 0}
POWER_FIGURES = ("Mkr.peak", "Mkr@30", "Mkr.rms", "Teq.max", "Teq.mean", "Peq.max", "joint_force.peak", "stroke")
SPEEDS = np.array([20.0, 50.0, 80.0])


def _by_inertia_alone(name):
    return Mechanism(without(load(name), "gravity", *LOADS))


@pytest.mark.parametrize(
    ("name", "turn"), [("rimoldi-164", -1.0), pytest.param(path_of("ternary-on-rods"), 1.0, marks=pytest.mark.nightly)]
)
def test_every_figure_and_its_derivative_is_that_of_a_power_of_the_speed(name, turn):
    sample = _by_inertia_alone(name)
    case = case_at_speed(sample, turn * 50.0, samples=24)
    named = named_figures(sample, POWER_FIGURES)
    powers = np.array([POWERS[one.name.replace("@", ".").replace(":", ".").partition(".")[0]] for one in named])
    for options in ({}, {"refine": False, "path": "numpy"}):
        found = case.figures({"speed": SPEEDS}, named, **options)
        expected = found[:, 1:2] * (SPEEDS / 50.0) ** powers[:, None]
        np.testing.assert_allclose(found, expected, rtol=1e-11)
    values, slopes = case.gradients({"speed": 50.0}, named)
    np.testing.assert_allclose(slopes[:, 0], powers * values / 50.0, rtol=1e-11 if not sample.is_numerical else 1e-8)


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
    case = case_at_speed(sample, 100.0, samples=36)
    figures = named_figures(sample, FIGURES[:-1])
    found = case.figures({"coupler.D.x": 1e-3 * lengths}, figures, refine=path == "numpy", path=path)
    for column, length in enumerate(lengths):
        alone = replace(case, mechanism=slender(float(length)))
        own = {"coupler.D.x": np.array([1e-3 * length])}
        expected = alone.figures(own, figures, refine=path == "numpy", path="numpy")
        np.testing.assert_allclose(found[:, column], expected[:, 0], rtol=1e-12)


@pytest.mark.parametrize(
    ("file", "link", "point", "tight"),
    [
        ("rimoldi-164", "rod", "B", 1e-11),
        ("rimoldi-164", "rocker", "C", 1e-11),
        pytest.param(path_of("ternary-on-rods"), "plate", "D", 1e-6, marks=pytest.mark.nightly),
    ],
)
def test_derivatives_are_those_of_the_chain_rule_and_a_mass_that_is_named_is_as_given(file, link, point, tight):
    sample = Mechanism(load(file))
    name = f"{link}.{point}.x"
    case, old = case_at_speed(sample, 30.0, samples=24), numbers(sample.linkage)
    figures = named_figures(sample, FIGURES)
    value, whole = 1.01 * old[name], sum(np.hypot(x, y) for x, y in sample.linkage.links[link].points.values())
    radius, grown = (np.hypot(x, old[f"{link}.{point}.y"]) for x in (old[name], value))
    scale, rate = 1.0 + (grown - radius) / whole, value / grown / whole
    parts = {f"{link}.mass": 1, f"{link}.centre.x": 1, f"{link}.centre.y": 1, f"{link}.inertia": 3}
    own = {name: value, **{one: old[one] * scale**power for one, power in parts.items()}}
    rates = np.array([1.0, *(power * old[one] * scale ** (power - 1) * rate for one, power in parts.items())])
    values, slopes = case.gradients(own, figures)
    found, total = replace(case, mechanism=scaled(sample)).gradients({name: value}, figures)
    np.testing.assert_allclose(found, values, rtol=1e-12)
    sizes = np.max(np.abs(slopes * rates), axis=1)
    assert np.all(np.abs(total[:, 0] - slopes @ rates) <= tight * sizes)
    given = with_numbers(scaled(sample).linkage, {name: value, f"{link}.mass": 3.0, f"{link}.centre.x": 0.5})
    assert (given.links[link].mass, given.links[link].centre[0]) == (3.0, 0.5)
    assert given.links[link].inertia == pytest.approx(own[f"{link}.inertia"], rel=1e-14)


def test_the_file_of_an_optimum_has_the_masses_and_so_the_figures():
    over = {"rod.B.x": (172, 178), "rocker.B.x": (20, 23), "rod.mass": (0.16, 0.18)}
    found = linkproof.optimise(
        "rimoldi-164",
        motion=linkproof.SteadyMotion(gravity=False),
        minimise="Mkr.peak",
        over=over,
        scale_mass=True,
        step="0.1mm",
    ).dataset
    assert found.attrs["conditions"].endswith(", masses scaled with lengths")
    assert "--scale-mass" in found.attrs["command"]
    after, own = found.sel(design="after"), Mechanism(parse(found.attrs["toml"], "best", "best"))
    assert own.linkage.links["rod"].mass == pytest.approx(float(after["rod.mass"]), rel=1e-15)
    still = Mechanism(without(own.linkage, "gravity"))
    named = named_figures(still, ["Mkr.peak", "Jeq.mean", "joint_force:O2.peak", "stroke"])
    values = case_at_speed(still, 1000.0 * np.pi / 30.0).figures_of({"rod.mass": own.linkage.links["rod"].mass}, named)
    for one, value in zip(named, values, strict=True):
        assert value / one.unit.size == pytest.approx(float(after[one.name]), rel=1e-12)


def test_names_may_have_the_signs_of_figures_and_ranges():
    """A link with an @ or an = in its name has figures, can be varied and can be held."""
    text = re.sub(r"\[(.*)links.coupler\]", r'[\1links."=r@d"]', load("juki-mf7923d").text)
    named = Mechanism(parse(text, "signs", ""))
    figures = [figure.name for figure in named_figures(named, ["link:=r@d:angle.peak", "link:=r@d:angle@30"])]
    assert figures == ["link:=r@d:angle.peak", "link:=r@d:angle@30"]
    assert [worded(name) for name in figures] == ["angle of link =r@d, peak", "angle of link =r@d at 30°"]
    assert parameter_range(case_at_speed(named, 1.0), "=r@d.mass=0.1:0.2:2")[0].name == "=r@d.mass"
    assert [figure.name for figure in constraint_texts(named, ["link:=r@d:angle.peak"])] == figures[:1]
