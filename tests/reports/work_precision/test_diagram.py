"""The diagram's data hold every point of every quantity, foremost quantity first, one place a file."""

import json

from comparisons.work_precision.places import by_regime, places
from comparisons.work_precision.records import Bench
from reports.work_precision.diagram import widget
from reports.work_precision.overview import LEAST
from reports.work_precision.words import engine_labels
from tests.comparisons.bench_rows import points, row
from tests.reports.made_up_bench import document, made_up_bench

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


def test_the_data_are_json_and_a_quantity_tells_its_unit_and_peak():
    data = _widget().data
    json.dumps(data, allow_nan=False)
    assert data["first"]["quantities"] == [["Mkr", "Mkr", "N m", 0.2], ["joint_force", "joint force", "N m", 0.2]]
    assert data["engines"] == [["alpha", "alpha", 0], ["beta", "beta", 1]]


def test_the_control_is_named_and_muted():
    assert _widget(made_up_bench(control="alpha")).data["engines"][-1] == ["alpha", "alpha (control)", "muted"]


def test_a_sweep_tells_whether_its_effort_is_its_own_and_what_limits_it():
    sweeps = {one["way"]: one for one in _widget().data["first"]["sweeps"] if one["engine"] == "alpha"}
    assert set(sweeps) == {"naive", "tuned", "best x4", "plain", "plain, 10 iterations", "higher x2"}
    assert [way for way, one in sweeps.items() if not one["own"]] == ["plain, 10 iterations"]
    words, order = sweeps["plain"]["ends"]["Mkr"]
    assert "still falling" in words
    assert order == 2.0
    assert sweeps["tuned"]["ends"] == {}
    assert sweeps["best x4"]["runs"] == 4


def test_an_error_of_nought_has_a_place_on_a_logarithmic_axis():
    data = _widget(Bench(document(("m",), ("alpha",)), points([row(error_max=0.0)]))).data["first"]
    ((_, point),) = _held(data)
    assert point["errors"]["Mkr"] == [LEAST, 0.0, 0.0]
