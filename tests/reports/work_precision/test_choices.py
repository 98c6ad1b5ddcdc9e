"""What to use for an error: winners, merged columns and sentences say what the records say."""

from comparisons.work_precision.analysis import WANTED
from comparisons.work_precision.records import Bench
from reports.document.parts import Bullets, Fold, Table
from reports.work_precision.choices import section, winners
from tests.comparisons.bench_rows import points, setting_row
from tests.reports.made_up_bench import document, made_up_bench


def _bench(*rows, mechanisms=("m",)):
    return Bench(document(points(rows), mechanisms, ("alpha", "beta")))


def _columns(row):
    return sum(getattr(cell, "span", 1) for cell in row)


def test_the_winner_of_an_error_is_the_cheapest_engine_of_most_mechanisms():
    rows = [
        setting_row("tuned", 1e-4, seconds, engine=engine, mechanism=mechanism)
        for mechanism, alpha, beta in (("m", 1.0, 2.0), ("n", 1.5, 3.0), ("o", 9.0, 4.0))
        for engine, seconds in (("alpha", alpha), ("beta", beta))
    ]
    ((regime, first, *others),) = winners(_bench(*rows, mechanisms=("m", "n", "o"))).rows
    assert regime == "run-up-quintic"
    assert first.words == "alpha in 2 of 3 mechanisms"
    assert first.note == "1.00 s to 1.50 s, tuned; beta in 1"
    assert [cell.words for cell in others] == ["none", "none"]


def test_the_control_never_wins():
    table = winners(made_up_bench(control="alpha"))
    assert all("alpha" not in cell.words + cell.note for row in table.rows for cell in row[1:])


def test_an_engine_that_says_the_same_of_every_error_is_one_sentence():
    parts = section(_bench(setting_row("tuned", 1e-9, 0.5))).parts
    (told,) = (part for part in parts if isinstance(part, Bullets))
    assert told.items == ("alpha, every error down to 1e-8: 500 ms, tuned.",)
    assert not any(isinstance(part, Table) for part in parts)


def test_what_an_engine_does_not_reach_says_how_near_it_comes():
    cells = [setting_row("tuned", 3e-4, 0.5), setting_row("best", 2e-6, 0.9)]
    (table,) = (part for part in section(_bench(*cells)).parts if isinstance(part, Table))
    ((label, *found),) = table.rows
    assert label == "alpha"
    assert [(cell.words, cell.span) for cell in found] == [("500 ms", 2), ("900 ms", 2), ("–", 3)]
    assert found[-1].note == "least 2.0e-6"


def test_every_mechanism_has_a_row_an_engine_as_long_as_the_head():
    bench = made_up_bench()
    (fold,) = (part for part in section(bench).parts if isinstance(part, Fold))
    (table,) = fold.parts
    assert [row[:2] for row in table.rows] == [
        ("juki-mf7923d", "alpha"), ("", "beta"), ("rimoldi-164", "alpha"), ("", "beta"),
    ]  # fmt: skip
    assert all(_columns(row) == len(table.head) == len(WANTED) + 2 for row in table.rows)
