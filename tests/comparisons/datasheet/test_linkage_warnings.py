"""Slips of the pen that leave a linkage which can be computed."""

import pytest

from analytic.description.loading import parse
from comparisons.datasheet.linkage_warnings import warnings
from tests.analytic.faults import JUKI

SLIPS = {
    "spelling": ("D = [54.5, 0]", "D = [54.5, 0], a = [1, 1]", "points 'A' and 'a' are two: a pin needs one spelling"),
    "centre": (
        "centre  = [12.9, 0]",
        "centre = [1290, 0]",
        "mass centre of 'coupler' is 1236 mm from its nearest point, and the link 54.5 mm long: check "
        "links.coupler.centre",
    ),
    "inertia in kg*mm^2": (
        "inertia = 0.19e-4",
        "inertia = 19",
        "inertia of 'coupler' is that of its mass 2.517e+04 mm from the mass centre, and its points are within 54.5 mm:"
        " check the unit of inertia (kg*mm^2 read as kg*m^2?)",
    ),
    "inertia too small": ("inertia = 0.19e-4", "inertia = 0.19e-10", "(kg*m^2 read as kg*mm^2?)"),
    "inertia impossible": ("inertia = 0.19e-4", "inertia = 4e-3", "check the unit of inertia"),
    "mass in grams": ("mass    = 0.64", "mass = 640", "'crank' weighs 640 kg at a length of 15.5 mm: check the unit"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_told(slip):
    old, new, told = SLIPS[slip]
    assert old in JUKI
    found = list(warnings(parse(JUKI.replace(old, new, 1), "juki", "juki.toml")))
    assert any(told in sentence for sentence in found), found


def test_a_linkage_without_slips_and_one_without_masses():
    assert list(warnings(parse(JUKI, "juki", "juki.toml"))) == []
    light = "\n".join(line for line in JUKI.splitlines() if not line.startswith(("mass ", "inertia ")))
    assert list(warnings(parse(light, "light", "light.toml"))) == []
