"""The verdict of a cell of a stress map: is the motion right, and if not, did a check flag it?"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from analytic.description.crank_motion import REGIMES
from analytic.errors import LinkproofError
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import compared
from comparisons.trials.invariants.checks import HALF_TURN
from comparisons.trials.judging.limits import OWN, grouped
from comparisons.trials.judging.quantities import all_quantities
from comparisons.trials.judging.records import Error, Run, Verdict, run_of
from comparisons.trials.judging.signal_errors import LEVELS, signal_errors
from comparisons.trials.observed_motion import ObservedMotion
from engines.contract import Engine, Outcome, Setting
from engines.contract import Run as EngineRun
from engines.scene import Channel, Scene

# A motion is *wrong* where a position or velocity of any body, the torque of a driven crank or the force in a joint is
# off by more than this share of its scale, or where so much of the motion has no samples.
WRONG = 1e-2
JUDGED = (Channel.POSITION, Channel.VELOCITY, Channel.TORQUE, Channel.JOINT_FORCE)
LARGEST = 1e300  # stands for nan and infinity, which JSON cannot hold
# A joint is as far open as it is: over its limit that is a deviation from the truth, no inference that may be false.
MEASURED = ("joint_gap",)


class StressVerdict(StrEnum):
    """The verdict of a cell."""

    WITHIN = "within limit"
    OVER = "over limit"
    CAUGHT = "caught"
    MISSED = "missed"
    ALARM = "alarm"
    DIVERGED = "diverged"
    TIMED_OUT = "timed-out"
    CRASHED = "crashed"
    ADAPTER_ERROR = "adapter-error"
    SUITE_ERROR = "suite-error"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"


@dataclass(frozen=True, kw_only=True)
class Cell(Run):
    """One run of a map, before it is made and after; its setting may be a method's name.

    Its errors are the quantity nearest to its limit, its invariants those that failed, or else the nearest. ``wrong``
    and ``reason`` are in the words of a reader; ``differing`` is what differs from a plain run-up of the linkage.
    ``spent`` is everything: reference, set-up, stepping, judging, s.
    """

    axis: str
    row: str
    value: float
    verdict: StressVerdict = StressVerdict.UNAVAILABLE
    reason: str = ""
    wrong: str = ""
    differing: Mapping[str, Any] = field(default_factory=dict)
    spent: float = 0.0
    solver_work: int = 0

    @property
    def line(self) -> tuple[str, str, str, str]:
        """Axis, row, engine and setting, shared with the cells of other values."""
        return (self.axis, self.row, self.engine, self.setting)

    @property
    def key(self) -> str:
        """The cell in words that a command understands."""
        return f"{self.axis}/{self.row}/{self.value:.6g}/{self.engine}/{self.setting}"

    @property
    def command(self) -> str:
        """The command that runs the cell again."""
        return f"linkproof stress '{self.key}'"

    @property
    def data(self) -> dict[str, Any]:
        """The cell as JSON-ready data."""
        return {**super().data, "command": self.command}


@cache
def tables() -> dict[str, Any]:
    """The axes of the maps, and the words of checks that fail."""
    return tomllib.loads(Path(__file__).with_name("axes.toml").read_text(encoding="utf-8"))


def wrong_signals(case: Case, motion: ObservedMotion) -> list[str]:
    """A sentence for everything that is further from the closed form than ``WRONG``; empty where nothing is.

    Of all positions, and of all velocities, the worst one is named.
    """
    errors = signal_errors(case, motion.scene, motion.history, JUDGED)
    kinds = grouped(((e.read.channel, "" if e.read.channel in LEVELS else e.read.name), e) for e in errors).values()
    worst = [max(kind, key=lambda error: error.largest) for kind in kinds]
    words = [
        f"{error.read.words} off by {error.largest:.2g} {error.scale_words} at {error.worst_time:.3g} s"
        for error in worst
        if error.largest > WRONG
    ]
    missing = _unsampled_share(case, motion)
    return [*words, f"{missing:.2g} of the duration has no samples"] if missing > WRONG else words


def _unsampled_share(case: Case, motion: ObservedMotion) -> float:
    """Share of the duration between samples that lie half a turn and more apart."""
    time = motion.signal(Channel.POSITION).time
    blind = np.abs(np.diff(case.motion.angle(time))) > HALF_TURN
    return float(np.sum(np.diff(time)[blind])) / case.motion.duration


def judged(cell: Cell, case: Case, scene: Scene, made: EngineRun, adapter: Engine) -> Cell:
    """A cell with the verdict on its run, by the limits of ``tuned``, or of ``best`` where that was run.

    Those of ``naive`` would hide a wrong motion. Where the closed form itself has no motion, no motion is right, and
    the invariants have to flag it.
    """
    if made.outcome is not Outcome.FINISHED or made.history is None:
        return replace(cell, verdict=StressVerdict(made.outcome.value), reason=made.reason)
    motion, run = ObservedMotion(scene, made.history), _run_to_judge(case, cell.setting)
    with np.errstate(all="ignore"):  # a wrong motion can be any numbers
        try:
            if case.is_prescribed:
                case.check_motion()
            wrong = wrong_signals(case, motion)
            run = compared(case, motion, all_quantities(case).values(), run, adapter)
        except LinkproofError as error:
            wrong = [f"there is no one motion to find ({error})"]
            run = compared(case, motion, (), run, adapter)
        errors, checks = _worst_first(run.errors), _worst_first(run.invariants)
        failed = [check for check in checks if check.outcome != Verdict.PASSED]
        alarms = "; ".join(_alarm_words(check, motion) for check in failed)
    verdict, reason = StressVerdict.WITHIN, ""
    if wrong:
        verdict = StressVerdict.CAUGHT if failed else StressVerdict.MISSED
        reason = f"{'; '.join(wrong)}. {'Flagged: ' + alarms if failed else 'No check flagged it'}"
    elif errors and errors[0].outcome != Verdict.PASSED:
        verdict, reason = StressVerdict.OVER, f"{errors[0].quantity} off by {errors[0].error_max:.2g} of its peak"
    elif any(check.quantity not in MEASURED for check in failed):
        verdict, reason = StressVerdict.ALARM, f"right, yet {alarms}"
    elif failed:
        verdict, reason = StressVerdict.OVER, alarms
    cell = replace(cell, errors=cell.own(errors[:1]), invariants=cell.own(failed or checks[:1]))
    return replace(cell, verdict=verdict, reason=reason, wrong="; ".join(wrong))


def _run_to_judge(case: Case, setting: str) -> Run:
    """A run by the limits of the regime that the motion is most like."""
    regime = case.motion.regime if case.is_prescribed else OWN
    if case.is_prescribed and regime not in REGIMES:
        regime = "run-up" if case.motion.jumps else "run-up-quintic"
    return replace(run_of(case, Setting.BEST if setting == Setting.BEST else Setting.TUNED), regime=regime)


def _worst_first(errors: Iterable[Error]) -> list[Error]:
    """The errors that were judged, in finite numbers, with the furthest over its limit, or the nearest to it, first."""
    rows = []
    for error in errors:
        if Verdict(error.outcome).judged and error.error_max is not None and error.limit is not None:
            at_jumps = error.error_at_jumps if error.error_at_jumps > error.limit else 0.0
            worst = float(np.nan_to_num(max(error.error_max, at_jumps), nan=LARGEST, posinf=LARGEST))
            rows.append((worst / error.limit, error._replace(error_max=worst, error_rms=None, error_at_jumps=0.0)))
    return [row for _, row in sorted(rows, key=lambda pair: pair[0], reverse=True)]


def _alarm_words(check: Error, motion: ObservedMotion) -> str:
    """What a check says of the motion, and when; of a joint that is open, which."""
    at = check.worst_time
    gaps = motion.joint_gaps(np.array([at or 0.0]))
    joint = max(gaps, key=lambda name: float(gaps[name][0]))
    words = tables()["alarms"][check.quantity].format(error=f"{check.error_max:.2g}", joint=joint)
    return words if at is None else f"{words} at {at:.3g} s"
