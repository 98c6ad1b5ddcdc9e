"""The summary and the tables of a stress test say what its cells say."""

from comparisons.stress.saved import Stress
from comparisons.stress.verdict import StressVerdict
from reports.document.parts import as_text
from reports.stress.facts import SIGNS
from reports.stress.tables import (
    MOST_ALONE,
    border_table,
    count_table,
    incident_table,
    ranking,
    reach,
    summary,
    verdict,
    verdict_table,
)
from tests.reports.made_up_stress import border, made_up_cell, made_up_stress

STRESS = made_up_stress()
PLACE = {"axis": "mass", "row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}


def cells_of(verdicts, **changes):
    """A stress test of one line."""
    found = [made_up_cell(one, value=10.0**n, **{**PLACE, **changes}) for n, one in enumerate(verdicts)]
    return made_up_stress(cells=[one.document for one in found], borders=[])


def test_the_table_counts_every_cell_once():
    table = verdict_table(STRESS)
    assert table.head == ("verdict", "alpha", "beta", "all")
    *rows, total = table.rows
    assert [row[0].words for row in rows] == [f"{sign.symbol} {verdict.value}" for verdict, sign in SIGNS.items()]
    for number, name in enumerate(("alpha", "beta", ""), start=1):
        own = [one for one in STRESS.results if name in ("", one.cell.engine)]
        assert int(total[number]) == len(own) == sum(int(row[number]) for row in rows)
        for row, found in zip(rows, SIGNS, strict=True):
            assert int(row[number]) == sum(one.verdict is found for one in own)


def test_none_missed_is_said_too():
    fine = cells_of([StressVerdict.WITHIN])
    assert {row[0].words: row[1] for row in verdict_table(fine).rows[:-1]}["✗ missed"] == "0"
    assert "flagged 0 of them and missed 0. False alarms: 0." in summary(fine)
    assert verdict(fine).startswith("No wrong motion goes unnoticed")


def test_what_is_missed_is_the_verdict():
    found = cells_of([StressVerdict.MISSED, StressVerdict.CAUGHT, StressVerdict.MISSED, StressVerdict.ALARM])
    assert verdict(found).startswith("Wrong motions that no check flagged: 2: 3 runs")
    assert verdict(found).endswith("flagged 1; 1 false alarm.")


def test_engines_are_ranked_by_what_they_accept_at_the_tuned_setting():
    within, over, refused = StressVerdict.WITHIN, StressVerdict.OVER, StressVerdict.UNSUPPORTED
    parts = [
        cells_of([within, over]),
        cells_of([within, refused], engine="beta"),
        cells_of([refused], engine="gamma"),
        cells_of([over] * 3, usage="naive"),
    ]
    found = made_up_stress(cells=[row for part in parts for row in part.document["cells"]], borders=[])
    assert ranking(found).endswith("that an engine accepts: beta 1 of 1, alpha 1 of 2.")
    assert ranking(parts[2]) == ""
    assert ranking(parts[3]).endswith("alpha 0 of 3.")


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
    table = border_table(STRESS)
    assert table.head == ("axis", "row", "usage", "alpha", "beta")
    places = [row[:3] for row in table.rows]
    assert len(set(places)) == len(places)
    assert {(row, usage) for _, row, usage in places} == {(line[1], line[3]) for line in STRESS.lines}


def test_an_axis_is_shaded_where_all_is_within_and_loud_where_one_is_missed():
    within, refused = StressVerdict.WITHIN, StressVerdict.UNSUPPORTED
    styles = [
        count_table(cells_of(verdicts), str).rows[0][1].style
        for verdicts in ([within, refused], [within, StressVerdict.OVER], [refused], [within, StressVerdict.MISSED])
    ]
    assert styles == ["pass", "", "", "failed"]


def test_incidents_stand_alone_or_the_first_of_each_axis_and_engine_with_their_number():
    few = cells_of([StressVerdict.CAUGHT] * 3)
    assert [as_text(row[-1]) for row in incident_table(few.results).rows] == [one.cell.command for one in few.results]
    many = cells_of([StressVerdict.CAUGHT] * (MOST_ALONE + 1))
    ((engine, place, *_, command),) = incident_table(many.results).rows
    assert engine == "alpha"
    assert place.note == f"and {MOST_ALONE} more on this axis"
    assert as_text(command) == many.results[0].cell.command
