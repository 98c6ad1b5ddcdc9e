"""The gallery's linkages against the textbooks' laws, and the work of the press against its load."""

from math import atan2, cos, hypot, sin, sqrt

import numpy as np
import pytest

import linkproof
from analytic.description.loading import gallery, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.linkage_check import check
from tests.sources import ROOT

ANGLES = np.radians([-37.0, -11.0, 8.0, 33.0])  # of a crank, within the range of every linkage that does not turn
LENGTHS = [0.53, 0.61, 0.76]  # of the cylinder, m


def four_bar(ground, crank, coupler, rocker):
    """Freudenstein's equation for a ground along x, as a residual: its links close."""

    def law(at, phi):
        turned = np.angle(at("B") - ground)
        first, second, third = ground / crank, ground / rocker, crank**2 - coupler**2 + rocker**2 + ground**2
        return first * cos(turned) - second * cos(phi) + third / (2 * crank * rocker) - cos(phi - turned)

    return law


def beam(at, phi):
    pivot = -2.1 + 3.2j
    turned = np.angle(at("B") - pivot)
    assert abs(at("H") - pivot + 2.6 * np.exp(1j * turned)) < 1e-12  # on the other side of the pivot
    return abs(pivot + 2.1 * np.exp(1j * turned) - 0.9 * np.exp(1j * phi)) - 3.2


def lift(at, length):
    first, second = hypot(0.5, 0.06), hypot(0.85, 0.1)
    between = np.arccos((first**2 + second**2 - length**2) / (2 * first * second))  # law of cosines
    turned = between - atan2(0.06, 0.5) - atan2(0.1, 0.85)
    return at("T") - 1j * 1.2 * sin(turned)


def press(at, phi):
    crank = -0.392 + 0.3j + 0.06 * np.exp(1j * phi)
    fall = np.arcsin(-at("K").real / 0.3)  # of the upper link, from the vertical
    assert abs(abs(at("K") - crank) - 0.33) < 1e-15
    return at("R") - 1j * (0.6 - 0.6 * cos(fall))


def wiper(at, phi):
    crank = 0.04j + 0.038 * np.exp(1j * phi)
    left, right = at("B") + 0.3 + 0.02j, at("C") - 0.35 + 0.02j
    assert abs(at("W") + 0.3 + 0.02j - 10 * left) < 1e-14  # the blade's tip is ten levers from the pivot
    return max(
        abs(abs(at("B") - crank) - 0.3), abs(abs(at("C") - crank) - 0.35), abs(abs(left) - 0.06), abs(abs(right) - 0.06)
    )


LAWS = {
    "beam-pump": beam,
    "compressor": lambda at, phi: at("C") - 1j * (0.03 * sin(phi) + sqrt(0.11**2 - (0.03 * cos(phi)) ** 2)),
    "coupler-curve": four_bar(0.06, 0.02, 0.06, 0.045),
    "crank-shaper": lambda at, phi: at("E") + 0.2j - 0.42 * np.exp(1j * atan2(0.2 + 0.08 * sin(phi), 0.08 * cos(phi))),
    "drag-link": four_bar(0.02, 0.06, 0.055, 0.055),
    "peaucellier-inversor": lambda at, phi: at("P").real - (0.15**2 - 0.06**2) / (2 * 0.059),
    "scissor-lift": lift,
    "scotch-yoke": lambda at, phi: at("Y") - 0.025 * cos(phi),
    "toggle-press": press,
    "windscreen-wiper": wiper,
}


def test_ten_linkages_each_have_a_law_and_a_row_in_the_documentation():
    assert set(LAWS) == set(gallery())
    assert len(LAWS) == 10
    page = (ROOT / "docs" / "linkage-files.md").read_text(encoding="utf-8")
    assert [name for name in LAWS if f"\n| `{name}` |" not in page] == []


@pytest.mark.parametrize("name", LAWS)
def test_a_linkage_moves_by_its_law_and_is_without_warnings(name):
    of = Mechanism(load(name))
    for drive in LENGTHS if name == "scissor-lift" else ANGLES:
        sweep = of.sweep(drive)
        assert abs(LAWS[name](lambda point, sweep=sweep: complex(*map(float, sweep.point(point))), drive)) < 1e-13
    facts, fault = check(load(name))
    assert (fault, facts["warnings"]) == (None, [])


def test_the_press_takes_the_work_of_its_load():
    found = linkproof.results("toggle-press", linkproof.Motion(speed=40)).to_dict()["figures"]
    (mean,) = (row["value"] for row in found["drive"] if row["what"] == "signed mean" and row["signal"] == "Mkr")
    (stroke,) = (row["value"] for row in found["output"] if row["what"] == "stroke")
    assert mean * 2 * np.pi == pytest.approx(50e3 * (stroke - 0.044), rel=1e-9)  # from 44 mm on, where the ramp is half
