"""The stability maps, their page, tables and terminal: every cell with its verdict, reason and command."""

import dataclasses
import re

import pytest

from comparisons.trials.stress.cells import StressVerdict
from reports.document import html
from reports.document.terminal import rendered
from reports.stress import (
    MOST_OPEN,
    OPEN,
    SIGNS,
    cell_facts,
    incident_table,
    map_data,
    page,
    printout,
    summary,
)
from tests.made_up import made_up_cell, made_up_stress

STRESS = made_up_stress()
PLACE = {"axis": "mass", "row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}


@pytest.mark.parametrize("axis", STRESS.axes)
def test_every_cell_of_an_axis_stands_on_its_map_once_at_its_value(axis):
    found = map_data(STRESS, axis)
    placed = {}
    for block in found["blocks"]:
        for line in block["lines"]:
            for value, cell in zip(STRESS.columns[axis], line["cells"], strict=True):
                if cell:
                    key = f"{axis}/{block['row']}/{value:.6g}/{line['engine']}/{line['usage']}"
                    assert cell["command"] == f"linkproof stress '{key}'"
                    placed[key] = list(SIGNS)[cell["verdict"]]
    assert placed == {one.key: one.verdict for one in STRESS.results if one.axis == axis}


def test_a_story_tells_what_a_verdict_rests_on_and_nothing_that_is_not_known():
    blank = made_up_cell(StressVerdict.WITHIN, value=1.0, **PLACE)
    assert cell_facts(dataclasses.replace(blank, steps=0)) == {"Conditions": "linkage m"}
    known = dataclasses.replace(
        blank,
        reason="why",
        errors=(blank.blank._replace(quantity="Jeq:needle_bar", error_max=2e-3, limit=1e-3),),
        invariants=(blank.blank._replace(quantity="force_balance", error_max=3e-4, limit=1e-2),),
        differing={"mass_factor": 1e4, "link": "crank"},
    )
    found = cell_facts(known)
    assert found["Reason"] == "why"
    assert found["Worst deviation, over the peak"] == "Jeq of needle bar 2.0e-3, limit 1e-3"
    assert found["Worst invariant"] == "force balance 3.0e-4, limit 1e-2"
    assert found["Conditions"] == "mass factor 1e4; link crank"


def cells_of(verdicts, **changes):
    """A stress test of one line."""
    found = [made_up_cell(one, value=10.0**n, **{**PLACE, **changes}) for n, one in enumerate(verdicts)]
    return made_up_stress(cells=found)


def test_what_is_missed_is_the_verdict():
    found = cells_of([StressVerdict.MISSED, StressVerdict.CAUGHT, StressVerdict.MISSED, StressVerdict.ALARM])
    assert summary(found, "stress_verdict").startswith("Wrong motions that no check flagged: 2: 3 runs")
    assert summary(found, "stress_verdict").endswith("flagged 1; 1 false alarm.")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    return folder / html.write(page(STRESS), folder, [])[0]


@pytest.fixture(scope="module")
def text(written):
    return written.read_text(encoding="utf-8")


def test_what_was_missed_raised_or_crashed_stands_open_with_its_reason_and_command(text):
    for verdict in (*OPEN, StressVerdict.CAUGHT):
        cells = STRESS.of(verdict)
        (fold,) = re.findall(rf"<details( open)?>\s*<summary>{verdict.value.capitalize()} \({len(cells)}\)", text)
        assert bool(fold) == (verdict in OPEN and len(incident_table(cells).rows) <= MOST_OPEN)
    (missed, *_) = STRESS.of(StressVerdict.MISSED)
    assert missed.command.replace("'", "&#39;") in text
    assert "velocity of &lt;rod&gt; off" in text
    assert "<rod>" not in text
    assert "a &lt;folder&gt;" in text


def told(stress, width=100):
    tables, closing, _ = printout(stress)
    return rendered(*tables, *closing, width=width)


def test_the_terminal_has_counts_borders_and_what_was_missed():
    text = told(STRESS)
    assert max(map(len, text.splitlines())) <= 100
    assert text.count("missed: ") == len(STRESS.of(StressVerdict.MISSED))
    assert text.count("alarm: ") == len(STRESS.of(StressVerdict.ALARM))
    assert "✗ missed" in text
    assert "last within, first beyond" in text
    assert "last within" not in told(cells_of([StressVerdict.WITHIN]))
