"""A benchmark seen place by place: engines in order, quantities that were measured, methods at their own efforts."""

from comparisons.work_precision.places import by_regime, places
from comparisons.work_precision.records import Bench
from tests.comparisons.bench_rows import points, row
from tests.reports.made_up_bench import document, made_up_bench, nothing_finished


def test_places_stand_in_the_order_measured_with_their_titles():
    found = places(made_up_bench(regimes=("run-up", "own")))
    assert [(one.mechanism, one.regime) for one in found] == [
        ("juki-mf7923d", "run-up"), ("juki-mf7923d", "own"), ("rimoldi-164", "run-up"), ("rimoldi-164", "own"),
    ]  # fmt: skip
    assert found[0].title == "The juki-mf7923d"
    assert {name: len(part) for name, part in by_regime(found).items()} == {"run-up": 2, "own": 2}


def test_a_place_is_judged_by_the_torque_where_it_has_one():
    def foremost(*quantities):
        rows = [row(quantity=name) for name in quantities]
        return places(Bench(document(("m",), ("alpha",)), points(rows)))[0].foremost

    assert foremost("Jeq", "phi", "Mkr") == "Mkr"
    assert foremost("Jeq", "phi") == "phi"
    assert foremost("Jeq", "S") == "Jeq"


def test_the_control_is_last_and_no_part_of_the_front_over_all_engines():
    (place, *_) = places(made_up_bench(control="alpha"))
    assert [facts.engine for facts in place.engines("Mkr")] == ["beta", "alpha"]
    assert {record.engine for record in place.ranked("Mkr")} == {"beta"}


def test_methods_are_sweeps_at_the_effort_a_method_comes_with():
    alpha, _ = places(made_up_bench())[0].engines("Mkr")
    assert [(one.first.setting, one.first.effort) for one in alpha.methods] == [("plain", 100.0), ("higher", None)]
    assert len(alpha.sweeps) == 3


def test_an_engine_that_gave_nothing_is_there_with_nothing_to_choose():
    (place,) = places(nothing_finished())
    (gamma,) = place.engines(place.foremost)
    assert place.quantities == gamma.choices == gamma.setting_comparisons == ()
    assert by_regime([place]) == {}
