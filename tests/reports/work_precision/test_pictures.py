"""A benchmark's diagram, static figures and page."""

import re

import pytest

from comparisons.work_precision.analysis import by_regime, on_front, places, split_by_runs
from comparisons.work_precision.records import METHOD, Bench, load, save
from reports.document import html
from reports.work_precision.page import chart, inks, page, widget
from reports.work_precision.words import engine_labels
from tests.comparisons.bench_rows import points, sweep_rows
from tests.reports.made_up_bench import document, made_up_bench, nothing_finished

BENCH = made_up_bench()


def _widget(bench=BENCH):
    return widget(by_regime(places(bench)), engine_labels(bench))


def _held(data):
    return [(sweep, point) for sweep in data["sweeps"] for point in sweep["points"]]


def test_every_finished_record_of_every_place_is_there_once():
    made = _widget()
    found = [made.data["first"], *made.further.values()]
    assert [key for key, _ in made.data["places"]][1:] == list(made.further)
    for place, data in zip(places(BENCH), found, strict=True):
        for name in place.quantities:
            errors = [point["errors"][name][1] for _, point in _held(data) if name in point["errors"]]
            wanted = [float(f"{one.error_max:.4g}") for one in place.records if one.quantity == name and one.finished]
            assert sorted(errors) == sorted(wanted)


PLACES, INKS = places(BENCH), inks(engine_labels(BENCH))


def _mine(panel, ink):
    return [curve for curve in panel.curves if curve.ink == ink]


def _methods(place, engine):
    return [one for one in place.records if (one.engine, one.quantity, one.kind) == (engine, "Mkr", METHOD)]


def test_bold_lines_are_the_fronts_solid_of_single_runs_and_dashed_of_several():
    curves = _mine(chart(PLACES, INKS).panels[0], INKS["alpha"])
    bold = {curve.line: curve for curve in curves if curve.width > 1.5}
    records = _methods(PLACES[0], "alpha")
    for line, part in zip(("-", "--"), split_by_runs(records), strict=True):
        assert list(bold[line].y) == [one.error_max for one in on_front(part)]
    assert [curve.name for curve in bold.values()] == ["", "alpha"]


def test_a_floor_is_barred_and_an_order_noted_at_the_least_error():
    records = sweep_rows([1e-1, 1e-2, 1e-3, 1e-3, 1e-3], ratio=10.0)
    bench = Bench(document(("m",), ("alpha",)), points(records))
    panel = chart(places(bench), inks(engine_labels(bench))).panels[0]
    assert [list(curve.y) for curve in panel.curves if curve.marker == "_"] == [[1e-3]]
    open_end = chart(PLACES, INKS).panels[0]
    assert "_" not in {curve.marker for curve in open_end.curves}
    assert sorted(note.text for note in open_end.notes) == ["2", "2", "4", "4"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the page of a benchmark that was saved."""
    found = tmp_path_factory.mktemp("bench")
    save(found, BENCH)
    html.write(page(load(found)), found, ())
    return found


def test_what_engines_say_is_escaped_and_nothing_is_fetched(folder):
    text = (folder / "bench.html").read_text(encoding="utf-8")
    assert "the joints &lt;gave&gt; way" in text
    assert "what &lt;plain&gt; does" in text
    assert not re.search(r"<(gave|made up|plain)>", text)
    assert "NaN" not in text
    assert not re.search(r"(src|href)=\"https?:", text)


def test_a_benchmark_that_gave_nothing_has_a_page_that_says_why(tmp_path):
    file, *_ = html.write(page(nothing_finished()), tmp_path, ())
    text = (tmp_path / file).read_text(encoding="utf-8")
    assert "Nothing finished" in text
    assert "gamma: unavailable: not installed" in text
