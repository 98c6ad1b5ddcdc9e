"""Page, section and terminal tables of the stress maps: complete, escaped, offline; they say what the cells say."""

import json
import re

import pytest

from analytic.errors import LinkproofError
from comparisons.stress.border import Border
from comparisons.stress.verdict import StressVerdict
from reports.document.screen import rendered
from reports.document.tables import markdown
from reports.stress import page as stress_page
from reports.stress.facts import FILE, SIGNS, Stress, load
from reports.stress.figure import border_place, columns, layout, stress_figure
from reports.stress.section import border_table, reach, section, summary, verdict_table
from reports.stress.terminal import cell_details, printout
from tests.reports.made_up_stress import border, made_up_cell, made_up_stress

STRESS = made_up_stress()
PLACE = {"axis": "mass", "row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}


@pytest.fixture(scope="module")
def page():
    return stress_page.page(STRESS)


def told(stress, width=100):
    tables, closing, _ = printout(stress)
    return rendered(*tables, *closing, width=width)


def cells_of(verdicts):
    """A stress test of one line."""
    found = [made_up_cell(one, value=10.0**n, **PLACE) for n, one in enumerate(verdicts)]
    return made_up_stress(cells=[one.document for one in found], borders=[])


def test_every_verdict_occurs_in_what_is_tested_here():
    assert {result.verdict for result in STRESS.results} == set(StressVerdict)


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


def test_the_table_counts_every_cell_once():
    table = verdict_table(STRESS)
    missed = table.head.index("✗ missed")
    assert table.bold == missed
    assert [row[0] for row in table.rows] == ["alpha", "beta", "all"]
    for row in table.rows:
        name = "" if row[0] == "all" else row[0]
        own = [one for one in STRESS.results if name in ("", one.cell.engine)]
        assert int(row[-1]) == len(own) == sum(map(int, row[1:-1]))
        assert int(row[missed]) == sum(one.verdict is StressVerdict.MISSED for one in own)


def test_none_missed_is_said_too():
    fine = cells_of([StressVerdict.WITHIN])
    table = verdict_table(fine)
    assert table.rows[0][table.head.index("✗ missed")] == "0"
    assert "flagged 0 of them and missed 0. False alarms: 0." in summary(fine)
    assert "| **0** |" in markdown(table)


def test_how_far_a_line_goes_is_said_with_what_is_beyond():
    within, over = StressVerdict.WITHIN, StressVerdict.OVER
    line = tuple(PLACE.values())
    assert reach(cells_of([within, within]), line) == "all within"
    assert reach(cells_of([over, StressVerdict.CAUGHT]), line) == "none within: over limit, caught"
    assert reach(cells_of([StressVerdict.UNSUPPORTED] * 2), line) == "–"
    assert reach(cells_of([within, over]), line) == "not narrowed down"
    both = [border(1e-3, 7.234e-4, "over limit", **PLACE), border(1e4, 1.2e4, "missed", **PLACE)]
    found = Stress({**cells_of([within, over]).document, "borders": both})
    assert reach(found, line) == "0.001, over limit at 7.23e-4; 1e4, missed at 12000"
    assert reach(found, ("speed", *line[1:])) == "–"


def test_borders_stand_side_by_side_for_the_engines():
    table = border_table(STRESS, ["mass"])
    assert table.head == ("row", "usage", "alpha", "beta")
    assert len(table.rows) == 5 * 3
    assert border_table(STRESS).head[0] == "axis"
    assert len({row[:3] for row in border_table(STRESS).rows}) == len(border_table(STRESS).rows)
    assert len({len(row) for row in border_table(STRESS).rows}) == 1


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


def test_columns_go_as_the_table_has_them_without_the_runs_of_the_bisection():
    extra = made_up_cell(StressVerdict.OVER, value=0.0123, **PLACE)
    assert columns("mass", [*STRESS.results, extra], quick=False) == tuple(10.0**n for n in range(-6, 7))
    assert columns("mass", STRESS.results, quick=True) == (1e-4, 1.0, 1e4)
    falling = columns("change-point", STRESS.results, quick=False)
    assert list(falling) == sorted(falling, reverse=True)
    assert falling[-1] == 0.0
    assert columns("no such axis", [extra], quick=False) == (0.0123,)


def test_cells_stand_in_the_order_of_the_table_whichever_was_done_first():
    cells = list(reversed(STRESS.document["cells"]))
    found = Stress({**STRESS.document, "cells": cells})
    assert found.results == STRESS.results
    assert found.axes == ("speed", "mass", "change-point")
    assert layout(found, "mass").usages["alpha"] == ("naive", "tuned", "best")
    assert stress_page.page(found) == stress_page.page(STRESS)


def test_every_cell_of_a_map_has_its_sign_and_every_border_its_bar():
    drawing = stress_figure(STRESS, "mass")
    symbols = {sign.symbol for sign in SIGNS.values()}
    signs = [text.get_text() for panel in drawing.axes for text in panel.texts if text.get_text() in symbols]
    mine = [one for one in STRESS.results if one.cell.axis == "mass"]
    assert sorted(signs) == sorted(SIGNS[one.verdict].symbol for one in mine)
    assert [panel.get_title(loc="left") for panel in drawing.axes] == ["alpha", "beta"]
    bars = [line for panel in drawing.axes for line in panel.lines if line.get_linewidth() > 2.0]
    assert len(bars) == sum(one.axis == "mass" for one in STRESS.borders)


def test_engines_with_other_methods_have_their_lines_at_the_same_height():
    plan = layout(STRESS, "speed")
    assert not plan.shared
    assert layout(STRESS, "mass").shared
    assert plan.usages["alpha"] != plan.usages["beta"]
    assert len(plan.tops) == len(plan.rows) == 5


def test_the_page_stands_alone(page):
    assert page.startswith("<!doctype html>")
    assert not re.search(r"(src|href)=\"https?:", page)
    assert "NaN" not in page


def test_every_axis_has_a_map_a_link_and_every_verdict_a_meaning(page):
    for name in STRESS.axes:
        assert f'<section id="stress-{name}"' in page
        assert f'href="#stress-{name}"' in page
        assert f'id="stress-{name}-map-title"' in page
    assert set(SIGNS) == set(StressVerdict)
    for sign in SIGNS.values():
        assert sign.meaning in page


def test_what_was_missed_raised_or_caught_stands_with_its_reason_and_command(page):
    for verdict in (StressVerdict.MISSED, StressVerdict.ALARM, StressVerdict.CAUGHT, StressVerdict.CRASHED):
        for one in STRESS.of(verdict):
            assert one.document["command"].replace("'", "&#39;") in page
    assert "velocity of &lt;rod&gt; off" in page
    assert "<rod>" not in page
    assert "a &lt;folder&gt;" in page


def test_the_page_is_written_and_two_of_one_test_are_the_same_text(page, tmp_path):
    path = stress_page.write(STRESS, tmp_path)
    assert path.name == "stress.html"
    assert path.read_text(encoding="utf-8") == page == stress_page.page(made_up_stress())


def test_the_section_makes_the_missed_bold_and_folds_the_borders_away():
    missed = len(STRESS.of(StressVerdict.MISSED))
    assert missed > 1
    assert f"<strong>{missed}</strong>" in section(STRESS)
    assert "<details>" in section(STRESS)
    assert "<details>" not in section(STRESS, with_borders=False)


def test_the_terminal_has_counts_borders_and_what_was_missed():
    text = told(STRESS)
    assert max(map(len, text.splitlines())) <= 100
    assert text.count("missed: ") == len(STRESS.of(StressVerdict.MISSED))
    assert text.count("alarm: ") == len(STRESS.of(StressVerdict.ALARM))
    assert "✗ missed" in text
    assert "last within, first beyond" in text
    assert "last within" not in told(made_up_stress(borders=[]))


def test_one_cell_is_told_in_full():
    (caught, *_) = STRESS.of(StressVerdict.CAUGHT)
    text = rendered(cell_details(caught))
    assert text.startswith(f"{caught.cell.key}: caught")
    assert caught.judgement.reason in text
    assert "10 steps" in text
    every = rendered(*printout(STRESS).details)
    assert all(result.cell.key in every for result in STRESS.results)
