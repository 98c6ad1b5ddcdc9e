"""How a run ends and in how many steps it is taken."""

import pytest

from engines.contract import Outcome
from engines.stepping.intervals import Cost, DivergedError, UnsupportedError, run_stepping, whole_steps


def test_steps_are_whole():
    assert whole_steps(0.3, 0.1, 2) == 3  # 0.3 / 0.1 is a rounding more than 3
    assert whole_steps(0.31, 0.1, 2) == 4
    assert whole_steps(0.3, 1.0, 8) == 8


@pytest.mark.parametrize(
    ("error", "outcome"), [(DivergedError("gone"), Outcome.DIVERGED), (UnsupportedError("gone"), Outcome.UNSUPPORTED)]
)
def test_a_run_that_stops_keeps_its_reason_and_what_it_cost(error, outcome):
    cost = Cost(details={"method": "any"})

    def history():
        with cost.stepping():
            cost.steps += 7
            raise error

    run = run_stepping(cost, history)
    assert (run.outcome, run.reason, run.steps, run.details) == (outcome, "gone", 7, {"method": "any"})
    assert run.seconds > 0.0
