"""Borders are found from the easy value outwards and narrowed down between two runs, whatever the verdicts are."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from comparisons.stress import Cell, CellResult
from comparisons.stress_axes import axes
from comparisons.stress_border import SMALLEST, bisected, borders
from comparisons.stress_verdict import Judgement, StressVerdict

AXIS = axes()["mass"]  # easy at 1, harder on both sides


def result(value, good, axis=AXIS.name):
    verdict = StressVerdict.WITHIN if good else StressVerdict.CAUGHT
    return CellResult(Cell(axis, AXIS.rows[0].label, value, "engine", "tuned"), "m", "finished", Judgement(verdict), {})


def line(is_good, values=AXIS.values):
    return [result(value, is_good(value)) for value in values]


@given(st.floats(1e-6, 0.9), st.floats(1.1, 1e6))
def test_a_border_on_either_side_is_found_to_a_tenth(low, high):
    def good(value):
        return low <= value <= high

    made = []

    def make(cells):
        made.extend(cells)
        return [result(cell.value, good(cell.value)) for cell in cells]

    found = bisected(borders(line(good)), make)
    below = [one for one in found if one.outside.cell.value < one.inside.cell.value]
    above = [one for one in found if one.outside.cell.value > one.inside.cell.value]
    for sides, truth in ((below, low), (above, high)):
        for border in sides:
            ends = sorted((border.inside.cell.value, border.outside.cell.value))
            assert ends[0] <= truth * (1 + 1e-5)
            assert truth <= ends[1] * (1 + 1e-5)
            assert border.ratio <= 1.1
    assert len(below) == (low > min(AXIS.values))
    assert len(above) == (high < max(AXIS.values))
    assert all(cell.value == float(f"{cell.value:.6g}") for cell in made)  # a cell's name makes it again


def test_without_a_failure_there_is_no_border():
    assert borders(line(lambda _: True)) == []


def test_where_the_easy_value_itself_fails_there_is_none_either():
    assert borders(line(lambda value: value != AXIS.good)) == []


def test_what_recovers_beyond_a_failure_is_not_followed():
    (border,) = borders(line(lambda value: value < 10 or value > 1e4))
    assert (border.inside.cell.value, border.outside.cell.value) == (1, 10)


def test_a_border_next_to_zero_ends():
    axis = axes()["change-point"]
    runs = [result(value, value > 0.0, axis.name) for value in axis.values]
    (border,) = bisected(borders(runs), lambda cells: [result(c.value, c.value > 0.0, axis.name) for c in cells])
    assert border.outside.cell.value == 0.0
    assert 0.0 < border.inside.cell.value <= SMALLEST
    assert math.isinf(border.ratio)


def test_a_border_tells_how_to_make_its_two_runs_again():
    (border,) = borders(line(lambda value: value < 10))
    told = border.document
    assert told["inside_command"] == f"linkproof stress '{border.inside.cell.key}'"
    assert told["verdict"] == "caught"
    assert told["value"] == pytest.approx(math.sqrt(10.0), rel=1e-5)
