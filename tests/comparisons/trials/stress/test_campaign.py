"""Borders are found to the precision asked for by as few runs as halving takes; a stress test is read back as saved."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.errors import LinkproofError
from comparisons.trials.runs.store import save_study
from comparisons.trials.stress.campaign import KIND, PRECISE, SMALLEST, borders, load, save
from comparisons.trials.stress.verdict import StressVerdict
from tests.comparisons.true_motions import cell
from tests.reports.made_up_stress import made_up_cell, made_up_stress

MASS = [10.0**power for power in range(-6, 7)]

STRESS = made_up_stress()
PLACE = {"row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}
CELL = made_up_cell(StressVerdict.OVER, axis="mass", value=1.0, **PLACE).data


def result(value, verdict, axis="mass"):
    return cell(value, axis=axis, engine="e", verdict=verdict)


def world(*, above=math.inf, below=0.0, axis="mass"):
    """Cells at values of an engine that is right between two values of the axis."""

    def make(values):
        verdicts = [StressVerdict.WITHIN if below < value < above else StressVerdict.CAUGHT for value in values]
        return [result(value, verdict, axis) for value, verdict in zip(values, verdicts, strict=True)]

    return make


def narrowed(make, cells):
    """The borders among cells, narrowed down, and how many cells that took."""
    asked = 0
    while wide := [border for border in borders(cells) if border.is_wide(PRECISE)]:
        asked += len(wide)
        cells = [*cells, *make([border.middle for border in wide])]
    return borders(cells), asked


@settings(max_examples=20)
@given(above=st.floats(1.5, 9e5), below=st.floats(1.1e-6, 0.7))
def test_both_borders_are_bracketed_to_a_tenth(above, below):
    make = world(above=above, below=below)
    assert len(borders(make(MASS))) == 2
    found, asked = narrowed(make, make(MASS))
    high, low = sorted(found, key=lambda one: -one.middle)
    assert high.inside.value < above <= high.outside.value <= PRECISE * high.inside.value
    assert low.outside.value <= below < low.inside.value <= PRECISE * low.outside.value
    assert asked <= 2 * math.ceil(math.log2(math.log(10.0) / math.log(PRECISE)))


@pytest.mark.parametrize("above", [math.inf, 0.5])
def test_where_nothing_fails_or_the_easiest_value_does_there_is_no_border(above):
    assert borders(world(above=above)(MASS)) == []


def test_only_the_first_border_from_the_easy_value_counts():
    verdicts = dict.fromkeys(MASS, StressVerdict.WITHIN) | {1e2: StressVerdict.OVER, 1e4: StressVerdict.DIVERGED}
    (border,) = borders([result(value, verdict) for value, verdict in verdicts.items()])
    assert border.ends == (1e1, 1e2)
    assert border.document["verdict"] == "over limit"
    assert border.document["value"] == pytest.approx(math.sqrt(1e3))
    assert border.document["outside_command"] == "linkproof stress 'mass/row/100/e/tuned'"


def test_a_border_next_to_zero_is_not_followed_for_ever():
    make = world(below=1e-300, axis="change-point")
    (border,), asked = narrowed(make, make([1e-1, 1e-6, 1e-12, 0.0]))
    assert border.outside.value == 0.0
    assert border.inside.value <= SMALLEST
    assert asked < 10


@pytest.mark.parametrize("verdict", [StressVerdict.TIMED_OUT, StressVerdict.CRASHED])
def test_a_border_that_the_machine_draws_is_not_narrowed_down(verdict):
    (border,) = borders([result(1.0, StressVerdict.WITHIN), result(1e3, verdict)])
    assert not border.is_wide(PRECISE)


def test_what_is_saved_is_read_back(tmp_path):
    save(tmp_path, STRESS)
    found = load(tmp_path)
    assert found.results == STRESS.results
    assert found.borders == STRESS.borders


@pytest.mark.parametrize(
    ("cells", "changes", "words"),
    [
        ([], {}, "it has no cell"),
        ([CELL], {"quick": "?"}, "quick: Input should be a valid boolean"),
        ([{**CELL, "axis": "gone"}], {}, "'gone'"),
        ([{**CELL, "value": "x"}], {}, "value: Input should be a valid number"),
        ([{name: one for name, one in CELL.items() if name != "value"}], {}, "value: Field required"),
    ],
)
def test_what_is_of_another_form_is_refused_with_the_cure(tmp_path, cells, changes, words):
    rows = ((f"{number}", row, {}) for number, row in enumerate(cells))
    save_study(tmp_path, KIND, {**STRESS.document, **changes}, rows)
    with pytest.raises(LinkproofError, match=rf"{words}.*run stress with --out again"):
        load(tmp_path)
