"""The targets: a complete table, errors as the records say; times are measured, never asserted."""

import dataclasses

import pytest
from rich.console import Console

from analytic.description.loading import load
from comparisons.judging.records import run_record
from tests.comparisons.judging.test_judgement import RECORD
from tests.targets import speed, targets


def test_every_target_can_be_measured_and_has_a_goal_within_its_minimum():
    for target in targets.targets():
        assert target.kind in {
            "errors",
            "own_errors",
            "reference",
            "steady_state",
            "overhead",
            "closed_form",
            "process",
            "six_bar",
            "designs",
            "forward",
            "forward_alone",
            "savings",
            "long_turns",
            "random",
            "missed",
            "endurance",
        }
        assert 0.0 <= target.goal <= target.minimum


def test_the_worst_matching_error_of_each_engine_counts():
    target = targets.Target("t", "of peak", 1.0, 0.1, "errors", {"quantity": "Mkr", "setting": "tuned"})
    records = [
        dataclasses.replace(RECORD, error_max=error, setting=setting)
        for error, setting in ((1e-3, "tuned"), (2e-3, "tuned"), (0.5, "best"))
    ]
    (figure,) = targets._errors(target, [run_record(one, [one]) for one in records], ["e", "absent"])
    assert (figure.subject, figure.reached, figure.verdict) == ("e", 2e-3, "goal")


def test_a_failed_run_misses_its_target():
    target = targets.Target("t", "of peak", 1.0, 0.1, "errors", {"quantity": "Mkr"})
    failed = dataclasses.replace(RECORD, error_max=None, outcome="diverged")
    (figure,) = targets._errors(target, [run_record(failed, [failed])], ["e"])
    assert figure.verdict == "missed"


def test_a_settled_crank_turns_at_torque_over_damping():
    target = next(t for t in targets.targets() if t.kind == "steady_state")
    (figure,) = targets._steady_state(target, [load("slotted-takeup")])
    assert figure.reached == pytest.approx(2.2e-4, rel=0.05)  # the time mean lies below the mean over φ, which is M1/b


def test_times_keep_every_repeat():
    target = next(t for t in targets.targets() if t.kind == "closed_form")
    small = dataclasses.replace(target, arguments={"angles": 100})
    (figure,) = targets._closed_form(small, [load("juki-mf7923d")])
    assert len(figure.repeats) == targets.REPEATS
    assert figure.reached == min(figure.repeats) > 0.0


def test_a_ratio_is_told_with_what_it_is_made_up_of(monkeypatch):
    contest = speed.Contest({"compiled": (2e-6, 1e-6), "pylinkage": (8e-6, 4e-6)}, 10)
    monkeypatch.setattr(speed, "six_bar_contest", lambda _name, _angles: contest)
    target = next(t for t in targets.targets() if t.kind == "six_bar" and t.arguments["baseline"] == "pylinkage")
    (figure,) = targets._six_bar(target)
    assert figure.reached == pytest.approx(0.25)
    assert figure.repeats == pytest.approx((0.25, 0.25))
    assert figure.verdict == "missed"
    assert "compiled: 100 ns" in figure.detail


def test_a_figure_without_its_baseline_is_not_judged(monkeypatch):
    monkeypatch.setattr(speed, "six_bar_contest", lambda _name, _angles: speed.Contest({"compiled": (1e-6,)}, 10))
    target = next(t for t in targets.targets() if t.kind == "six_bar" and t.arguments["baseline"] == "pylinkage")
    (figure,) = targets._six_bar(target)
    assert (figure.subject, figure.verdict) == ("pylinkage is not installed", "absent")


def test_the_table_says_what_was_reached():
    target = targets.Target("cost", "s", 2.0, 1.0, "process", [])
    figures = [targets.Figure(target, "a", 0.5), targets.Figure(target, "b", 1.5), targets.Figure(target, "c", 2.5)]
    console = Console(width=80, no_color=True, force_terminal=False)
    with console.capture() as capture:
        console.print(targets.table(figures))
    for words in ("goal met", "minimum met", "missed"):
        assert words in capture.get()
