"""A map has every cell of its axis at its value, its story and its command; borders stand between the right columns."""

import dataclasses

import pytest

from comparisons.judging.records import QuantityRecord
from comparisons.stress.border import Border
from comparisons.stress.cell_result import Cell, StressVerdict
from reports.stress.facts import SIGNS
from reports.stress.maps import border_place, map_data, signs, story
from tests.reports.made_up_stress import made_up_cell, made_up_stress

STRESS = made_up_stress()
PLACE = {"axis": "mass", "row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}


@pytest.mark.parametrize(
    ("inside", "outside", "values", "place"),
    [
        (1e-2, 1.1e-3, (1e-4, 1e-3, 1e-2, 1e-1), 2),
        (1e-3, 1e-2, (1e-4, 1e-3, 1e-2, 1e-1), 2),
        (1.1e-3, 1.2e-3, (1e-4, 1e-3, 1e-2, 1e-1), 2),
        (1e-3, 0.0, (1e-2, 1e-3, 0.0), 2),
        (10.0, 1.0, (10.0, 1.0, 0.3), 1),
        (0.4, 0.3, (10.0, 1.0, 0.3), 2),
    ],
)
def test_a_border_stands_between_the_columns_it_lies_between(inside, outside, values, place):
    found = Border(**PLACE, inside=inside, outside=outside, verdict=StressVerdict.OVER)
    assert border_place(found, values) == place


@pytest.mark.parametrize("axis", STRESS.axes)
def test_every_cell_of_an_axis_stands_on_its_map_once_at_its_value(axis):
    found = map_data(STRESS, axis)
    placed = {}
    for block in found["blocks"]:
        for line in block["lines"]:
            for value, cell in zip(STRESS.columns[axis], line["cells"], strict=True):
                if cell:
                    place = Cell(axis, block["row"], value, line["engine"], line["usage"])
                    assert cell["command"] == place.command
                    placed[place] = list(SIGNS)[cell["verdict"]]
    assert placed == {one.cell: one.verdict for one in STRESS.results if one.cell.axis == axis}


def test_a_cell_with_no_run_is_left_empty():
    cells = [one for one in STRESS.cells if one.value != 1.0 or one.setting != "naive"]
    data = map_data(made_up_stress(cells=cells), "mass")
    column = data["values"].index("1")
    for line in data["blocks"][0]["lines"]:
        assert (line["cells"][column] is None) == (line["usage"] == "naive")


def test_a_story_tells_what_a_verdict_rests_on_and_nothing_that_is_not_known():
    blank = made_up_cell(StressVerdict.WITHIN, value=1.0, **PLACE)
    assert story(dataclasses.replace(blank, steps=0)) == {"Conditions": "linkage m"}
    known = dataclasses.replace(
        blank,
        reason="why",
        errors=(QuantityRecord("Jeq:needle_bar", error_max=2e-3, limit=1e-3),),
        invariants=(QuantityRecord("force_balance", error_max=3e-4, limit=1e-2),),
        differing={"mass_factor": 1e4, "link": "crank"},
    )
    found = story(known)
    assert found["Reason"] == "why"
    assert found["Worst deviation, over the peak"] == "Jeq of needle bar 2.0e-3, limit 1e-3"
    assert found["Worst invariant"] == "force balance 3.0e-4, limit 1e-2"
    assert found["Conditions"] == "mass factor 1e4; link crank"


def test_what_is_wrong_is_told_apart_from_what_the_checks_flagged():
    blank = made_up_cell(StressVerdict.CAUGHT, value=1.0, **PLACE)
    flagged = {"reason": "torque off. Flagged: a joint is open", "wrong": "torque off"}
    found = story(dataclasses.replace(blank, **flagged))
    assert (found["Wrong"], found["Flagged by the checks"]) == ("torque off", "a joint is open")


def test_a_sign_of_white_ink_looks_the_same_in_the_dark():
    found = {sign["word"]: sign for sign in signs(STRESS)}
    assert set(found) == {verdict.value for verdict in StressVerdict}
    assert found["missed"]["fixed"]
    assert not found["within limit"]["fixed"]
