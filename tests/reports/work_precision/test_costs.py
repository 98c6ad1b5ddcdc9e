"""The table of costs says what was measured, on a page and on a terminal."""

from dataclasses import replace

from comparisons.work_precision.records import MeasuredCost
from reports.document.terminal import rendered
from reports.work_precision.costs import cost_section, cost_table


def _run(engine, reduction, least, outcome="finished", reason=""):
    about = f"about {reduction}"
    seconds, stepping = (3.0 * least, least, 2.0 * least), (0.5 * least, 0.25 * least, 0.75 * least)
    return MeasuredCost("made-up", "base", engine, reduction, about, outcome, reason, seconds, stepping, 1400)


COSTS = (
    _run("first", "everything", 0.05),
    _run("first", "Jeq <alone>", 0.02),
    _run("second", "everything", 2.0),
    _run("second", "Jeq <alone>", 0.0, "unsupported", "it will not"),
)


def test_scenes_stand_down_and_engines_across_each_with_its_share_of_the_whole():
    _, table = cost_section(COSTS).parts
    assert table.head == ("scene", "first", "second")
    (_, whole, _), (name, part, failed) = table.rows
    assert (whole.words, whole.tooltip) == ("50.0 ms (100 %)", "median 100 ms; stepping 12.5 ms, 1400 steps")
    assert (name, part.words) == ("Jeq <alone>", "20.0 ms (40 %)")
    assert (failed.words, failed.tooltip) == ("unsupported", "it will not")
    assert "made-up (base)" in table.caption
    assert "3 runs" in table.caption
    assert "Jeq <alone>: about Jeq <alone>" in table.note
    assert "second, Jeq <alone>: it will not." in table.note


def test_the_control_is_named_and_stands_after_the_engines():
    table = cost_table([replace(cost, is_control=cost.solver == "first") for cost in COSTS])
    assert table.head == ("scene", "second", "first (control)")


def test_a_terminal_of_100_columns_holds_it_uncut():
    text = rendered(cost_table(COSTS), width=100)
    assert max(map(len, text.splitlines())) <= 100
    assert "Jeq <alone> 20.0 ms (40 %) unsupported" in " ".join(text.split())
