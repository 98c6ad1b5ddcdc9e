"""Slips of the pen that leave a linkage which can be computed."""

import pytest

from analytic.description.loading import parse
from comparisons.datasheet.linkage_warnings import warnings
from tests.analytic.faults import JUKI

FORCE = """[[forces]]
point = "D"
link = "needle_bar"
angle = [{}]
force = [[0, 0], [0, 30], [0, 45], [0, 10], [0, -5]]
[sketch]"""
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
    "mass in grams, slender": ("mass    = 0.03", "mass = 30", "'coupler' weighs 30 kg at a length of 54.5 mm"),
    "no mass": (
        "mass    = 0.03",
        "",
        "'coupler' has a mass centre and no mass: it weighs nothing; add links.coupler.mass",
    ),
    "gravity in mm/s^2": ("-9.81]", "-9810]", "gravity is 9810 m/s^2, which is the unit of gravity"),
    "spring": (
        "[sketch]",
        '[[springs]]\nbetween = ["D", "O1"]\nlinks = ["needle_bar", "ground"]\nstiffness = 5\n[sketch]',
        "the spring between D and O1 has no free length: it pulls at every length",
    ),
    "angles in rad": (
        "[sketch]",
        FORCE.format("0, 1.57, 3.14, 4.71, 5.5"),
        "the force at 'D' has no values between 5.5° and 360°, where a curve joins them",
    ),
    "overshoot": (
        "[sketch]",
        FORCE.format("0, 1, 120, 240, 300"),
        "the force at 'D' goes beyond its values by ",
    ),
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
