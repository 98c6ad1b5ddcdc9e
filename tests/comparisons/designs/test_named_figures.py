"""Figures that a linkage cannot have: what its file is without."""

import pytest

from analytic.errors import LinkproofError
from comparisons.designs.named_figures import named_figures
from tests.analytic.linkages import from_text

BARE = """
title = "bare"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
[ground]
O1 = [0, 0]
O2 = [60, 0]
[links.crank]
points = { O1 = [0, 0], A = [20, 0] }
[links.coupler]
points = { A = [0, 0], B = [60, 0] }
[links.rocker]
points = { O2 = [0, 0], B = [45, 0] }
[sketch]
angle = 60
points = { B = [60, 45] }
"""


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stroke", "stroke: expected a linkage with an output point, got '"),
        ("v.peak", "v: expected a linkage with an output point, got '"),
        ("Mkr.peak", "Mkr: expected a linkage with masses of all links, got '"),
        ("Mkr@30", "Mkr: expected a linkage with masses of all links, got '"),
        ("joint_force.peak", "joint_force: expected a linkage with masses of all links, got '"),
    ],
)
def test_a_figure_that_needs_what_the_file_does_not_have_says_what(name, words):
    with pytest.raises(LinkproofError) as told:
        named_figures(from_text(BARE), [name])
    assert str(told.value).startswith(words)


def test_what_it_has_is_found():
    found = named_figures(from_text(BARE), ["transmission_angle.min", "point:B:y@30"])
    assert [one.name for one in found] == ["transmission_angle:coupler + rocker (RRR).min", "point:B:y@30"]
