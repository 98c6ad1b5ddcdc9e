"""Units are converted by their definitions."""

import math

import pytest

from analytic.description.units import UNITS, factor
from analytic.errors import UnknownNameError


@pytest.mark.parametrize(
    ("kind", "unit", "si"),
    [
        ("length", "in", 0.0254),
        ("mass", "lb", 0.45359237),
        ("inertia", "g*mm^2", 1e-9),
        ("inertia", "kg*cm^2", 1e-4),
        ("angle", "deg", math.pi / 180.0),
        ("torque", "N*mm", 1e-3),
        ("stiffness", "N/mm", 1e3),
        ("damping", "N*s/mm", 1e3),
        ("turn_damping", "N*mm*s", 1e-3),
    ],
)
def test_factors(kind, unit, si):
    assert factor(kind, unit) == si


@pytest.mark.parametrize("kind", UNITS)
def test_every_kind_has_its_si_unit_and_only_positive_factors(kind):
    assert 1.0 in UNITS[kind].values()
    assert min(UNITS[kind].values()) > 0.0


def test_an_unknown_unit():
    with pytest.raises(UnknownNameError, match=r"unknown inertia unit 'kg\*m\^3': did you mean 'kg\*m\^2'\?"):
        factor("inertia", "kg*m^3")
