"""Units as tools print them, against values worked out by hand."""

import math

import pytest

from comparisons.imported.header_words import parsed

DEGREE = math.pi / 180.0


def test_units_have_their_si_values():
    expected = {
        "newton-meter": 1.0, "N·m": 1.0, "N.m": 1.0, "Nm": 1.0, "N m": 1.0, "Н·м": 1.0, "NEWTON-METER": 1.0,
        "牛米": 1.0, "N-mm": 1e-3, "Ncm": 1e-2, "kN·m": 1e3, "in-lb": 4.4482216152605 * 0.0254, "lbf": 4.4482216152605,
        "°": DEGREE, "град": DEGREE, "rad": 1.0, "rev": 2.0 * math.pi, "deg/sec": DEGREE, "s^-1": 1.0, "1/s": 1.0,
        "rpm": math.pi / 30.0, "U/min": math.pi / 30.0, "об/мин": math.pi / 30.0, "deg/sec**2": DEGREE,
        "rad/s²": 1.0, "rad/s2": 1.0, "rad s^-2": 1.0, "m/(s^2)": 1.0, "inch/sec**2": 0.0254, "µm": 1e-6,
        "ms": 1e-3, "min": 60.0, "kW": 1e3, "N*mm/s": 1e-3, "Дж": 1.0, "kg·mm²": 1e-6, "kgf": 9.80665, "-": 1.0,
    }  # fmt: skip
    read = {text: unit.factor if (unit := parsed(text)) else None for text in expected}
    assert read == pytest.approx(expected, rel=1e-14)


def test_what_is_no_unit_is_none():
    for text in ("furlong", "", "1", "m/s/s", "N*", "/", "Motor1", "N^9", "x" * 99, "m^", "**2", "(", "²"):
        assert parsed(text) is None, text


def test_a_speed_of_rotation_may_be_in_one_over_seconds_and_nothing_else_may_lose_its_angle():
    per_second, metre_per_second = parsed("1/s"), parsed("m/s")
    assert per_second.measures((0, 0, -1, 1))
    assert not metre_per_second.measures((0, 0, -1, 1))
    assert not parsed("-").measures((0, 0, 0, 1))
