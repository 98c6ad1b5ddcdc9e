"""Studies behind targets: what they make of their results."""

import math

import pytest

from comparisons.stress.cell_result import StressVerdict
from comparisons.stress.saved import Stress
from tests.comparisons.stress.test_border import result
from tests.targets import random_linkages, studies
from tests.targets.long_run import LEAST, LongRun


def test_a_long_run_tells_its_ratio_and_what_it_is_made_of(monkeypatch):
    runs = [LongRun("m", "e", "tuned", 10, "finished", "", 1e-8, 3e-8, 1e-6, 2e-6, 0.5, 100)]
    monkeypatch.setattr(
        studies, "long_runs", lambda *_: iter([*runs, LongRun("m", "f", "tuned", 10, "crashed", "died")])
    )
    good, failed = studies.long_turns({"mechanisms": ["m"], "setting": "tuned", "turns": 10}, ["e", "f"])
    assert (good.subject, round(good.reached, 9)) == ("e, m", 3.0)
    assert "gap 1.0e-08, then 3.0e-08" in good.detail
    assert (failed.reached, failed.detail) == (float("inf"), "crashed: died")


def test_missed_cells_are_counted(monkeypatch):
    cells = (result(1.0, StressVerdict.WITHIN), result(2.0, StressVerdict.CAUGHT))
    monkeypatch.setattr(studies, "stress", lambda _request: Stress({}, cells))
    (found,) = studies.missed({"quick": True}, ["e"])
    assert (found.reached, found.detail) == (0.0, "of 2 cells")


def test_random_linkages_are_the_same_every_time_and_right_in_the_control():
    """One of each kind: the control is within its limits, or the linkages are not valid."""
    assert random_linkages.draw(2) == random_linkages.draw(2)
    (failing,) = studies.random({"count": 4, "ratio": 30.0, "counted": "failing"}, ["direct"])
    (missed,) = studies.random({"count": 4, "ratio": 30.0, "counted": "missed"}, ["direct"])
    assert (failing.reached, missed.reached, failing.detail) == (0.0, 0.0, "4 within limit")


def test_lost_and_doubled_records_add_up(monkeypatch):
    monkeypatch.setattr(studies, "killed_and_resumed", lambda kills: (kills, 2))
    (found,) = studies.endurance({"kills": 3}, [])
    assert (found.reached, found.detail) == (5.0, "3 lost, 2 doubled")


def test_growth_is_the_worse_of_gap_and_torque_and_rounding_does_not_count():
    run = LongRun("m", "e", "tuned", 10, "finished", "", 1e-8, 3e-8, 1e-6, 7e-6)
    assert studies.growth(run) == pytest.approx(7.0)
    assert studies.growth(LongRun("m", "e", "tuned", 10, "finished", "", 0.0, 0.5 * LEAST, 0.0, LEAST)) == 1.0


def test_a_run_that_failed_grew_beyond_all_bounds():
    assert math.isinf(studies.growth(LongRun("m", "e", "tuned", 10, "diverged", "joint open")))
