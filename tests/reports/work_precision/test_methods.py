"""Orders, floors and standings have a row a method or setting and a column a mechanism and regime."""

from comparisons.work_precision.places import by_regime, places
from reports.document.parts import Fold, Table
from reports.work_precision.methods import method_section, setting_section
from tests.reports.made_up_bench import made_up_bench


def _rows(table):
    """Cells by engine and row; an engine is named in its first row alone."""
    found, engine = {}, ""
    for name, row, *cells in table.rows:
        engine = name or engine
        found[engine, row] = cells
    return found


def test_a_setting_stands_beside_the_cheapest_method_at_its_error():
    (table,) = setting_section(by_regime(places(made_up_bench())), 0.1).parts
    assert isinstance(table, Table)
    rows = _rows(table)
    assert {row for _, row in rows} == {"naive", "tuned", "best"}
    first = {row: rows["alpha", row][0] for row in ("naive", "tuned", "best")}
    assert first["naive"].note == "no solution"
    assert first["best"].note == "nearer than any method"
    assert (first["tuned"].words, first["tuned"].note) == ("4.0e-4 in 17.0 ms", "on the front")
    assert "plain takes 15.8 ms" in first["tuned"].told


def test_orders_and_least_errors_stand_side_by_side_by_regime_and_mechanism():
    bench = made_up_bench(regimes=("run-up", "own"))
    orders, what = method_section(by_regime(places(bench)), bench.document["methods"]).parts
    assert isinstance(orders, Fold)
    assert isinstance(what, Fold)
    (table,) = orders.parts
    assert table.groups == (("", 2), ("regime run-up", 2), ("regime own", 2))
    rows = _rows(table)
    assert set(rows) == {(engine, way) for engine in ("alpha", "beta") for way in ("plain", "higher x2")}
    assert {cell.words for cell in rows["alpha", "plain"]} == {"order 2.0"}
    assert {cell.words for cell in rows["alpha", "higher x2"]} == {"order 4.0"}
    assert all("still falling" in cell.note and "floor" not in cell.note for cell in rows["alpha", "plain"])


def test_the_control_is_held_against_nothing():
    (table,) = setting_section(by_regime(places(made_up_bench(control="alpha"))), 0.1).parts
    assert {engine for engine, _ in _rows(table)} == {"beta"}
