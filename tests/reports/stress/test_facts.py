"""A saved stress test is read back as it was, in the order of the table of axes; what is none is refused."""

import json

import pytest

from analytic.errors import LinkproofError
from comparisons.stress.axes import axes
from comparisons.stress.verdict import StressVerdict
from reports.stress.facts import FILE, SIGNS, Stress, load
from tests.reports.made_up_stress import made_up_cell, made_up_stress

STRESS = made_up_stress()
PLACE = {"row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}


def test_what_is_saved_is_read_back(tmp_path):
    (tmp_path / FILE).write_text(json.dumps(STRESS.document), encoding="utf-8")
    for place in (tmp_path, tmp_path / FILE):
        found = load(place)
        assert found.results == STRESS.results
        assert found.borders == STRESS.borders


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"cells": [{}], "command": "", "environment": {}}', "[1"])
def test_what_is_no_stress_test_is_refused_with_the_cure(tmp_path, text):
    (tmp_path / FILE).write_text(text, encoding="utf-8")
    with pytest.raises(LinkproofError, match=r"is no stress test .*run stress with --out again"):
        load(tmp_path)


def test_an_absent_file_is_refused_with_the_cure(tmp_path):
    with pytest.raises(LinkproofError, match="expected the folder given to stress --out"):
        load(tmp_path)


def test_cells_stand_in_the_order_of_the_table_whichever_was_done_first():
    found = Stress({**STRESS.document, "cells": list(reversed(STRESS.document["cells"]))})
    assert found.results == STRESS.results
    assert found.axes == tuple(name for name in axes() if name in STRESS.axes)


def test_columns_go_as_the_table_has_them_without_the_runs_of_the_bisection():
    extra = made_up_cell(StressVerdict.OVER, axis="mass", value=0.0123, **PLACE)
    found = Stress({**STRESS.document, "cells": [*STRESS.document["cells"], extra.document]})
    for name in found.axes:
        assert found.columns[name] == axes()[name].values
    quick = made_up_stress(quick=True)
    assert quick.columns["mass"] == axes()["mass"].quick
    alone = made_up_stress(cells=[made_up_cell(StressVerdict.OVER, axis="mass", value=0.0123, **PLACE).document])
    assert alone.columns == {"mass": (0.0123,)}


def test_an_axis_that_the_table_has_no_more_is_refused(tmp_path):
    cell = made_up_cell(StressVerdict.OVER, axis="mass", value=1.0, **PLACE).document
    document = {**STRESS.document, "cells": [{**cell, "axis": "gone"}]}
    (tmp_path / FILE).write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(LinkproofError, match=r"'gone'.*run stress with --out again"):
        load(tmp_path)


def test_every_verdict_has_a_sign_of_its_own():
    assert set(SIGNS) == set(StressVerdict)
    assert len({sign.symbol for sign in SIGNS.values()}) == len(SIGNS)
