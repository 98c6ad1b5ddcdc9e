"""A saved stress test is read back in the order of the table of axes; any other file is refused."""

import pytest

from analytic.errors import LinkproofError
from comparisons.runs.study import save_study
from comparisons.stress.campaign import KIND, Stress, load, save
from comparisons.stress.cells import axes
from comparisons.stress.verdict import StressVerdict
from tests.reports.made_up_stress import made_up_cell, made_up_stress

STRESS = made_up_stress()
PLACE = {"row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}
CELL = made_up_cell(StressVerdict.OVER, axis="mass", value=1.0, **PLACE).data


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


def test_cells_stand_in_the_order_of_the_table_whichever_was_done_first():
    found = Stress(STRESS.document, STRESS.cells[::-1])
    assert found.results == STRESS.results
    assert found.axes == tuple(name for name in axes() if name in STRESS.axes)


def test_columns_go_as_the_table_has_them_without_the_runs_of_the_bisection():
    extra = made_up_cell(StressVerdict.OVER, axis="mass", value=0.0123, **PLACE)
    found = Stress(STRESS.document, [*STRESS.cells, extra])
    for name in found.axes:
        assert found.columns[name] == axes()[name].values
    quick = made_up_stress(quick=True)
    assert quick.columns["mass"] == axes()["mass"].quick
    alone = made_up_stress(cells=[extra])
    assert alone.columns == {"mass": (0.0123,)}
