"""Borders are bisect_borders to the requested precision by as few runs as halving takes."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from comparisons.stress.campaign import PRECISE, SMALLEST, bisect_borders, borders
from comparisons.stress.verdict import Cell, StressVerdict, blank_result

MASS = [10.0**power for power in range(-6, 7)]


def result(value, verdict, *, axis="mass", usage="tuned"):
    return replace(blank_result(Cell(axis, "row", value, "e", usage), "m"), verdict=verdict)


def world(*, above=math.inf, below=0.0):
    """An engine that is right between two values of the axis, and a count of what it is asked."""
    asked = []

    def make(cells):
        asked.extend(cells)
        return [
            result(
                cell.value,
                StressVerdict.WITHIN if below < cell.value < above else StressVerdict.CAUGHT,
                axis=cell.axis,
                usage=cell.usage,
            )
            for cell in cells
        ]

    return make, asked


def grid(make, values=MASS, axis="mass"):
    return make([Cell(axis, "row", value, "e", "tuned") for value in values])


@settings(max_examples=20)
@given(above=st.floats(1.5, 9e5), below=st.floats(1.1e-6, 0.7))
def test_both_borders_are_bracketed_to_a_tenth(above, below):
    make, asked = world(above=above, below=below)
    rough = borders(grid(make))
    assert len(rough) == 2
    asked.clear()
    high, low = sorted(bisect_borders(rough, make), key=lambda one: -one.middle)
    assert high.inside < above <= high.outside
    assert low.outside <= below < low.inside
    assert high.ratio <= PRECISE
    assert low.ratio <= PRECISE
    assert len(asked) <= 2 * math.ceil(math.log2(math.log(10.0) / math.log(PRECISE)))


@pytest.mark.parametrize("above", [math.inf, 0.5])
def test_where_nothing_fails_or_the_easiest_value_does_there_is_no_border(above):
    make, _ = world(above=above)
    assert borders(grid(make)) == []


def test_only_the_first_border_from_the_easy_value_counts():
    verdicts = dict.fromkeys(MASS, StressVerdict.WITHIN) | {1e2: StressVerdict.OVER, 1e4: StressVerdict.DIVERGED}
    (border,) = borders([result(value, verdict) for value, verdict in verdicts.items()])
    assert (border.inside, border.outside) == (1e1, 1e2)
    assert border.document["verdict"] == "over limit"
    assert border.document["value"] == pytest.approx(math.sqrt(1e3))
    assert border.document["outside_command"] == "linkproof stress 'mass/row/100/e/tuned'"


def test_a_border_next_to_zero_is_not_followed_for_ever():
    values = [1e-1, 1e-6, 1e-12, 0.0]
    make, asked = world(below=1e-300)
    (border,) = bisect_borders(borders(grid(make, values, "change-point")), make)
    assert border.outside == 0.0
    assert border.inside <= SMALLEST
    assert len(asked) < 10


@pytest.mark.parametrize("verdict", [StressVerdict.TIMED_OUT, StressVerdict.CRASHED])
def test_a_border_that_the_machine_draws_is_not_narrowed_down(verdict):
    rough = borders([result(1.0, StressVerdict.WITHIN), result(1e3, verdict)])
    assert len(rough) == 1
    assert bisect_borders(rough, lambda cells: pytest.fail(f"{cells} were made")) == rough


def test_an_axis_whose_borders_are_not_worth_it_is_left_alone():
    line = [
        result(value, v, axis="turns-free") for value, v in ((1.0, StressVerdict.WITHIN), (1e3, StressVerdict.OVER))
    ]
    rough = borders(line)
    assert bisect_borders(rough, lambda cells: pytest.fail(f"{cells} were made")) == rough


def test_each_line_of_a_map_has_its_own_border():
    verdicts = [StressVerdict.WITHIN, StressVerdict.OVER]
    lines = [
        result(value, v, usage=usage)
        for usage in ("tuned", "best")
        for value, v in zip((1.0, 10.0), verdicts, strict=True)
    ]
    found = borders(lines)
    assert [one.usage for one in found] == ["best", "tuned"]
