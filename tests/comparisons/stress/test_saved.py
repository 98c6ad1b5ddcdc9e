"""A saved stress test is read back as it was, in the order of the table of axes; what is none is refused."""

import copy
import json
import random

import pytest

from analytic.errors import LinkproofError
from comparisons.stress.axes import axes
from comparisons.stress.saved import FILE, Stress, load
from comparisons.stress.verdict import StressVerdict
from reports.document.terminal import rendered
from reports.stress.page import page
from reports.stress.terminal import printout
from tests.reports.made_up_stress import made_up_cell, made_up_stress

STRESS = made_up_stress()
NO_CELL = json.dumps({**STRESS.document, "cells": [], "borders": []})
PLACE = {"row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}


def test_what_is_saved_is_read_back(tmp_path):
    (tmp_path / FILE).write_text(json.dumps(STRESS.document), encoding="utf-8")
    for place in (tmp_path, tmp_path / FILE):
        found = load(place)
        assert found.results == STRESS.results
        assert found.borders == STRESS.borders


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"cells": [{}], "command": "", "environment": {}}', "[1", NO_CELL])
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


def places(found, path=()):
    """The way to everything within a document."""
    parts = found.items() if isinstance(found, dict) else enumerate(found) if isinstance(found, list) else ()
    for key, part in parts:
        yield (*path, key)
        yield from places(part, (*path, key))


def damaged(document, rng):
    """The document with one place gone or of another kind."""
    found = copy.deepcopy(document)
    *way, last = rng.choice(list(places(found)))
    holder = found
    for key in way:
        holder = holder[key]
    if rng.random() < 0.2:
        del holder[last]
    else:
        holder[last] = rng.choice([None, "x", [], {}, -1.5, float("inf"), True])
    return found


def test_what_is_damaged_is_refused_or_makes_a_page(tmp_path):
    document = json.loads(json.dumps(made_up_stress(("change-point",), quick=True).document))
    rng, refused = random.Random(7), []
    for _ in range(200):
        (tmp_path / FILE).write_text(json.dumps(damaged(document, rng)), encoding="utf-8")
        try:
            found = load(tmp_path)
        except LinkproofError as error:
            refused.append(str(error))
        else:
            tables, closing, details = printout(found)
            assert page(found).sections
            assert rendered(*tables, *closing, *details)
    assert len(refused) > 50
    assert all("run stress with --out again" in words for words in refused)
