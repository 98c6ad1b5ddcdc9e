"""Tolerance files: their contents and units, and the messages about wrong ones."""

import math

import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.designs.tolerances import Distribution, read_tolerances, tolerances

RIMOLDI = load("rimoldi-164")


def test_a_file_states_results_speed_and_tolerances_in_several_ways(tmp_path):
    file = tmp_path / "tolerances.toml"
    file.write_text(
        'results = ["Mkr.peak", "stroke"]\nspeed = 900\n[tolerances]\n"rod.B.x" = 0.05\nrod.centre.x = "±50um"\n'
        'rocker.mass = { plus_minus = 0.01, distribution = "uniform" }\n"rocker.C.angle" = 0.2\n'
        '"rocker.B.length" = 0.1\n',
        encoding="utf-8",
    )
    read = read_tolerances(file)
    found = {one.name: one for one in tolerances(RIMOLDI, read.table)}
    assert (read.results, read.speed) == (("Mkr.peak", "stroke"), 900)
    expected = {
        **{"rod.B.x": 5e-5, "rod.centre.x": 5e-5, "rocker.mass": 0.01},
        **{"rocker.C.angle": math.radians(0.2), "rocker.B.length": 1e-4},
    }
    assert {name: one.plus_minus for name, one in found.items()} == pytest.approx(expected)
    assert found["rocker.mass"].distribution is Distribution.UNIFORM
    assert found["rod.B.x"].distribution is Distribution.NORMAL
    assert (found["rocker.C.angle"].point, found["rod.B.x"].point) == ("rocker.C", "")
    assert found["rocker.C.angle"].parameter.unit.name == "deg"


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"rod.B.X": 0.1}, "did you mean 'rod.B.x'"),
        ({"rod.B.x": -0.1}, "rod.B.x: expected a positive ±, got -0.1"),
        ({"rod.B.x": "0.1kg"}, "rod.B.x: unknown length unit"),
        ({"rod.B.x": True}, "expected a number, or one with its unit, got True"),
        ({"rod.B.x": {"plus_minus": 0.1, "distribution": "flat"}}, "normal or uniform, got 'flat'"),
        ({"rod.B.x": {"plus_minus": 0.1, "spread": 1}}, "unknown key 'spread'"),
        ({"rod.mass": 0.2}, "rod.mass: expected a ± up to the number itself"),
        ({"rod.B.x": 0.1, "rod.B.angle": 0.1}, "expected either x and y, or length and angle, of 'rod.B'"),
        ({"speed": 500}, "speed: expected a ± up to half of the speed, got a larger one"),
        ({"rod.A.length": 0.1}, "unknown parameter 'rod.A.length'"),  # it is the origin
    ],
)
def test_a_wrong_tolerance_is_refused_in_a_sentence(table, words):
    with pytest.raises(LinkproofError, match=words) as told:
        tolerances(RIMOLDI, table, "t.toml: tolerances.", 100.0)
    assert str(told.value).startswith("t.toml: ")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("result = 1", "unknown key 'result'"),
        ("results = []", "results: expected a list of figures"),
        (
            'results = ["Mkr.peak"]\nspeed = 0\n[tolerances]\nx = 1',
            "speed: expected a finite number other than 0, got 0",
        ),
        ('results = ["Mkr.peak"]\nspeed = "fast"', "speed: expected a number, got 'fast'"),
        ('results = ["Mkr.peak"]', "expected a table \\[tolerances\\]"),
        ("results = [", "not valid TOML"),
    ],
)
def test_a_wrong_file_is_refused_with_its_name(tmp_path, text, words):
    file = tmp_path / "tolerances.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(LinkproofError, match=words) as told:
        read_tolerances(file)
    assert str(file) in str(told.value)
    with pytest.raises(LinkproofError, match="check it"):
        read_tolerances(tmp_path / "none.toml")
