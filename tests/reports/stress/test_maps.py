"""A map has every cell of its axis at its value, its story and its command; borders stand between the right columns."""

import dataclasses

import pytest

from comparisons.stress.border import Border
from comparisons.stress.verdict import StressVerdict
from reports.stress.facts import SIGNS
from reports.stress.maps import border_place, map_data, story, stress_map, widget_data
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
def test_every_cell_of_an_axis_stands_on_its_map_once(axis):
    found = stress_map(STRESS, axis)
    placed = [cell for block in found.blocks for line in block.lines for cell in line.cells if cell]
    assert sorted(one.cell.key for one in placed) == sorted(
        one.cell.key for one in STRESS.results if one.cell.axis == axis
    )
    for block in found.blocks:
        for line in block.lines:
            assert len(line.cells) == len(found.values)
            assert all(one.cell.value == value for one, value in zip(line.cells, found.values, strict=True) if one)


def test_engines_have_their_own_usages_on_an_axis_of_methods():
    (block, *_) = stress_map(STRESS, "speed").blocks
    assert [(line.engine, line.usage) for line in block.lines] == [
        (name, usage) for name, usage in dict.fromkeys((one.cell.engine, one.cell.usage) for one in STRESS.results)
        if ("speed", block.row, name, usage) in STRESS.lines
    ]  # fmt: skip


def test_a_cell_with_no_run_is_left_empty():
    cells = [row for row in STRESS.document["cells"] if row["value"] != 1.0 or row["usage"] != "naive"]
    data = map_data(stress_map(made_up_stress(cells=cells), "mass"))
    column = data["values"].index("1")
    for line in data["blocks"][0]["lines"]:
        assert (line["cells"][column] is None) == (line["usage"] == "naive")


def test_a_story_tells_what_a_verdict_rests_on_and_nothing_that_is_not_known():
    blank = made_up_cell(StressVerdict.WITHIN, value=1.0, **PLACE)
    assert story(dataclasses.replace(blank, steps=0)) == {"Conditions": "linkage m"}
    judgement = dataclasses.replace(
        blank.judgement, reason="why", quantity="Jeq:needle_bar", deviation=2e-3, deviation_limit=1e-3,
        invariant="force_balance", invariant_error=3e-4, invariant_limit=1e-2,
    )  # fmt: skip
    found = story(dataclasses.replace(blank, judgement=judgement, conditions={"mass_factor": 1e4, "link": "crank"}))
    assert found["Reason"] == "why"
    assert found["Worst deviation"].startswith("Jeq of needle bar 2.0e-3, limit 1e-3")
    assert found["Worst invariant"] == "force balance 3.0e-4, limit 1e-2"
    assert found["Conditions"] == "mass factor 1e4, link crank"


def test_the_widget_knows_every_axis_every_sign_and_the_first_map():
    data = widget_data(STRESS, STRESS.axes[0])
    assert tuple(data["axes"]) == STRESS.axes
    assert [sign["word"] for sign in data["signs"]] == [verdict.value for verdict in SIGNS]
    first = data["map"]
    assert first["axis"] == STRESS.axes[0]
    cell = first["blocks"][0]["lines"][0]["cells"][0]
    result = STRESS.results[0]
    assert data["signs"][cell["verdict"]]["word"] == result.verdict.value
    assert cell["command"] == result.cell.command
