"""What to use for an error: winners, merged columns and sentences say what the records say."""

from comparisons.work_precision.analysis import WANTED
from comparisons.work_precision.places import by_regime, places
from comparisons.work_precision.records import Bench
from reports.document.parts import Fold, Table
from reports.work_precision.choices import section, verdicts
from tests.comparisons.bench_rows import points, setting_row
from tests.reports.made_up_bench import document, made_up_bench


def _regimes(*rows, mechanisms=("m",)):
    return by_regime(places(Bench(document(mechanisms, ("alpha", "beta")), points(rows))))


def _columns(row):
    return sum(getattr(cell, "span", 1) for cell in row)


def test_the_winner_of_an_error_is_the_cheapest_engine_of_most_mechanisms():
    rows = [
        setting_row("tuned", 1e-4, seconds, engine=engine, mechanism=mechanism)
        for mechanism, alpha, beta in (("m", 1.0, 2.0), ("n", 1.5, 3.0), ("o", 9.0, 4.0))
        for engine, seconds in (("alpha", alpha), ("beta", beta))
    ]
    (told,) = verdicts(_regimes(*rows, mechanisms=("m", "n", "o")))
    assert told.role == "verdict"
    assert told.words == (
        "The cheapest engine for Mkr in run-up-quintic: to within 1 % of the peak alpha (1.00 s to 1.50 s, on 2 of 3 "
        "mechanisms) or beta (4.00 s, on 1 of 3 mechanisms); to within 1e-3 of the peak alpha (1.00 s to 1.50 s, on "
        "2 of 3 mechanisms) or beta (4.00 s, on 1 of 3 mechanisms); to within 1e-6 of the peak none."
    )


def test_the_control_never_wins():
    assert all("alpha" not in told.words for told in verdicts(by_regime(places(made_up_bench(control="alpha")))))


def test_what_an_engine_says_of_several_errors_is_one_cell():
    whole, note = section(_regimes(setting_row("tuned", 1e-9, 0.5)), "as measured").parts
    ((_, _, cell),) = whole.rows
    assert note.words == "as measured"
    assert (cell.words, cell.note, cell.span) == ("500 ms", "tuned", len(WANTED))


def test_what_an_engine_does_not_reach_says_how_near_it_comes():
    whole, *_ = section(_regimes(setting_row("tuned", 3e-4, 0.5), setting_row("best", 2e-6, 0.9)), "").parts
    ((regime, label, *found),) = whole.rows
    assert (regime, label) == ("run-up-quintic", "alpha")
    assert [(cell.words, cell.span) for cell in found] == [("500 ms", 2), ("900 ms", 2), ("–", 3)]
    assert found[-1].note == "least 2.0e-6"


def test_every_mechanism_has_a_row_an_engine_as_long_as_the_head():
    whole, fold, _ = section(by_regime(places(made_up_bench())), "").parts
    assert isinstance(fold, Fold)
    (table,) = fold.parts
    assert isinstance(table, Table)
    assert [row[:2] for row in table.rows] == [
        ("juki-mf7923d, run-up-quintic", "alpha"), ("", "beta"), ("rimoldi-164, run-up-quintic", "alpha"), ("", "beta"),
    ]  # fmt: skip
    assert all(_columns(row) == len(WANTED) + 2 for row in (*whole.rows, *table.rows))
