"""The record and the verdict of one cell of a stress map: is the motion right, and if not, did a check flag it?

What a *wrong* motion is stands below. Where an engine reports success with one, the invariants, which need no
closed form, have either caught or missed it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np

from analytic.description.crank_motion import REGIMES
from analytic.errors import LinkproofError
from comparisons.case import Case
from comparisons.invariants.checks import HALF_TURN, checks
from comparisons.judging.limits import OWN, grouped, limit
from comparisons.judging.quantities import NoSampleError, all_quantities, deviation
from comparisons.judging.records import Error, Run, Verdict, run_of
from comparisons.judging.signal_errors import LEVELS, signal_errors
from comparisons.observed_motion import ObservedMotion
from engines.contract import Origin, Outcome
from engines.contract import Run as EngineRun
from engines.scene import Channel, Scene

# Faults of a motion, by comparison with the closed form.
#
# A motion is *wrong* where the position or velocity of any body, the crank's angle among them, the torque of a driven
# crank or the force in a joint is off by more than ``WRONG`` of its scale, or where no samples cover as much of the
# motion.


# Of the linkage's size (or rad), of the peak velocity, of the peak torque, of the duration.
WRONG = 1e-2
JUDGED = (Channel.POSITION, Channel.VELOCITY, Channel.TORQUE, Channel.JOINT_FORCE)


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


@dataclass(frozen=True)
class Cell:
    """One run of a map; ``usage`` is a setting or the name of a method."""

    axis: str
    row: str
    value: float
    engine: str
    usage: str

    @property
    def key(self) -> str:
        """The cell in words that a command understands."""
        return "/".join((self.axis, self.row, f"{self.value:.6g}", self.engine, self.usage))

    @property
    def command(self) -> str:
        """The command that runs the cell again."""
        return f"linkproof stress '{self.key}'"

    @property
    def line(self) -> tuple[str, str, str, str]:
        """Axis, row, engine and usage, shared with the cells of other values."""
        return (self.axis, self.row, self.engine, self.usage)


@dataclass(frozen=True, kw_only=True)
class CellResult(Run):
    """The run of a cell: the quantity nearest to its limit, and the invariants that failed, or else the nearest.

    ``wrong`` and ``reason`` are in the words of a reader; ``differing`` is what differs from a plain run-up of the
    linkage. ``spent`` is everything: reference, set-up, stepping, judging, s.
    """

    axis: str
    row: str
    value: float
    verdict: StressVerdict
    reason: str = ""
    wrong: str = ""
    differing: Mapping[str, Any] = field(default_factory=dict)
    spent: float = 0.0
    solver_work: int = 0

    @property
    def cell(self) -> Cell:
        """The cell that was run."""
        return Cell(self.axis, self.row, self.value, self.engine, self.setting)

    @property
    def key(self) -> str:
        """The cell in words."""
        return self.cell.key

    @property
    def nearest(self) -> Error | None:
        """The quantity nearest to its limit, or furthest over it."""
        return next(iter(self.errors), None)

    @property
    def worst_check(self) -> Error | None:
        """The invariant nearest to its limit, or furthest over it."""
        return next(iter(self.invariants), None)

    @property
    def alarms(self) -> tuple[str, ...]:
        """Names of the invariants that failed."""
        return tuple(invariant.quantity for invariant in self.invariants if invariant.outcome != Verdict.PASSED)

    @property
    def data(self) -> dict[str, Any]:
        """The result as JSON-ready data."""
        return {**super().data, "command": self.cell.command}


def blank_result(cell: Cell, mechanism: str, motion: str = "") -> CellResult:
    """The result of a cell before it is run."""
    return CellResult(
        mechanism=mechanism,
        variant="",
        regime=motion,
        conditions=f"{cell.axis}, {cell.row}: {cell.value:.6g}",
        engine=cell.engine,
        engine_version="",
        setting=cell.usage,
        axis=cell.axis,
        row=cell.row,
        value=cell.value,
        verdict=StressVerdict.UNAVAILABLE,
    )


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


# The verdict of one cell of a stress map: is the motion right, and if not, did a check flag it?

LARGEST = 1e300
# A joint is as far open as it is: over its limit that is a deviation from the truth, no inference that may be false.
MEASURED = ("joint_gap",)


ALARMS: Mapping[str, str] = {
    "joint_gap": "joint {joint} is open by {error} of the shortest link",
    "closure": "bodies are {error} (of size, rad or peak) away from fitting joints and drive",
    "assembly_mode": "a group of links is in its other assembly mode",
    "crank_phase": "the crank is {error} rad away from where it must be",
    "energy_balance": "{error} of the energy scale has no source",
    "torque_two_routes": "the torque is {error} of its peak away from what the motion takes",
    "force_balance": "a joint force is {error} of its peak away from the bodies' balance",
    "weight_on_frame": "over a turn at constant speed the frame carries {error} of the weight too much or too little",
}


def judged(blank: CellResult, case: Case, scene: Scene, run: EngineRun, setting: str) -> CellResult:
    """Compare a cell's run with the closed form and check its invariants, by the limits of a setting.

    Where the closed form itself has no motion, no motion is right, and the invariants have to flag it.
    """
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return replace(blank, verdict=StressVerdict(run.outcome.value), reason=run.reason)
    motion = ObservedMotion(scene, run.history)
    rows = _record_to_judge(case, setting)
    with np.errstate(all="ignore"):  # a wrong motion can be any numbers
        checked = _judged_invariants(case, motion, rows)
        failed = [record for record in checked if record.outcome != Verdict.PASSED]
        alarms = "; ".join(_alarm_words(record, motion) for record in failed)
        try:
            if case.is_prescribed:
                case.check_motion()
            nearest, wrong = _nearest_deviation(case, motion, rows), wrong_signals(case, motion)
        except LinkproofError as error:
            nearest, wrong = None, [f"there is no one motion to find ({error})"]
    verdict, reason = _verdict_and_reason(nearest, wrong, failed, alarms)
    return replace(
        blank,
        errors=blank.own([nearest] if nearest else ()),
        invariants=blank.own(failed or checked[:1]),
        verdict=verdict,
        reason=reason,
        wrong="; ".join(wrong),
    )


def _verdict_and_reason(
    nearest: Error | None, wrong: Sequence[str], failed: Sequence[Error], alarms: str
) -> tuple[StressVerdict, str]:
    over = nearest is not None and nearest.outcome != Verdict.PASSED
    inferred = [record for record in failed if record.quantity not in MEASURED]
    if wrong:
        verdict = StressVerdict.CAUGHT if failed else StressVerdict.MISSED
        return verdict, f"{'; '.join(wrong)}. {'Flagged: ' + alarms if failed else 'No check flagged it'}"
    if over:
        assert nearest is not None
        return StressVerdict.OVER, f"{nearest.quantity} off by {_share_words(nearest.error_max)} of its peak"
    if inferred:
        return StressVerdict.ALARM, f"right, yet {alarms}"
    return (StressVerdict.OVER, alarms) if failed else (StressVerdict.WITHIN, "")


def _alarm_words(record: Error, motion: ObservedMotion) -> str:
    words = ALARMS[record.quantity].format(error=_share_words(record.error_max), joint=_open_joint(record, motion))
    return words if record.worst_time is None else f"{words} at {record.worst_time:.3g} s"


def _open_joint(record: Error, motion: ObservedMotion) -> str:
    """The joint that is furthest open at a record's worst time."""
    at = np.array([record.worst_time or 0.0])
    gaps = motion.joint_gaps(at)
    return max(gaps, key=lambda joint: float(gaps[joint][0]))


