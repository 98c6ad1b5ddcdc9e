"""Borders are found to the precision asked for by as few runs as halving takes; a stress test is read back as saved."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.errors import LinkproofError
from comparisons.runs.store import save_study
from comparisons.stress.campaign import KIND, PRECISE, SMALLEST, bisect_borders, borders, load, save
from comparisons.stress.verdict import Cell, StressVerdict, blank_result
from tests.reports.made_up_stress import made_up_cell, made_up_stress

MASS = [10.0**power for power in range(-6, 7)]

STRESS = made_up_stress()
PLACE = {"row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}
CELL = made_up_cell(StressVerdict.OVER, axis="mass", value=1.0, **PLACE).data


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


def test_what_is_saved_is_read_back(tmp_path):
    save(tmp_path, STRESS)
    found = load(tmp_path)
    assert found.results == STRESS.results
    assert found.borders == STRESS.borders


@pytest.mark.parametrize(
    ("cells", "changes", "words"),
    [
        ([], {"borders": []}, "it has no cell"),
        ([CELL], {"borders": [{}]}, r"borders\.0\.axis: Field required"),
        ([{**CELL, "axis": "gone"}], {}, "'gone'"),
        ([{**CELL, "value": "x"}], {}, "value: Input should be a valid number"),
        ([{name: one for name, one in CELL.items() if name != "verdict"}], {}, "verdict: Field required"),
    ],
)
def test_what_is_of_another_form_is_refused_with_the_cure(tmp_path, cells, changes, words):
    rows = ((f"{number}", row, {}) for number, row in enumerate(cells))
    save_study(tmp_path, KIND, {**STRESS.document, **changes}, rows)
    with pytest.raises(LinkproofError, match=rf"{words}.*run stress with --out again"):
        load(tmp_path)
