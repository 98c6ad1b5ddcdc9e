"""A whole stress test on engines of the suite: counts, what is kept, and a liar that is caught."""

from dataclasses import replace

import pytest

from comparisons.runs.journal import Journal
from comparisons.runs.workers import LocalPool
from comparisons.stress import campaign
from comparisons.stress.axes import axes
from comparisons.stress.campaign import StressRequest, make_cells, stress
from comparisons.stress.cell_result import StressVerdict
from comparisons.stress.cells import find_cell, made
from tests.comparisons.faults import PATIENCE

START = replace(axes()["start"], quick=(1e-8,))


def request(**changes):
    return replace(StressRequest((START,), ("direct",), ("tuned",), quick=True, pool=LocalPool(0)), **changes)


def test_every_cell_is_made_once_and_counted():
    found = stress(request())
    assert [one.cell.value for one in found.cells] == [1e-8]
    assert found.document["summary"]["direct"] == {one.value: one is StressVerdict.WITHIN for one in StressVerdict}


def test_what_a_journal_has_is_not_made_again(tmp_path, monkeypatch):
    journal = Journal(tmp_path, "linkproof stress")
    first = stress(request(), journal=journal)
    monkeypatch.setattr(campaign, "made", lambda cell: pytest.fail(f"{cell.key} was made again"))
    again = stress(request(), journal=journal)
    assert again.cells == first.cells


@pytest.mark.parametrize("usage", ["naive", "tuned"])
def test_a_cell_alone_is_the_cell_of_the_map(usage):
    cell = find_cell(f"start/{START.rows[0].label}/1e-08/direct/{usage}")
    (alone,) = make_cells([cell], PATIENCE)
    here = made(cell)
    assert (alone.verdict, alone.errors, alone.steps) == (here.verdict, here.errors, here.steps)
