"""Choices, limits and standings in words."""

from comparisons.work_precision.floor import Cause
from comparisons.work_precision.places import places
from comparisons.work_precision.records import Bench
from reports.work_precision.words import comparison_words, failed_methods, label_of, limit_words, way_words
from tests.comparisons.bench_rows import points, row, setting_row, sweep_rows
from tests.reports.made_up_bench import document, made_up_bench

BENCH = made_up_bench()


def _facts(rows, quantity="Mkr"):
    return places(Bench(document(("m",), ("alpha", "beta")), points(rows)))[0].engines(quantity)


def test_a_way_names_its_method_and_its_steps_a_turn():
    (alpha, _) = places(BENCH)[0].engines("Mkr")
    ways = [way_words(alpha, choice.record) for choice in alpha.choices if choice.record]
    assert (ways[0], ways[-1]) == ("plain @ 4", "best x4")
    assert any(way.startswith("higher x2 @") for way in ways)


def test_floor_is_said_only_of_an_error_that_a_finer_step_does_not_lower():
    def told(errors):
        (facts,) = _facts(sweep_rows(errors))
        (sweep,) = facts.sweeps
        return sweep.floor.cause, limit_words(sweep)

    assert told([1e-1, 1e-2, 1e-3]) == (Cause.FALLING, "1.0e-3, still falling")
    assert told([1e-2]) == (Cause.UNSETTLED, "1.0e-2, undecided")
    assert told([1e-1, 2e-3, 1.9e-3, 1.8e-3]) == (Cause.MODEL, "floor 1.8e-3: read-out or model")


def test_what_an_engine_does_not_tell_is_said_once_where_it_is_missing():
    told = {"lacking": {"Jeq": "Jeq computed by the adapter"}}
    rows = [row(**told), setting_row("tuned", 1e-3, 1e-2, **told), row(quantity="Jeq", engine="beta")]
    alpha, beta = _facts(rows, "Jeq")
    assert failed_methods(alpha) == ("plain, tuned: not-provided: Jeq computed by the adapter",)
    assert failed_methods(beta) == failed_methods(_facts(rows)[0]) == ()
    (alpha,) = _facts([row(quantity="joint_force", detail_of="joint_force:A not offered")], "joint_force")
    assert failed_methods(alpha) == ("joint_force:A not offered",)


def test_a_setting_is_said_to_be_on_ahead_of_or_off_the_front():
    (alpha, _) = places(BENCH)[0].engines("Mkr")

    def told(noise):
        return {one.record.setting: comparison_words(one, alpha, noise) for one in alpha.setting_comparisons}

    assert told(0.1)["naive"] == ": no solution"
    assert told(0.1)["best"] == "; no method measured gets there"
    assert told(0.1)["tuned"].startswith("; on the front of single runs: plain takes 15.8 ms")
    assert told(0.01)["tuned"].startswith("; 1.1 × the front")


def test_the_control_is_held_against_nothing():
    _, alpha = places(made_up_bench(control="alpha"))[0].engines("Mkr")
    assert label_of(alpha) == "alpha (control)"
    assert alpha.setting_comparisons == ()
