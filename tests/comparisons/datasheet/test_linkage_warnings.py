"""Slips of the pen that leave a linkage which can be computed."""

import pytest

from analytic.description.loading import parse
from comparisons.datasheet.linkage_warnings import warnings
from tests.analytic.faults import JUKI

# Beside those in tests/reports/command_line/test_usual_mistakes.py.
SLIPS = {
    "inertia too small": ("inertia = 0.19e-4", "inertia = 0.19e-10", "(kg*m^2 read as kg*mm^2?)"),
    "inertia impossible": ("inertia = 0.19e-4", "inertia = 4e-3", "check the unit of inertia"),
    "mass in grams, heavy": ("mass    = 0.64", "mass = 640", "'crank' weighs 640 kg at a length of 15.5 mm: check"),
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
