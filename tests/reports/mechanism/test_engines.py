"""The half of a mechanism's page that shows how the engines did: tables, curves, every error at a glance."""

import json

import numpy as np
import pytest

from comparisons.motion.thinning import EXTREMES, WORST
from comparisons.trials.judging.records import Verdict
from engines.contract import Setting
from reports.document.packed import packed
from reports.document.parts import Table, TableCell
from reports.mechanism.engines import (
    chart_data,
    curves,
    errors_chart,
    errors_figure,
    errors_section,
)
from reports.records import share, views
from tests.made_up import changed_results, made_up_results, unpacked


@pytest.fixture(scope="module")
def results():
    return made_up_results(
        engines=("alpha", "beta", "gone"),
        broken={"gone": Verdict.UNSUPPORTED},
        regimes=("run-up", "run-up-quintic"),
        samples=201,
        quantities=("Mkr", "Jeq"),
    )


def words(cell):
    return cell.words if isinstance(cell, TableCell) else cell


def test_one_chart_holds_every_regime_and_loads_what_it_does_not_show(results):
    chart = errors_chart(views(results)[0])
    assert [regime["name"] for regime in chart.data["regimes"]] == ["run-up", "run-up-quintic"]
    assert {chart.data["first"], *chart.further} == {"0-0", "0-1", "1-0", "1-1"}
    assert chart.data["first"] not in chart.further


def test_the_table_has_quantities_down_and_runs_by_engine_across(results):
    (view,) = views(results)
    table, reasons = errors_section(view, view.regimes[0]).parts
    assert isinstance(table, Table)
    assert table.groups == (("", 2), ("alpha", 3), ("beta", 3))
    assert [words(row[0]) for row in table.rows][:2] == [
        "Jeq reduced moment of inertia, with the masses of the file",
        "Mkr crank torque",
    ]
    by_run = {(r.engine, r.setting): r for r in view.of(view.regimes[0]) if r.quantity == "Mkr"}
    torque = dict(zip([("alpha", s.value) for s in Setting], table.rows[1][2:5], strict=True))
    for run, cell in torque.items():
        assert float(words(cell).split()[0]) == pytest.approx(by_run[run].error_max, rel=0.06)
        assert ("✗" in words(cell)) == (by_run[run].outcome != Verdict.PASSED.value)
    assert reasons.items[0] == "gone naive, tuned, best: gone <cannot> hold this scene."


CHECK = "run 'linkproof engines beta --check'"


@pytest.mark.parametrize(
    ("setting", "cure"),
    [
        ("best", f"{CHECK}, and if it passes shorten the step or give its solver more iterations"),
        ("naive", "the engine's default step or softness leaves this error: use the setting tuned"),
    ],
)
def test_a_run_over_its_limits_has_a_remedy(results, setting, cure):
    def fail(record):
        is_over = (record.engine, record.setting, record.quantity) == ("beta", setting, "Mkr")
        return record._replace(outcome=Verdict.OVER_LIMIT.value if is_over else "passed")

    (view,) = views(changed_results(results, fail))
    _, reasons = errors_section(view, view.regimes[0]).parts
    assert [item for item in reasons.items if item.startswith("beta ")] == [f"beta {setting}: {cure}."]


# Curves of runs, thinned and packed for the page's chart.


@pytest.fixture(scope="module")
def view():
    results = made_up_results(
        engines=("beta", "alpha"),
        broken={"alpha": Verdict.UNSUPPORTED},
        regimes=("run-up", "run-up-quintic"),
        samples=3001,
        quantities=("Mkr", "Jeq"),
    )
    return views(results)[0]


def test_a_run_keeps_its_largest_error_and_where_it_is(view):
    regime = view.regimes[1]
    (data,) = (one for key, one in curves(view).items() if key == f"1-{view.quantities(regime).index('Mkr')}")
    assert {(run["engine"], run["setting"]) for run in data["runs"]} == {("beta", s.value) for s in Setting}
    for run, trace in zip(data["runs"], view.traces(regime, "Mkr"), strict=True):
        time, value, decade = unpacked(run["samples"])
        assert len(time) <= WORST + 2 * EXTREMES + 2
        worst = np.argmax(decade)
        assert 10.0 ** decade[worst] == pytest.approx(trace.record.error_max, rel=1e-2)
        assert time[worst] == pytest.approx(trace.record.worst_time, abs=1e-4)
        furthest = trace.observed[np.nanargmax(trace.error)]
        assert value[worst] == pytest.approx(furthest, abs=1e-4 * trace.record.peak)


def test_a_packed_column_has_its_ends_exactly_and_nothing_where_it_is_not_finite():
    columns = np.array([[1.0, np.inf, -3.0, 2.5], [np.nan] * 4, [7.0] * 4])
    found = unpacked(packed(*columns))
    np.testing.assert_allclose(found, np.where(np.isfinite(columns), columns, np.nan), atol=1e-4)
    assert (np.nanmin(found[0]), np.nanmax(found[0])) == (-3.0, 2.5)


def test_the_chart_has_every_error_and_names_the_quantities_with_curves(view):
    data = chart_data(view)
    json.dumps(data, allow_nan=False)
    assert data["engines"] == ["alpha", "beta"]  # the place, and so the colour, of one that gave nothing is kept
    for number, (regime, found) in enumerate(zip(view.regimes, data["regimes"], strict=True)):
        assert len(found["errors"]) == sum(record.error_max is not None for record in view.of(regime))
        with_curves = {f"{number}-{place}" for place, one in enumerate(found["quantities"]) if one["curves"]}
        assert with_curves == {key for key in curves(view) if key.startswith(f"{number}-")}
        for quantity, engine, setting, size, limit in found["errors"]:
            name = view.quantities(regime)[quantity]
            (record,) = (
                r for r in view.of(regime)
                if (r.quantity, r.engine, r.setting) == (name, data["engines"][engine], data["settings"][setting])
            )  # fmt: skip
            assert (size, limit) == (pytest.approx(record.error_max, rel=0.06), record.limit)


# Every error at a glance.


def test_every_record_has_a_dot_in_its_row():
    (view,) = views(made_up_results(samples=51))
    (axes,) = errors_figure(view, view.regimes[0]).axes
    dots = [line for line in axes.lines if not line.get_label().startswith("_")]
    assert sum(len(line.get_xdata()) for line in dots) == len(view.records)
    worst = max(map(share, view.records))
    rows = {axes.get_yticklabels()[round(y)].get_text() for line in dots for x, y in line.get_xydata() if x == worst}
    assert rows == {r.quantity.replace("_", " ") for r in view.records if share(r) == worst}
