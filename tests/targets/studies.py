"""Targets that take a study of their own: savings, long runs, stress maps, killed campaigns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.case import Case
from comparisons.stress.axes import chosen_axes
from comparisons.stress.campaign import StressRequest, stress
from comparisons.stress.cell_result import StressVerdict
from engines.contract import Setting
from tests.targets.endurance import killed_and_resumed
from tests.targets.long_run import LEAST, LongRun, long_runs
from tests.targets.random_linkages import tallies
from tests.targets.saving import plain_savings
from tests.targets.speed import Measured


def savings(asked: dict[str, Any], engines: Sequence[str]) -> Iterator[Measured]:
    """Time of ``best`` over that of an engine's plain fixed steps at an error; 0 where these never get there."""
    case = Case(Mechanism(load(asked["mechanism"])), crank_motion(asked["regime"]))
    for name, saving in plain_savings(case, engines, asked["error"], quantity=asked["quantity"]).items():
        reached = 0.0 if saving.ratio is None else 1.0 / saving.ratio
        yield Measured(name, reached, saving.record.repeats, saving.sentence)


def long_turns(asked: dict[str, Any], engines: Sequence[str]) -> Iterator[Measured]:
    """Joint gap and torque error of the last turn over those of the first, the larger ratio of the two."""
    for run in long_runs(engines, asked["mechanisms"], Setting(asked["setting"]), asked["turns"]):
        yield Measured(f"{run.engine}, {run.mechanism}", growth(run), (), _details(run))


def growth(run: LongRun) -> float:
    """The worse of the two errors' ratios, last turn over first; infinite where there was no motion."""
    pairs = ((run.gap_first, run.gap_last), (run.torque_first, run.torque_last))
    ratios = [max(last, LEAST) / max(first, LEAST) for first, last in pairs if first is not None and last is not None]
    return max(ratios) if len(ratios) == len(pairs) else math.inf


def _details(run: LongRun) -> str:
    if run.gap_first is None:
        return f"{run.outcome}: {run.reason}"
    return (
        f"gap {run.gap_first:.1e}, then {run.gap_last:.1e} of the shortest link; torque error {run.torque_first:.1e}, "
        f"then {run.torque_last:.1e} of peak; {run.steps} steps in {run.seconds:.3g} s"
    )


def missed(asked: dict[str, Any], engines: Sequence[str]) -> Iterator[Measured]:
    """Cells of the stress maps in which a run reported success with a wrong motion and no invariant flagged it."""
    found = stress(StressRequest(tuple(chosen_axes(())), tuple(engines), quick=asked["quick"]))
    cells = [one.cell.key for one in found.cells if one.verdict is StressVerdict.MISSED]
    yield Measured("all engines", float(len(cells)), (), "; ".join(cells) or f"of {len(found.cells)} cells")


def random(asked: dict[str, Any], engines: Sequence[str]) -> Iterator[Measured]:
    """What came of random linkages: the share that fails, or the wrong motions that no check flagged."""
    for name, tally in _tallies(asked["count"], tuple(engines), asked["ratio"]).items():
        told = ", ".join(f"{number} {verdict}" for verdict, number in tally.verdicts.most_common())
        missed = float(tally.verdicts[StressVerdict.MISSED])
        yield Measured(name, missed if asked["counted"] == "missed" else tally.failing, (), told)


_tallies = cache(tallies)


def endurance(asked: dict[str, Any], _engines: Sequence[str]) -> Iterator[Measured]:
    """Records lost or doubled by kills at random moments, each followed by a resumption."""
    lost, doubled = killed_and_resumed(asked["kills"])
    yield Measured("direct", float(lost + doubled), (), f"{lost} lost, {doubled} doubled")
