"""First turn against last: nothing grows in an engine without steps."""

from engines.contract import Setting
from tests.targets.long_run import LEAST, long_runs


def test_an_engine_without_steps_is_in_the_last_turn_what_it_was_in_the_first():
    (run,) = long_runs(("direct",), ("juki-mf7923d",), Setting.TUNED, turns=20)
    assert run.outcome == "finished"
    assert 0.0 < run.torque_first < 1e-13
    assert run.torque_last < 10.0 * max(run.torque_first, LEAST)
    assert run.gap_last < 10.0 * max(run.gap_first, LEAST)
