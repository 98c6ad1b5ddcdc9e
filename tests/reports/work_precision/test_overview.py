"""The static figure shows every point of every method, marks every setting and names every engine."""

import numpy as np

from comparisons.work_precision.analysis import apart, on_front
from comparisons.work_precision.places import by_regime, places
from reports.work_precision.overview import chart, figures, inks
from reports.work_precision.words import engine_labels
from tests.reports.made_up_bench import made_up_bench

BENCH = made_up_bench()
PLACES, INKS = places(BENCH), inks(engine_labels(BENCH))


def _mine(panel, ink):
    return [curve for curve in panel.curves if curve.ink == ink]


def test_a_regime_has_a_figure_and_a_mechanism_a_panel():
    (figure,) = figures(by_regime(PLACES), INKS)
    assert figure.name == "run-up-quintic"
    assert [panel.title for panel in figure.drawing.panels] == ["juki-mf7923d: Mkr", "rimoldi-164: Mkr"]


def test_bold_lines_are_the_fronts_solid_of_single_runs_and_dashed_of_several():
    curves = _mine(chart(PLACES, INKS).panels[0], INKS["alpha"])
    bold = {curve.line: curve for curve in curves if curve.width > 1.5}
    records = [one for one in PLACES[0].records if one.engine == "alpha" and one.quantity == "Mkr"]
    for line, part in zip(("-", "--"), apart(records), strict=True):
        assert list(bold[line].y) == [one.error_max for one in on_front(part)]
    assert [curve.name for curve in bold.values()] == ["", "alpha"]


def test_every_point_of_a_method_at_its_own_effort_is_drawn_and_every_setting_marked():
    curves = _mine(chart(PLACES, INKS).panels[0], INKS["alpha"])
    assert sorted(len(curve.x) for curve in curves if curve.marker == ".") == [6, 8]
    assert sorted(curve.marker for curve in curves if not curve.line) == ["*", "o", "s"]


def test_the_broad_front_is_that_of_the_ranked_engines_as_a_staircase():
    bench = made_up_bench(control="alpha")
    panel = chart(places(bench)[:1], inks(engine_labels(bench))).panels[0]
    beta = [one for one in places(bench)[0].records if one.engine == "beta" and one.quantity == "Mkr"]
    broad = _mine(panel, "reference")
    for curve, part in zip(broad, apart(beta), strict=True):
        front = on_front(part)
        assert list(dict.fromkeys(curve.x)) == list(dict.fromkeys(one.total_seconds for one in front))
        assert np.all((np.diff(curve.x) == 0.0) | (np.diff(curve.y) == 0.0))
    assert "control" in {curve.name for curve in panel.curves}
