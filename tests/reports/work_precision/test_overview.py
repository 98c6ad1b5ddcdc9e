"""The static figure shows every point of every method, marks every setting and names every engine."""

import numpy as np

from comparisons.work_precision.analysis import apart, on_front
from comparisons.work_precision.places import by_regime, places
from comparisons.work_precision.records import METHOD, SETTING, Bench
from reports.work_precision.overview import chart, figures, inks
from reports.work_precision.words import engine_labels
from tests.comparisons.bench_rows import points, sweep_rows
from tests.reports.made_up_bench import document, made_up_bench

BENCH = made_up_bench()
PLACES, INKS = places(BENCH), inks(engine_labels(BENCH))


def _mine(panel, ink):
    return [curve for curve in panel.curves if curve.ink == ink]


def _methods(place, engine):
    return [one for one in place.records if (one.engine, one.quantity, one.kind) == (engine, "Mkr", METHOD)]


def test_a_regime_has_a_figure_and_a_mechanism_a_panel():
    (figure,) = figures(by_regime(PLACES), INKS)
    assert figure.name == "run-up-quintic"
    assert [panel.title for panel in figure.drawing.panels] == ["juki-mf7923d: Mkr", "rimoldi-164: Mkr"]


def test_bold_lines_are_the_fronts_solid_of_single_runs_and_dashed_of_several():
    curves = _mine(chart(PLACES, INKS).panels[0], INKS["alpha"])
    bold = {curve.line: curve for curve in curves if curve.width > 1.5}
    records = _methods(PLACES[0], "alpha")
    for line, part in zip(("-", "--"), apart(records), strict=True):
        assert list(bold[line].y) == [one.error_max for one in on_front(part)]
    assert [curve.name for curve in bold.values()] == ["", "alpha"]


def test_every_point_of_a_method_at_its_own_effort_is_drawn_and_every_setting_marked():
    curves = _mine(chart(PLACES, INKS).panels[0], INKS["alpha"])
    assert sorted(len(curve.x) for curve in curves if curve.marker == ".") == [6, 8]
    assert sorted(curve.marker for curve in curves if not curve.line) == ["*", "o", "s"]


def test_a_floor_is_barred_and_an_order_noted_at_the_least_error():
    records = sweep_rows([1e-1, 1e-2, 1e-3, 1e-3, 1e-3], ratio=10.0, effort=100.0, effort_unit="iterations")
    bench = Bench(document(("m",), ("alpha",)), points(records))
    panel = chart(places(bench), inks(engine_labels(bench))).panels[0]
    assert [list(curve.y) for curve in panel.curves if curve.marker == "_"] == [[1e-3]]
    open_end = chart(PLACES, INKS).panels[0]
    assert "_" not in {curve.marker for curve in open_end.curves}
    assert sorted(note.text for note in open_end.notes) == ["2", "2", "4", "4"]


def test_no_line_joins_settings():
    settings = {one.error_max for one in PLACES[0].records if one.kind == SETTING and one.quantity == "Mkr"}
    curves = chart(PLACES, INKS).panels[0].curves
    assert not [curve for curve in curves if curve.line and settings & {*curve.y}]


def test_the_broad_front_is_that_of_the_ranked_engines_as_a_staircase():
    bench = made_up_bench(control="alpha")
    panel = chart(places(bench)[:1], inks(engine_labels(bench))).panels[0]
    beta = _methods(places(bench)[0], "beta")
    broad = _mine(panel, "reference")
    for curve, part in zip(broad, apart(beta), strict=True):
        front = on_front(part)
        assert list(dict.fromkeys(curve.x)) == list(dict.fromkeys(one.total_seconds for one in front))
        assert np.all((np.diff(curve.x) == 0.0) | (np.diff(curve.y) == 0.0))
    assert "control" in {curve.name for curve in panel.curves}
