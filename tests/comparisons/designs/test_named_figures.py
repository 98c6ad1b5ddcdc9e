"""Figures that a linkage cannot have: what its file is without."""

import math

import pytest

from analytic.description.loading import load
from analytic.designs.figures import REDUCTIONS, figure_names
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import named_figures
from tests.analytic.drives import driven
from tests.analytic.linkages import from_text
from tests.comparisons.designs.sweeps import BARE


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


def test_every_name_that_is_listed_is_a_figure():
    mechanism = from_text(BARE)
    names = figure_names(mechanism)
    assert names
    assert len(named_figures(mechanism, names)) >= len(names) - len(REDUCTIONS)  # a family's members stand there too


@pytest.mark.parametrize(
    ("unit", "place", "angle"),
    [("deg", "30", math.pi / 6.0), ("rad", "30", math.pi / 6.0), ("rad", "-90", -0.5 * math.pi), ("deg", "2rad", 2.0)],
)
def test_a_place_is_in_degrees_whatever_the_unit_of_the_file(unit, place, angle):
    mechanism = from_text(BARE.replace('"deg"', f'"{unit}"').replace("angle = 60", "angle = 1"))
    (found,) = named_figures(mechanism, [f"point:B:y@{place}"])
    assert found.figure.angle == pytest.approx(angle, rel=1e-15)


def test_a_place_of_a_drive_along_a_line_is_in_the_unit_of_length():
    (found,) = named_figures(driven("linear-motor"), ["v@12"])
    assert found.figure.angle == pytest.approx(0.012, rel=1e-15)


@pytest.mark.parametrize(
    ("name", "meant"),
    [("torque", "Mkr.peak"), ("force.mean", "joint_force.mean"), ("strok", "stroke"), ("Mkr.pek", "Mkr.peak")],
)
def test_a_wrong_name_has_the_nearest_few(name, meant):
    with pytest.raises(LinkproofError) as told:
        named_figures(Mechanism(load("rimoldi-164")), [name])
    assert f"unknown figure '{name}': did you mean '{meant}'" in str(told.value)
    assert "more" not in str(told.value)
    assert len(str(told.value)) < 320
