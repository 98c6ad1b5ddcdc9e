"""Curves of runs, thinned and packed for the page's chart."""

import base64
import json

import numpy as np
import pytest

from comparisons.judging.records import Verdict
from engines.contract import Setting
from reports.mechanism.engines import STRETCHES, chart_data, curves
from reports.records import views
from tests.reports.made_up_results import made_up_results


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


def unpacked(run):
    """Columns as the page's script reads them."""
    return np.frombuffer(base64.b64decode(run["samples"]), "<f4").reshape(3, -1)


def test_a_run_keeps_its_largest_error_and_where_it_is(view):
    regime = view.regimes[1]
    (data,) = (one for key, one in curves(view).items() if key == f"1-{view.quantities(regime).index('Mkr')}")
    assert {(run["engine"], run["setting"]) for run in data["runs"]} == {("beta", s.value) for s in Setting}
    for run, trace in zip(data["runs"], view.traces(regime, "Mkr"), strict=True):
        time, value, decade = unpacked(run)
        assert len(time) <= STRETCHES
        worst = np.argmax(decade)
        assert 10.0 ** decade[worst] == pytest.approx(trace.record.error_max, rel=1e-2)
        assert time[worst] == pytest.approx(trace.record.worst_time, abs=1e-4)
        assert value[worst] == pytest.approx(
            np.interp(time[worst], trace.time, trace.observed), abs=1e-3 * trace.record.peak
        )


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