def _share_words(error: float | None) -> str:
    return f"{error:.2g}"


def _record_to_judge(case: Case, setting: str) -> Error:
    """A record by the limits of the regime that the motion is most like."""
    regime = case.motion.regime
    if case.is_prescribed and regime not in REGIMES:
        regime = "run-up" if case.motion.jumps else "run-up-quintic"
    blank = run_of(case, setting).blank
    return blank._replace(regime=regime if case.is_prescribed else OWN, conditions="stress")


def _judged_invariants(case: Case, motion: ObservedMotion, blank: Error) -> list[Error]:
    """The judged records, with the furthest over its limit, or the nearest to it, first."""
    records = [record for record in checks(case, motion, blank) if Verdict(record.outcome).judged]
    return sorted(records, key=_error_over_limit, reverse=True)


def _nearest_deviation(case: Case, motion: ObservedMotion, blank: Error) -> Error | None:
    """The quantity nearest to its limit, or furthest over it."""
    records = []
    for quantity in all_quantities(case).values():
        if quantity.lacking(motion) or quantity.origin(motion) is Origin.COMPUTED:
            continue
        try:
            worst = deviation(case, quantity, motion)
        except NoSampleError:
            continue
        bound = limit(quantity.name, blank.setting, blank.regime, blank.engine).value
        error = worst.error_max if worst.error_at_jumps <= bound else max(worst.error_max, worst.error_at_jumps)
        outcome = Verdict.PASSED if error <= bound else Verdict.OVER_LIMIT
        records.append(blank._replace(quantity=quantity.name, error_max=_finite_number(error), limit=bound,
                                      worst_time=worst.worst_time, outcome=outcome.value))  # fmt: skip
    return max(records, key=_error_over_limit, default=None)


def _error_over_limit(record: Error) -> float:
    """Error over limit."""
    assert record.error_max is not None
    assert record.limit is not None
    return record.error_max / record.limit


def _finite_number(value: float) -> float:
    """A magnitude that JSON can hold: ``LARGEST`` in place of nan and infinity."""
    return LARGEST if math.isnan(value) else min(value, LARGEST)
