"""Every error at a glance."""

import numpy as np

from reports.mechanism.engines import MARKERS, errors_chart
from reports.records import views
from tests.reports.made_up_results import made_up_results


def panel_of(**more):
    (view,) = views(made_up_results(samples=51, **more))
    chart = errors_chart(view, view.regimes[0])
    (panel,) = chart.panels
    return view, chart, panel


def test_every_record_has_a_dot_in_its_row_and_those_of_the_view_s_setting_a_limit():
    view, _, panel = panel_of()
    dots = [curve for curve in panel.curves if curve.marker in MARKERS]
    assert sum(len(curve.x) for curve in dots) == len(view.records)
    (limits,) = [curve for curve in panel.curves if curve.marker == "|"]
    assert len(limits.x) == sum(record.setting == "tuned" for record in view.records)
    worst = max(record.error_max for record in view.records)
    (place,) = {curve.y[np.argmax(curve.x)] for curve in dots if max(curve.x, default=0.0) == worst}
    assert panel.rows[round(place)] in {r.quantity.replace("_", " ") for r in view.records if r.error_max == worst}
