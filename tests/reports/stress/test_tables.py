"""The summary and the tables of a stress test say what its cells say."""

from comparisons.stress.cell_result import StressVerdict
from reports.document.parts import as_text
from reports.stress.facts import SIGNS, axis_title
from reports.stress.tables import MOST_ALONE, border_table, count_table, incident_table, ranking, summary, verdict_facts
from tests.reports.made_up_stress import border, made_up_cell, made_up_stress

STRESS = made_up_stress()
PLACE = {"axis": "mass", "row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}


def cells_of(verdicts, **changes):
    """A stress test of one line."""
    found = [made_up_cell(one, value=10.0**n, **{**PLACE, **changes}) for n, one in enumerate(verdicts)]
    return made_up_stress(cells=found, borders=[])


def test_every_verdict_is_counted_and_explained():
    rows = dict(verdict_facts(STRESS).rows)
    assert list(rows) == [f"{sign.symbol} {verdict.value}" for verdict, sign in SIGNS.items()]
    for verdict, sign in SIGNS.items():
        count = sum(one.verdict is verdict for one in STRESS.results)
        assert rows[f"{sign.symbol} {verdict.value}"] == f"{count}: {sign.meaning}"


def test_none_missed_is_said_too():
    fine = cells_of([StressVerdict.WITHIN])
    assert dict(verdict_facts(fine).rows)["✗ missed"].startswith("0: ")
    assert "flagged 0 of them and missed 0. False alarms: 0." in summary(fine, "stress_outcome")
    assert summary(fine, "stress_verdict").startswith("No wrong motion goes unnoticed")


def test_what_is_missed_is_the_verdict():
    found = cells_of([StressVerdict.MISSED, StressVerdict.CAUGHT, StressVerdict.MISSED, StressVerdict.ALARM])
    assert summary(found, "stress_verdict").startswith("Wrong motions that no check flagged: 2: 3 runs")
    assert summary(found, "stress_verdict").endswith("flagged 1; 1 false alarm.")


def test_engines_are_ranked_by_what_they_accept_at_the_tuned_setting():
    within, over, refused = StressVerdict.WITHIN, StressVerdict.OVER, StressVerdict.UNSUPPORTED
    parts = [
        cells_of([within, over]),
        cells_of([within, refused], engine="beta"),
        cells_of([refused], engine="gamma"),
        cells_of([over] * 3, usage="naive"),
    ]
    found = made_up_stress(cells=[one for part in parts for one in part.cells], borders=[])
    assert ranking(found).endswith("that an engine accepts: beta 1 of 1, alpha 1 of 2.")
    assert ranking(parts[2]) == ""
    assert ranking(parts[3]).endswith("alpha 0 of 3.")


def test_a_border_says_what_is_beyond_and_leaves_out_what_it_shares_with_the_one_before():
    both = [border(1e-3, 7.234e-4, "over limit", **PLACE), border(1e4, 1.2e4, "missed", **PLACE)]
    table = border_table(made_up_stress(borders=both), axis_title)
    assert [(*row[:-1], row[-1].words) for row in table.rows] == [
        (axis_title("mass"), *list(PLACE.values())[1:], "0.001, over limit at 7.23e-4"),
        ("", "", "", "", "1e4, missed at 12000"),
    ]


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
