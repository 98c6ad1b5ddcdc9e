"""The targets: a complete table, errors as the records say, contests by the same numbers; no time is asserted."""

import dataclasses
import math

import numpy as np
import pytest
from rich.console import Console

from analytic.description.loading import load
from analytic.machine_code import compiling
from comparisons.judging.records import run_record
from comparisons.stress.cell_result import StressVerdict
from comparisons.stress.saved import Stress
from engines.contract import Setting
from tests.comparisons.judging.test_judgement import RECORD
from tests.comparisons.stress.test_border import result
from tests.targets import random_linkages, speed, studies, targets
from tests.targets.long_run import LEAST, LongRun, long_run


def _target(kind):
    return next(target for target in targets.targets() if target.kind == kind)


def test_every_target_can_be_measured_and_has_a_goal_within_its_minimum():
    for target in targets.targets():
        assert target.kind in targets.KINDS
        assert 0.0 <= target.goal <= target.minimum


def test_the_worst_matching_error_of_each_engine_counts_and_a_failed_run_misses():
    target = targets.Target("t", "of peak", 1.0, 0.1, "errors", {"quantity": "Mkr", "setting": "tuned"})

    def measured(*records):
        (figure,) = targets._errors(target, [run_record(each, [each]) for each in records], ["e", "absent"])
        return figure.subject, figure.reached, figure.verdict

    errors = (1e-3, "tuned"), (2e-3, "tuned"), (0.5, "best")
    assert measured(*(dataclasses.replace(RECORD, error_max=e, setting=s) for e, s in errors)) == ("e", 2e-3, "goal")
    assert measured(dataclasses.replace(RECORD, error_max=None, outcome="diverged")) == ("e", math.inf, "missed")


def test_a_settled_crank_turns_at_torque_over_damping():
    (figure,) = targets._steady_state(_target("steady_state"), [load("slotted-takeup")])
    assert figure.reached == pytest.approx(2.2e-4, rel=0.05)  # the time mean lies below the mean over φ, which is M1/b


def test_times_keep_every_repeat():
    small = dataclasses.replace(_target("closed_form"), arguments={"angles": 100})
    (figure,) = targets._closed_form(small, [load("juki-mf7923d")])
    assert len(figure.repeats) == targets.REPEATS
    assert figure.reached == min(figure.repeats) > 0.0


def test_the_table_says_which_targets_were_reached():
    target = targets.Target("cost", "s", 2.0, 1.0, "process", [])
    console = Console(width=80, no_color=True, force_terminal=False)
    with console.capture() as capture:
        console.print(targets.table([targets.Figure(target, "a", reached) for reached in (0.5, 1.5, 2.5)]))
    assert all(words in capture.get() for words in ("goal met", "minimum met", "missed"))


# -- contests of speed -------------------------------------------------------------------------------------------------


def test_a_ratio_is_of_the_shortest_repeats_in_turns_after_a_warm_up():
    calls = []
    spent = speed.race({name: lambda name=name: calls.append(name) for name in "ab"})
    assert (calls[:6], len(calls)) == ([*"ababab"], 2 * (1 + speed.REPEATS))
    assert {name: len(seconds) for name, seconds in spent.items()} == {"a": speed.REPEATS, "b": speed.REPEATS}
    measured = speed.ratio({"compiled": (2e-6, 1e-6), "pylinkage": (8e-6, 2e-6)}, 10)
    assert (measured.subject, measured.reached) == ("compiled over pylinkage", 0.5)
    assert measured.repeats == pytest.approx((0.25, 0.5))
    assert "compiled: 100 ns, median 150 ns" in measured.detail


def test_contestants_give_the_same_numbers_and_others_make_a_contest_void():
    pytest.importorskip("numba")
    pytest.importorskip("pylinkage")
    measured = speed.six_bar("rimoldi-164", 300)
    assert (math.isfinite(measured.reached), len(measured.repeats)) == (True, speed.REPEATS)
    right = np.ones((4, 3, 2, 5))
    assert speed.difference(right, right) == ""
    assert speed.difference(right, right * (1.0 + 1e-6)).startswith("the numbers differ by 1.0e-06")
    void = speed.ratio({"ours": (1.0,), "theirs": (9.0,)}, 1, "the numbers differ")
    assert (void.reached, void.detail) == (math.inf, "the numbers differ")


def test_without_numba_there_is_no_contest(monkeypatch):
    monkeypatch.setattr(compiling, "is_installed", lambda: False)
    figures = speed.six_bar("rimoldi-164", 1), speed.designs("rimoldi-164", ["rod.B.x"], 1, 1)
    assert all(math.isnan(figure.reached) for figure in figures)
    target = targets.Target("t", "ns", 1.0, 0.1, "designs", {})
    assert targets.Figure(target, "", figures[1].reached).verdict == "absent"


# -- studies -----------------------------------------------------------------------------------------------------------


def test_an_engine_without_steps_is_in_the_last_turn_what_it_was_in_the_first():
    run = long_run("direct", "juki-mf7923d", Setting.TUNED, 20)
    assert 0.0 < run.torque[0] < 1e-13
    assert run.growth < 10.0


def test_growth_is_the_worse_of_gap_and_torque_and_rounding_does_not_count(monkeypatch):
    grown = LongRun((1e-8, 3e-8), (1e-6, 7e-6))
    assert grown.growth == pytest.approx(7.0)
    assert LongRun((0.0, 0.5 * LEAST), (0.0, LEAST)).growth == 1.0
    monkeypatch.setattr(studies, "long_runs", lambda *_: [("e, m", grown), ("f, m", "crashed: died")])
    good, failed = studies.long_turns({"mechanisms": ["m"], "setting": "tuned", "turns": 10}, ["e", "f"])
    assert "gap 1.0e-08, then 3.0e-08" in good.detail
    assert (failed.reached, failed.detail) == (math.inf, "crashed: died")


def test_missed_cells_are_counted(monkeypatch):
    cells = (result(1.0, StressVerdict.WITHIN), result(2.0, StressVerdict.MISSED))
    monkeypatch.setattr(studies, "stress", lambda _request: Stress({}, cells))
    (figure,) = studies.missed({"quick": True}, ["e"])
    assert (figure.reached, figure.detail) == (1.0, cells[1].cell.key)


def test_random_linkages_are_the_same_every_time_and_right_in_the_control():
    """One of each kind: the control is within its limits, or the linkages are not valid."""
    assert random_linkages.draw(2) == random_linkages.draw(2)
    figures = [
        next(studies.random({"count": 4, "ratio": 30.0, "counted": kind}, ["direct"])) for kind in ("failing", "missed")
    ]
    assert [(figure.reached, figure.detail) for figure in figures] == [(0.0, "4 within limit")] * 2
