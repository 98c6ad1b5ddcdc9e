"""Targets that take a study of their own: long runs, stress maps, random linkages, killed campaigns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from comparisons.stress.campaign import StressRequest, stress
from comparisons.stress.cell_result import StressVerdict
from comparisons.stress.cells import chosen_axes
from engines.contract import Setting
from tests.targets.endurance import measure
from tests.targets.long_run import long_runs
from tests.targets.random_linkages import tallies
from tests.targets.speed import Measured


def long_turns(given: dict[str, Any], engines: Sequence[str]) -> Iterator[Measured]:
    """Growth of the joint gap or the torque error from the first turn to the last; infinite without a motion."""
    for names, run in long_runs(engines, given["mechanisms"], Setting(given["setting"]), given["turns"]):
        yield Measured(names, math.inf if isinstance(run, str) else run.growth, (), str(run))


def missed(given: dict[str, Any], engines: Sequence[str]) -> Iterator[Measured]:
    """Cells of the stress maps in which a run reported success with a wrong motion and no invariant flagged it."""
    results = stress(StressRequest(tuple(chosen_axes(())), tuple(engines), quick=given["quick"]))
    cells = [each.cell.key for each in results.cells if each.verdict is StressVerdict.MISSED]
    yield Measured("all engines", float(len(cells)), (), "; ".join(cells) or f"of {len(results.cells)} cells")


def random(given: dict[str, Any], engines: Sequence[str]) -> Iterator[Measured]:
    """Of random linkages the share that fails, or the number of wrong motions that no check flagged."""
    for name, tally in _tallies(given["count"], tuple(engines), given["ratio"]).items():
        missed = float(tally.verdicts[StressVerdict.MISSED])
        yield Measured(name, missed if given["counted"] == "missed" else tally.failing, (), str(tally))


_tallies = cache(tallies)


def endurance(given: dict[str, Any], _engines: Sequence[str]) -> Iterator[Measured]:
    """Records lost or doubled by kills at random moments, each followed by a resumption."""
    result = measure(given["kills"])
    yield Measured("direct", float(result.lost + result.doubled), (), f"{result.lost} lost, {result.doubled} doubled")
