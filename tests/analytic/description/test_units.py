"""Units of a file, and numbers as they are printed."""

from fractions import Fraction
from math import radians

import pytest

from analytic.description.units import UNITS, conversion, factor
from analytic.description.written import change, csv_text, fixed, signed
from analytic.errors import UnknownNameError

PREFIXES = {"k": Fraction(1000), "c": Fraction(1, 100), "m": Fraction(1, 1000), "u": Fraction(1, 10**6)}
BASE = {"m": 1, "g": Fraction(1, 1000), "t": 1000, "s": 1, "N": 1, "rad": 1}
BASE |= {"in": Fraction("0.0254"), "ft": Fraction("0.3048"), "lb": Fraction("0.45359237")}  # 1 lb = 0.45359237 kg
BASE |= {"lbf": BASE["lb"] * Fraction("9.80665"), "slug": BASE["lb"] * Fraction("9.80665") / BASE["ft"]}


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


def test_rates_of_length_are_known_with_it():
    assert (conversion("ft/s", "m/s"), conversion("ft/s^2", "m/s²")) == (0.3048, 0.3048)


def test_an_unknown_unit():
    with pytest.raises(UnknownNameError, match=r"unknown inertia unit 'kg\*m\^3': did you mean 'kg\*m\^2'\?"):
        factor("inertia", "kg*m^3")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (fixed(-0.0, 2), "0.00"), (fixed(-1e-17, 2), "0.00"), (fixed(-0.004, 2), "0.00"), (fixed(-0.006, 2), "-0.01"),
        (fixed(-0.4, 0), "0"), (signed(0.0, ".2f"), "0.00"), (signed(-0.0, ".2g"), "0"),
        (signed(-1e-9, ".3f"), "0.000"),
        (signed(1e-9, ".3f"), "0.000"), (signed(-0.0, ".0e"), "0e+00"), (signed(-3e-16, ".0e"), "-3e-16"),
        (signed(0.25, ".1%"), "+25.0%"), (signed(-1e-5, ".1%"), "0.0%"), (signed(10.0, ".4g"), "+10"),
        (change(3.2e-16), "0.00 %"), (change(-3.2e-16), "0.00 %"), (change(-0.0111), "-1.11 %"),
        (change(0.1), "+10.00 %"),
    ],
)  # fmt: skip
def test_a_rounded_zero_has_no_sign(text, expected):
    assert text == expected


@pytest.mark.parametrize(
    ("name", "cell"), [("=1+1", "'=1+1"), ("+a", "'+a"), ("-a", "'-a"), ("@a", "'@a"), ("a=b", "a=b")]
)
def test_a_name_in_a_csv_table_is_no_formula(name, cell):
    assert csv_text(name) == cell
