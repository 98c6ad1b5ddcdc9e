"""Units are converted by their definitions, worked out here from prefixes and the units of the SI alone."""

from fractions import Fraction

import pytest

from analytic.description.units import UNITS, factor
from analytic.errors import UnknownNameError

# What one of each is in kg, m, s: SI prefixes and base units, the gram and the tonne, and the yard and pound agreement
# of 1959 (1 in = 25.4 mm, 1 lb = 0.45359237 kg).
PREFIXES = {"k": Fraction(1000), "c": Fraction(1, 100), "m": Fraction(1, 1000), "u": Fraction(1, 10**6)}
BASE = {
    "m": Fraction(1),
    "g": Fraction(1, 1000),
    "t": Fraction(1000),
    "s": Fraction(1),
    "N": Fraction(1),
    "rad": Fraction(1),
    "in": Fraction("0.0254"),
    "lb": Fraction("0.45359237"),
}


def _one(symbol):
    """A unit with or without a prefix, or a power of one."""
    name, _, power = symbol.partition("^")
    size = BASE[name] if name in BASE else PREFIXES[name[0]] * BASE[name[1:]]
    return size ** int(power or 1)


def _by_definition(unit):
    """The SI value of a product of units over another."""
    above, _, below = unit.partition("/")
    value = Fraction(1)
    for symbol in above.split("*"):
        value *= _one(symbol)
    for symbol in filter(None, below.split("*")):
        value /= _one(symbol)
    return value


UNITS_BUT_THE_DEGREE = [(kind, unit) for kind in UNITS for unit in UNITS[kind] if unit != "deg"]


@pytest.mark.parametrize(("kind", "unit"), UNITS_BUT_THE_DEGREE)
def test_every_factor_follows_from_the_definitions(kind, unit):
    assert factor(kind, unit) == float(_by_definition(unit))


def test_the_definitions_are_those_of_the_handbooks():
    """A few worked by hand, so that the rule above is on trial too."""
    by_hand = {
        "g*cm^2": 1e-7,
        "kg*mm^2": 1e-6,
        "t": 1000,
        "mN": 1e-3,
        "kN/m": 1000,
        "kN*m": 1000,
        "g*m^2": 1e-3,
        "mg": 1e-6,
    }
    by_hand |= {"N*s/mm": 1000, "N*mm*s": 1e-3, "um": 1e-6, "in": 0.0254, "lb": 0.45359237}
    assert {unit: float(_by_definition(unit)) for unit in by_hand} == by_hand


def test_a_full_turn_is_360_degrees():
    assert 360.0 * factor("angle", "deg") == pytest.approx(6.283185307179586, rel=1e-15)


@pytest.mark.parametrize("kind", UNITS)
def test_every_kind_has_its_si_unit(kind):
    assert 1.0 in UNITS[kind].values()


def test_an_unknown_unit():
    with pytest.raises(UnknownNameError, match=r"unknown inertia unit 'kg\*m\^3': did you mean 'kg\*m\^2'\?"):
        factor("inertia", "kg*m^3")
