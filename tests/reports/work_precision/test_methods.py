"""Orders, floors and standings have a row a method or setting and a column a mechanism and regime."""

from comparisons.work_precision.places import by_regime, places
from comparisons.work_precision.records import Bench
from reports.document.parts import Fold, Table
from reports.work_precision.methods import method_section
from tests.comparisons.bench_rows import points, setting_row
from tests.reports.made_up_bench import document, made_up_bench


def _rows(table):
    """Cells by engine and the name of a row; an engine is named in its first row alone."""
    found, engine = {}, ""
    for name, row, *cells in table.rows:
        engine = name or engine
        found[engine, row.words] = cells
    return found


def _section(bench):
    return method_section(by_regime(places(bench)), bench.document["methods"], 0.1)


def test_a_setting_stands_beside_the_cheapest_method_at_its_error():
    table, _ = _section(made_up_bench()).parts
    assert isinstance(table, Table)
    rows = _rows(table)
    assert {row for _, row in rows} == {"naive", "tuned", "best"}
    first = {row: rows["alpha", row][0] for row in ("naive", "tuned", "best")}
    assert first["naive"].note == "no solution"
    assert first["best"].note == "no method measured gets there"
    assert (first["tuned"].words, first["tuned"].note) == (
        "4.0e-4\u00a0in\u00a017.0\u00a0ms",
        "on the front of single runs",
    )
    assert "plain takes 15.8 ms" in first["tuned"].tooltip


def test_settings_alone_are_held_against_nothing_which_is_said_once():
    settings = [setting_row(name, 1e-4, 0.5) for name in ("tuned", "best")]
    bench = Bench(document(("m",), ("alpha",)), points(settings))
    (table,) = _section(bench).parts
    assert "No method was measured" in table.caption
    assert {cell.note for _, (cell,) in _rows(table).items()} == {""}


def test_orders_and_least_errors_stand_side_by_side_by_regime_and_mechanism():
    _, orders = _section(made_up_bench(regimes=("run-up", "own"))).parts
    assert isinstance(orders, Fold)
    (table,) = orders.parts
    assert table.groups == (("", 2), ("regime run-up", 2), ("regime own", 2))
    rows = _rows(table)
    assert set(rows) == {(engine, way) for engine in ("alpha", "beta") for way in ("plain", "higher x2")}
    assert {row[1].note for row in table.rows} == {"what <plain> does", "what <higher> does"}
    assert {cell.words for cell in rows["alpha", "plain"]} == {"order 2.0"}
    assert {cell.words for cell in rows["alpha", "higher x2"]} == {"order 4.0"}
    assert all("still falling" in cell.note and "floor" not in cell.note for cell in rows["alpha", "plain"])


def test_the_control_is_held_against_nothing():
    table, _ = _section(made_up_bench(control="alpha")).parts
    assert {engine for engine, _ in _rows(table)} == {"beta"}
