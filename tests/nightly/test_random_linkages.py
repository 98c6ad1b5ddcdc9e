"""Random linkages in every engine: few runs fail, and no wrong motion passes unseen."""

from collections import Counter
from collections.abc import Sequence

import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.motion.case import Case
from comparisons.trials.runs.run_engine import Lost, RunBounds, run_engine
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.stress.cells import Cell, StressVerdict, judged
from engines.contract import Setting
from engines.registry import engine, own_names
from engines.scene import Channel
from tests.analytic.drawn_linkages import draw
from tests.analytic.linkages import from_text

SECONDS = 60.0  # that a run may take
INSTALLED = [name for name in own_names() if engine(name).version() is not None]
FAILING = 0.02  # share of the runs with a mass ratio up to 30 that may fail or be over a limit


def run(number: int, name: str) -> str:
    """Verdict on one linkage in one engine."""
    drawn = draw(number)
    motion = crank_motion("run-up-quintic", ramp_time=0.15, hold_time=0.06, start_angle=0.1)
    case = Case(from_text(drawn.text, f"drawn-{number}"), motion)
    model = case.scene(frozenset(Channel))
    names = (case.mechanism.linkage.name, "", "", "", name, "", Setting.TUNED)
    cell, adapter = Cell(*names, axis=drawn.kind, row="", value=number), engine(name)
    return judged(cell, case, model, run_engine(adapter, model, Setting.TUNED), adapter).verdict.value


def verdicts(count: int, engines: Sequence[str]) -> dict[str, Counter[StressVerdict]]:
    """How many linkages of 0 … count − 1 have each verdict, by engine."""
    jobs = [(number, name) for number in range(count) for name in engines]
    found = {name: Counter[StressVerdict]() for name in engines}
    for job, result in LocalPool().run(run, jobs, bounds=RunBounds(seconds=SECONDS)):
        found[jobs[job][1]][StressVerdict(result.outcome.value if isinstance(result, Lost) else result)] += 1
    return found


@pytest.mark.nightly
def test_they_are_the_same_every_time_and_right_in_the_control():
    """One of each kind: the control is within its limits, or the linkages are not valid."""
    assert draw(2) == draw(2)
    assert verdicts(4, ["direct"]) == {"direct": {StressVerdict.WITHIN: 4}}


@pytest.mark.nightly
def test_few_fail_in_an_engine_and_no_wrong_motion_passes_unseen():
    for name, found in verdicts(60, INSTALLED).items():
        taken = found.total() - found[StressVerdict.UNSUPPORTED]
        assert found[StressVerdict.MISSED] == 0, name
        assert found[StressVerdict.WITHIN] >= (1.0 - FAILING) * taken > 0.0, f"{name}: {found}"
