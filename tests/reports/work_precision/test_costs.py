"""The tables of costs say what was measured, on a page and on a terminal."""

from dataclasses import replace

import pytest

from comparisons.work_precision.records import MeasuredCost
from reports.document.terminal import rendered
from reports.work_precision.costs import cost_section, cost_tables


def _run(engine, reduction, least, outcome="finished", reason=""):
    about = f"about {reduction}"
    seconds, stepping = (3.0 * least, least, 2.0 * least), (0.5 * least, 0.25 * least, 0.75 * least)
    return MeasuredCost("made-up", "base", engine, reduction, about, 0, outcome, reason, seconds, stepping, 1400)


COSTS = (
    _run("first", "everything", 0.05),
    _run("first", "Jeq <alone>", 0.02),
    _run("second", "everything", 2.0),
    _run("second", "Jeq <alone>", 0.0, "unsupported", "it will not"),
    MeasuredCost("made-up", "base", "numpy", "everything", "S, Jeq", 1000, seconds=(3e-4, 2e-4, 2.5e-4)),
    MeasuredCost("made-up", "base", "numpy", "S", "S", 1000, seconds=(1e-4, 5e-5, 7.5e-5)),
    MeasuredCost("made-up", "base", "compiled", "everything", "S, Jeq", 1000, seconds=(2e-5, 1e-5, 3e-5)),
)


@pytest.fixture(scope="module")
def tables():
    return cost_tables(COSTS)


def test_every_row_stands_beside_the_whole_scene_of_its_engine(tables):
    runs, angles, compiled = tables
    assert [row[:5] for row in runs.rows[:3]] == [
        ("first", "everything", "50.0 ms", "100 ms", "100 %"),
        ("first", "Jeq <alone>", "20.0 ms", "40.0 ms", "40 %"),
        ("second", "everything", "2.00 s", "4.00 s", "100 %"),
    ]
    assert runs.rows[0][5:] == ("12.5 ms", "1400")
    assert list(angles.rows) == [
        ("everything", "200 ns", "250 ns", "100 %"),
        ("S", "50.0 ns", "75.0 ns", "25 %"),
    ]
    assert compiled.rows == (("everything", "10.0 ns", "20.0 ns", "100 %"),)


def test_the_control_is_named_and_stands_below_the_engines():
    (runs,) = cost_tables([replace(cost, is_control=cost.solver == "first") for cost in COSTS[1:4]])
    assert [row[0] for row in runs.rows] == ["second", "second", "first (control)"]


def test_what_an_engine_could_not_do_is_said_with_its_reason(tables):
    assert tables[0].rows[3][1:4] == ("Jeq <alone>", "unsupported", "")
    assert "second, Jeq <alone>: it will not." in tables[0].note


def test_all_rows_are_as_long_as_the_head(tables):
    assert all(len(row) == len(table.head) for table in tables for row in table.rows)


def test_the_leads_say_how_often_and_what(tables):
    assert "made-up (base)" in tables[0].caption
    assert "3 runs" in tables[0].caption
    assert "by NumPy: least and median of 3 evaluations at 1000 angles" in tables[1].caption
    assert "by the compiled path" in tables[2].caption
    assert "Jeq <alone>: about Jeq <alone>" in tables[0].note
    assert tables[1].note == "everything: S, Jeq."


def test_a_page_has_scenes_down_and_engines_across_each_with_its_share_of_the_whole():
    _, runs, queries = cost_section(COSTS).parts
    assert runs.head == ("scene", "first", "second")
    (_, whole, _), (name, part, failed) = runs.rows
    assert (whole.words, whole.note) == ("50.0 ms", "100 %")
    assert (name, part.words, part.note) == ("Jeq <alone>", "20.0 ms", "40 %")
    assert (failed.words, failed.told) == ("unsupported", "it will not")
    assert queries.head == ("requested", "by NumPy", "by the compiled path")
    assert [cell if isinstance(cell, str) else cell.words for cell in queries.rows[1]] == ["S", "50.0 ns", ""]


def test_a_terminal_of_100_columns_holds_it_uncut(tables):
    lines = rendered(*tables, width=100).splitlines()
    assert max(map(len, lines)) <= 100
    for table in tables:
        for row in table.rows:
            assert any(all(cell in line for cell in row) for line in lines)
