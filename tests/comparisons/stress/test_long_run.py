"""First turn against last: nothing grows in an engine without steps; what fails says so."""

import math

import pytest

from comparisons.stress.long_run import LEAST, LongRun, long_runs
from engines.contract import Setting


def test_an_engine_without_steps_is_in_the_last_turn_what_it_was_in_the_first():
    (run,) = long_runs(("direct",), ("juki-mf7923d",), Setting.TUNED, turns=20)
    assert run.outcome == "finished"
    assert 0.0 < run.torque_first < 1e-13
    assert run.growth < 10.0


def test_growth_is_the_worse_of_gap_and_torque_and_rounding_does_not_count():
    run = LongRun("m", "e", "tuned", 10, "finished", "", 1e-8, 3e-8, 1e-6, 7e-6)
    assert run.growth == pytest.approx(7.0)
    assert LongRun("m", "e", "tuned", 10, "finished", "", 0.0, 0.5 * LEAST, 0.0, LEAST).growth == 1.0


def test_a_run_that_failed_grew_beyond_all_bounds():
    assert math.isinf(LongRun("m", "e", "tuned", 10, "diverged", "joint open").growth)
