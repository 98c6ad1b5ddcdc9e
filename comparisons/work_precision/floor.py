"""The floor of a sweep: the smallest error it reached, and, from the data, why it gets no nearer to the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from comparisons.work_precision.step_sweep import StepSweep, short, theil_sen

# A floor a third as high is a lower one; errors within a factor two of each other are level.
LOWER = 3.0
LEVEL = 2.0
GROWTH = 0.3  # least power of 1/step that is growth and not scatter
# Double precision leaves this much of a peak after the sums that a torque is made of.
ROUND_OFF = 1e-13


class Cause(StrEnum):
    """Why a sweep gets no nearer to the truth."""

    FALLING = "still falling"
    ROUND_OFF = "round-off"
    EFFORT = "solver effort"
    ROUNDING = "rounding"
    MODEL = "read-out or model"
    UNSETTLED = "undecided"

    @property
    def is_floor(self) -> bool:
        """Whether finer steps do not lower the error."""
        return self not in (Cause.FALLING, Cause.UNSETTLED)


@dataclass(frozen=True)
class Floor:
    """The smallest error of a sweep, the step it was reached at, s, and why it is not smaller, with the evidence."""

    error: float
    step: float
    cause: Cause
    evidence: str


def floor(sweep: StepSweep, others: Sequence[StepSweep] = ()) -> Floor:
    """The floor of a sweep; ``others`` are the same method's sweeps at other solver efforts.

    A floor that more solver effort lowers is the solver's even where the error grows as the step shrinks: what a solver
    leaves over in each step is divided by the step's square in an acceleration.
    """
    cause, evidence = (
        _at_round_off(sweep)
        or _lowered_at_its_step(sweep, others)
        or _falling(sweep)
        or _lowered_by_effort(sweep, others)
        or _growing(sweep)
        or _lower_than_with_less_effort(sweep, others)
        or _level(sweep, others)
    )
    return Floor(float(sweep.errors[sweep.best]), float(sweep.steps[sweep.best]), cause, evidence)


Finding = tuple[Cause, str] | None


def _at_round_off(sweep: StepSweep) -> Finding:
    least = sweep.errors[sweep.best]
    return (Cause.ROUND_OFF, f"{short(least)} of the peak is double precision's own") if least <= ROUND_OFF else None


def _falling(sweep: StepSweep) -> Finding:
    if not sweep.is_falling:
        return None
    finer = sweep.steps[-2] / sweep.steps[-1]
    gain = f"{sweep.last_gain:.0f}" if sweep.last_gain >= 10.0 else f"{sweep.last_gain:.2g}"
    return Cause.FALLING, f"at the finest step; refining the step {finer:.3g} × reduced the error {gain} ×"


def _lowered_at_its_step(sweep: StepSweep, others: Sequence[StepSweep]) -> Finding:
    """More solver effort has a smaller error at the very step of the smallest one."""
    least, step = sweep.errors[sweep.best], sweep.steps[sweep.best]
    harder = [(other, other.error_at(step)) for other in others if other.works_harder_than(sweep)]
    lower = [(other, error) for other, error in harder if error is not None and error * LOWER <= least]
    if not lower:
        return None
    hardest, error = min(lower, key=lambda pair: pair[1])
    return (
        Cause.EFFORT,
        f"at {short(step)} s {sweep.effort_words}: {short(least)}; {hardest.effort_words}: {short(error)}",
    )


def _lowered_by_effort(sweep: StepSweep, others: Sequence[StepSweep]) -> Finding:
    """More solver effort has a lower floor."""
    least = sweep.errors[sweep.best]
    lower = [other for other in others if other.works_harder_than(sweep) and other.errors[other.best] * LOWER <= least]
    if not lower:
        return None
    lowest = min(lower, key=lambda other: other.errors[other.best])
    return (
        Cause.EFFORT,
        f"{sweep.effort_words}: {short(least)}; {lowest.effort_words}: {short(lowest.errors[lowest.best])}",
    )


def _growing(sweep: StepSweep) -> Finding:
    """The error grows again as the step shrinks."""
    best, steps, errors = sweep.best, sweep.steps, sweep.errors
    past = errors[best + 1 :]
    if not past or past[-1] < LEVEL * errors[best] or past[-1] * LEVEL < max(past):
        return None
    power = theil_sen(np.log(steps[best:]), np.log(np.maximum(errors[best:], np.finfo(float).tiny)))
    growth = f"from {short(errors[best])} at {short(steps[best])} s it grows as h^{power:.1f} to {short(past[-1])}"
    return (Cause.ROUNDING, f"{growth} at {short(steps[-1])} s") if power <= -GROWTH else None


def _lower_than_with_less_effort(sweep: StepSweep, others: Sequence[StepSweep]) -> Finding:
    """The hardest working sweep has the lowest floor, so that yet more effort may have a lower one."""
    least = sweep.errors[sweep.best]
    if any(other.works_harder_than(sweep) for other in others):
        return None
    beaten = [other for other in others if sweep.works_harder_than(other) and least * LOWER <= other.errors[other.best]]
    if not beaten or len(beaten) < sum(sweep.works_harder_than(other) for other in others):
        return None
    nearest = min(beaten, key=lambda other: other.errors[other.best])
    evidence = f"{nearest.effort_words}: {short(nearest.errors[nearest.best])}; {sweep.effort_words}: {short(least)}"
    return Cause.EFFORT, f"{evidence}; more was not tried"


def _level(sweep: StepSweep, others: Sequence[StepSweep]) -> tuple[Cause, str]:
    """Neither the step nor the effort moves it; or too few points to tell."""
    least = sweep.errors[sweep.best]
    level = [
        step for step, error in zip(sweep.steps, sweep.errors, strict=True) if error <= LEVEL * least or error == least
    ]
    if len(sweep.errors) == 1:
        return Cause.UNSETTLED, "one step alone was taken"
    if len(level) < 2:
        return Cause.UNSETTLED, f"{short(least)} at {short(level[0])} s alone, and no trend past it"
    harder = [other for other in others if other.works_harder_than(sweep)]
    tried = f", at {_hardest(harder).effort_words} too" if harder else ""
    return Cause.MODEL, f"steps of {short(level[0])} to {short(level[-1])} s all give about {short(least)}{tried}"


def _hardest(sweeps: Sequence[StepSweep]) -> StepSweep:
    most = sweeps[0]
    for sweep in sweeps[1:]:
        most = sweep if sweep.works_harder_than(most) else most
    return most
