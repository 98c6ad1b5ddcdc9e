"""Every error at a glance."""

import numpy as np

from comparisons.judging.records import Verdict
from comparisons.stress.verdict import ALARMS as INVARIANTS
from reports.charts import draw
from reports.charts.judged import MARKERS, errors_chart
from reports.records.views import views
from tests.reports.drawn_words import texts
from tests.reports.made_up_results import made_up_results


def panel_of(**more):
    (view,) = views(made_up_results(samples=51, **more))
    chart = errors_chart(view, view.regimes[0])
    (panel,) = chart.panels
    return view, chart, panel


def test_rows_are_quantities_then_invariants_and_engines_that_ran_are_named():
    _, chart, panel = panel_of(
        engines=("alpha", "beta", "gamma"), broken={"gamma": Verdict.UNSUPPORTED}, quantities=("Mkr", "Jeq")
    )
    rows = ("Jeq", "Mkr", *(name.replace("_", " ") for name in INVARIANTS))
    assert panel.rows == rows
    names = [curve.name for curve in panel.curves if curve.name]
    assert names == ["alpha", "beta", "naive", "tuned", "best", "limit (tuned)"]
    figure = draw.figure(chart)
    (axes,) = figure.axes
    assert {*rows, *names} <= set(texts(figure))
    assert axes.get_ylim() == (len(rows) - 0.5, -0.5)


def test_every_record_has_a_dot_in_its_row_and_those_of_the_view_s_setting_a_limit():
    view, _, panel = panel_of()
    dots = [curve for curve in panel.curves if curve.marker in MARKERS]
    assert sum(len(curve.x) for curve in dots) == len(view.records)
    (limits,) = [curve for curve in panel.curves if curve.marker == "|"]
    assert len(limits.x) == sum(record.setting == "tuned" for record in view.records)
    worst = max(record.error_max for record in view.records)
    (place,) = {curve.y[np.argmax(curve.x)] for curve in dots if max(curve.x, default=0.0) == worst}
    assert panel.rows[round(place)] in {r.quantity.replace("_", " ") for r in view.records if r.error_max == worst}
