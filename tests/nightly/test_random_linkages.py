"""Random linkages in every engine: few runs fail, and no wrong motion passes unseen."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.motion.case import Case
from comparisons.trials.runs.run_engine import Lost, RunBounds, run_engine
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.stress.cells import Cell, StressVerdict, judged
from engines.contract import Setting
from engines.registry import engine, own_names
from engines.scene import Channel
from tests.analytic.drawn_linkages import MODERATE, draw
from tests.analytic.linkages import from_text

SECONDS = 60.0  # that a run may take
INSTALLED = [name for name in own_names() if engine(name).version() is not None]
FAILING = 0.02  # share of the runs with a mass ratio up to 30 that may fail or be over a limit


@dataclass
class Tally:
    """Numbers of the runs of one engine by verdict."""

    verdicts: Counter[StressVerdict] = field(default_factory=Counter)

    def __str__(self) -> str:
        return ", ".join(f"{number} {verdict}" for verdict, number in self.verdicts.most_common())

    @property
    def failing(self) -> float:
        """Share of the runs that the engine takes which failed or are over a limit."""
        taken = sum(self.verdicts.values()) - self.verdicts[StressVerdict.UNSUPPORTED]
        return 1.0 - self.verdicts[StressVerdict.WITHIN] / taken if taken else math.nan


def run(number: int, name: str, largest_ratio: float) -> str:
    """Verdict on one linkage in one engine."""
    drawn = draw(number, largest_ratio)
    motion = crank_motion("run-up-quintic", ramp_time=0.15, hold_time=0.06, start_angle=0.1)
    case = Case(from_text(drawn.text, f"drawn-{number}"), motion)
    model = case.scene(frozenset(Channel))
    names = (case.mechanism.linkage.name, "", "", "", name, "", Setting.TUNED)
    cell, adapter = Cell(*names, axis=drawn.kind, row="", value=number), engine(name)
    return judged(cell, case, model, run_engine(adapter, model, Setting.TUNED), adapter).verdict.value


def tallies(count: int, engines: Sequence[str], largest_ratio: float = MODERATE) -> dict[str, Tally]:
    """The runs of linkages 0 … count − 1 in these engines."""
    jobs = [(number, name, largest_ratio) for number in range(count) for name in engines]
    found = {name: Tally() for name in engines}
    for job, result in LocalPool().run(run, jobs, bounds=RunBounds(seconds=SECONDS)):
        verdict = result.outcome.value if isinstance(result, Lost) else result
        found[jobs[job][1]].verdicts[StressVerdict(verdict)] += 1
    return found


@pytest.mark.nightly
def test_they_are_the_same_every_time_and_right_in_the_control():
    """One of each kind: the control is within its limits, or the linkages are not valid."""
    assert draw(2) == draw(2)
    assert str(tallies(4, ["direct"])["direct"]) == "4 within limit"


@pytest.mark.nightly
def test_few_fail_in_an_engine_and_no_wrong_motion_passes_unseen():
    for name, tally in tallies(60, INSTALLED).items():
        assert tally.verdicts[StressVerdict.MISSED] == 0, name
        assert tally.failing <= FAILING, f"{name}: {tally}"
