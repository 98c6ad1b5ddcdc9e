"""Factors of units follow from SI prefixes, base units, and the yard and pound agreement of 1959."""

from fractions import Fraction
from math import radians

import pytest

from analytic.description.units import UNITS, factor
from analytic.errors import UnknownNameError

PREFIXES = {"k": Fraction(1000), "c": Fraction(1, 100), "m": Fraction(1, 1000), "u": Fraction(1, 10**6)}
BASE = {"m": 1, "g": Fraction(1, 1000), "t": 1000, "s": 1, "N": 1, "rad": 1}
BASE |= {"in": Fraction("0.0254"), "lb": Fraction("0.45359237")}  # 1 in = 25.4 mm, 1 lb = 0.45359237 kg


def _symbol(text):
    """The SI value of a unit with or without a prefix, or of a power of it."""
    name, _, power = text.partition("^")
    return Fraction(BASE[name] if name in BASE else PREFIXES[name[0]] * BASE[name[1:]]) ** int(power or 1)


def _by_definition(unit):
    """The SI value of a product of units over another."""
    above, _, below = unit.partition("/")
    value = Fraction(1)
    for text in above.split("*"):
        value *= _symbol(text)
    for text in filter(None, below.split("*")):
        value /= _symbol(text)
    return float(value)


@pytest.mark.parametrize("kind", UNITS)
def test_every_factor_follows_from_the_definitions(kind):
    expected = {unit: radians(1.0) if unit == "deg" else _by_definition(unit) for unit in UNITS[kind]}
    assert {unit: factor(kind, unit) for unit in UNITS[kind]} == expected
    assert 1.0 in UNITS[kind].values()


def test_the_rule_above_gives_what_handbooks_give():
    by_hand = {"g*cm^2": 1e-7, "kg*mm^2": 1e-6, "t": 1000, "mN": 1e-3, "kN/m": 1000, "N*s/mm": 1000, "N*mm*s": 1e-3}
    assert {unit: _by_definition(unit) for unit in by_hand} == by_hand


def test_an_unknown_unit():
    with pytest.raises(UnknownNameError, match=r"unknown inertia unit 'kg\*m\^3': did you mean 'kg\*m\^2'\?"):
        factor("inertia", "kg*m^3")
