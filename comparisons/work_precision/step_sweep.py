"""A sweep of steps: the order its error falls with, whether refining still pays, what an error costs along it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# The order is fitted to errors below the first bound (no solution) and above the second (no step error).
SATURATED = 0.3
ABOVE_FLOOR = 3.0
# Local slopes that differ from the order by less than this are the same slope, seen through scatter.
SLOPE_SHARE, SLOPE_ROOM = 0.25, 0.3
LEAST_POINTS, LEAST_ORDER, LEAST_DROP = 3, 0.4, 3.0
# A refinement that takes less than this factor off no longer improves.
LEAST_GAIN = 1.5


@dataclass(frozen=True)
class StepSweep:
    """One method at one solver effort over its steps.

    ``steps``, s, fall strictly; ``errors`` are over the truth's peak, one per step. ``work`` is the solver's work per
    step, 0 where an engine does not tell.
    """

    steps: Sequence[float]
    errors: Sequence[float]
    effort: float | None = None
    effort_unit: str = ""
    work: float = 0.0

    @property
    def best(self) -> int:
        """Place of the smallest error."""
        return int(np.argmin(self.errors))

    @property
    def effort_words(self) -> str:
        """The effort for a reader: "100 iterations", "relative tolerance 1e-10"."""
        if self.effort is None:
            return f"the engine's own {self.effort_unit}" if self.effort_unit else "its solver as it is"
        if falls_with_effort(self.effort_unit):
            return f"{self.effort_unit} {short(self.effort, 0)}"
        return f"{self.effort:g} {self.effort_unit}"

    @property
    def last_gain(self) -> float:
        """Factor by which the last refinement reduced the error; 1 without a refinement."""
        return self.errors[-2] / self.errors[-1] if len(self.errors) > 1 and self.errors[-1] > 0.0 else 1.0

    @property
    def is_falling(self) -> bool:
        """Whether the finest step is the best and better than the one before by more than scatter."""
        return self.best == len(self.errors) - 1 and self.last_gain >= LEAST_GAIN

    def error_at(self, step: float) -> float | None:
        """The error at a step, s; None where that step was not taken."""
        return next((e for s, e in zip(self.steps, self.errors, strict=True) if math.isclose(s, step)), None)

    def works_harder_than(self, other: StepSweep) -> bool:
        """Whether its solver does more: by the named efforts, else by the work per step."""
        if self.effort is not None and other.effort is not None:
            falls = falls_with_effort(self.effort_unit)
            return self.effort < other.effort if falls else self.effort > other.effort
        return self.work > other.work > 0.0


def short(value: float, decimals: int = 1) -> str:
    """A number as it stands in a sentence: 1.2e-5, 6."""
    if 0.1 <= value < 1000.0:
        return f"{value:.2g}"
    mantissa, exponent = f"{value:.{decimals}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def falls_with_effort(unit: str) -> bool:
    """Whether a smaller number means more effort: a tolerance does, a count of iterations does not."""
    return "tolerance" in unit


def observed_order(sweep: StepSweep) -> float | None:
    """Slope of log error over log step where it is steady; None unless three points agree on it.

    The longest run of refinements counts, of equal ones the finest, whose local slopes agree with their own Theil-Sen
    slope, which an outlier does not move. Points at the floor or past it, and those so wrong that they are no solution,
    are left out.
    """
    steps = np.log(np.asarray(sweep.steps, dtype=float))
    errors = np.log(np.maximum(np.asarray(sweep.errors, dtype=float), np.finfo(float).tiny))
    lowest = errors[sweep.best] + (0.0 if sweep.is_falling else math.log(ABOVE_FLOOR))
    usable = [k for k in range(sweep.best + 1) if lowest <= errors[k] <= math.log(SATURATED)]
    windows: list[tuple[int, int, float]] = []
    for first in range(len(usable)):
        for end in range(first + LEAST_POINTS, len(usable) + 1):
            window = usable[first:end]
            slope = _steady_slope(steps[window], errors[window])
            windows += [(len(window), window[-1], slope)] if slope is not None else []
    return max(windows)[2] if windows else None


def theil_sen(x: Array, y: Array) -> float:
    """Median of the slopes between all pairs of points (P. K. Sen, J. Am. Stat. Assoc. 63, 1968).

    SciPy's also works out a confidence interval, which costs ten times as much and is not wanted here.
    """
    first, second = np.triu_indices(len(x), 1)
    return float(np.median((y[second] - y[first]) / (x[second] - x[first])))


def _steady_slope(steps: Array, errors: Array) -> float | None:
    """The slope of a window whose every refinement has that slope, near enough."""
    slope = theil_sen(steps, errors)
    local = np.diff(errors) / np.diff(steps)
    steady = bool(np.all(np.abs(local - slope) <= SLOPE_SHARE * abs(slope) + SLOPE_ROOM))
    return slope if steady and slope >= LEAST_ORDER and errors[0] - errors[-1] >= math.log(LEAST_DROP) else None


def still_improves(errors: Sequence[float]) -> bool:
    """Whether another refinement is worth its price: not after two in a row without a smaller error."""
    if len(errors) < LEAST_POINTS:
        return True
    return min(errors[-2:]) * LEAST_GAIN < min(errors[:-2])


def pareto(costs: Sequence[float], errors: Sequence[float]) -> NDArray[np.bool_]:
    """Which of the points (n,) no other beats, that is, is at most as dear and as wrong, and less in one of the two."""
    order = np.lexsort((errors, costs))
    unbeaten = np.zeros(len(costs), dtype=bool)
    least, at = math.inf, math.nan
    for k in order:
        # Sorted by cost, then error: only a smaller error, or a twin of the last point on the front, is not beaten.
        if errors[k] < least or (errors[k] == least and costs[k] == at):
            unbeaten[k] = True
            least, at = errors[k], costs[k]
    return unbeaten


def sustained(errors: Sequence[float], limit: float) -> int | None:
    """Place of the coarsest step from which on every finer one, down to the smallest error, is at or below ``limit``.

    A coarse step can be right by accident; one that the next finer step contradicts is not to be relied on. None where
    the error is never reached.
    """
    place = int(np.argmin(errors))
    if errors[place] > limit:
        return None
    while place > 0 and errors[place - 1] <= limit:
        place -= 1
    return place


def price(costs: Sequence[float], errors: Sequence[float], limit: float) -> float | None:
    """The cost at which the error of a sweep, coarse to fine, falls to ``limit``, by logarithms between two points.

    None where it never gets there.
    """
    place = sustained(errors, limit)
    if place is None:
        return None
    if place == 0 or errors[place] <= 0.0:
        return float(costs[place])
    above, below = math.log(errors[place - 1] / limit), math.log(limit / errors[place])
    share = above / (above + below)
    return math.exp((1.0 - share) * math.log(costs[place - 1]) + share * math.log(costs[place]))


# The floor of a sweep: the smallest error it reached, and, from the data, why it gets no nearer to the truth.


# A floor a third as high is a lower one; errors within a factor two of each other are level.
LOWER_FACTOR = 3.0
LEVEL_FACTOR = 2.0
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
        _find_round_off(sweep)
        or _find_effort_at_step(sweep, others)
        or _find_falling(sweep)
        or _find_effort(sweep, others)
        or _find_growth(sweep)
        or _find_highest_effort(sweep, others)
        or _find_level(sweep, others)
    )
    return Floor(float(sweep.errors[sweep.best]), float(sweep.steps[sweep.best]), cause, evidence)


Finding = tuple[Cause, str] | None


def _find_round_off(sweep: StepSweep) -> Finding:
    """The error is double precision's own; None where it is larger."""
    least = sweep.errors[sweep.best]
    return (Cause.ROUND_OFF, f"{short(least)} of the peak is double precision's own") if least <= ROUND_OFF else None


def _find_falling(sweep: StepSweep) -> Finding:
    """The error still falls at the finest step; None where it does not."""
    if not sweep.is_falling:
        return None
    finer = sweep.steps[-2] / sweep.steps[-1]
    gain = f"{sweep.last_gain:.0f}" if sweep.last_gain >= 10.0 else f"{sweep.last_gain:.2g}"
    return Cause.FALLING, f"at the finest step; refining the step {finer:.3g} × reduced the error {gain} ×"


def _find_effort_at_step(sweep: StepSweep, others: Sequence[StepSweep]) -> Finding:
    """More solver effort gives a smaller error at the best step; None where it does not."""
    least, step = sweep.errors[sweep.best], sweep.steps[sweep.best]
    harder = [(other, other.error_at(step)) for other in others if other.works_harder_than(sweep)]
    lower = [(other, error) for other, error in harder if error is not None and error * LOWER_FACTOR <= least]
    if not lower:
        return None
    hardest, error = min(lower, key=lambda pair: pair[1])
    return (
        Cause.EFFORT,
        f"at {short(step)} s {sweep.effort_words}: {short(least)}; {hardest.effort_words}: {short(error)}",
    )


def _find_effort(sweep: StepSweep, others: Sequence[StepSweep]) -> Finding:
    """More solver effort has a lower floor; None where it has not."""
    least = sweep.errors[sweep.best]
    lower = [
        other for other in others if other.works_harder_than(sweep) and other.errors[other.best] * LOWER_FACTOR <= least
    ]
    if not lower:
        return None
    lowest = min(lower, key=lambda other: other.errors[other.best])
    return (
        Cause.EFFORT,
        f"{sweep.effort_words}: {short(least)}; {lowest.effort_words}: {short(lowest.errors[lowest.best])}",
    )


def _find_growth(sweep: StepSweep) -> Finding:
    """The error grows again as the step shrinks; None where it does not."""
    best, steps, errors = sweep.best, sweep.steps, sweep.errors
    past = errors[best + 1 :]
    if not past or past[-1] < LEVEL_FACTOR * errors[best] or past[-1] * LEVEL_FACTOR < max(past):
        return None
    power = theil_sen(np.log(steps[best:]), np.log(np.maximum(errors[best:], np.finfo(float).tiny)))
    growth = f"from {short(errors[best])} at {short(steps[best])} s it grows as h^{power:.1f} to {short(past[-1])}"
    return (Cause.ROUNDING, f"{growth} at {short(steps[-1])} s") if power <= -GROWTH else None


def _find_highest_effort(sweep: StepSweep, others: Sequence[StepSweep]) -> Finding:
    """The sweep with most effort has the lowest floor, so that yet more may have a lower one; None otherwise."""
    least = sweep.errors[sweep.best]
    if any(other.works_harder_than(sweep) for other in others):
        return None
    beaten = [
        other for other in others if sweep.works_harder_than(other) and least * LOWER_FACTOR <= other.errors[other.best]
    ]
    if not beaten or len(beaten) < sum(sweep.works_harder_than(other) for other in others):
        return None
    nearest = min(beaten, key=lambda other: other.errors[other.best])
    evidence = f"{nearest.effort_words}: {short(nearest.errors[nearest.best])}; {sweep.effort_words}: {short(least)}"
    return Cause.EFFORT, f"{evidence}; more was not tried"


def _find_level(sweep: StepSweep, others: Sequence[StepSweep]) -> tuple[Cause, str]:
    """Neither step nor effort changes the error; or there are too few points to tell."""
    least = sweep.errors[sweep.best]
    level = [
        step
        for step, error in zip(sweep.steps, sweep.errors, strict=True)
        if error <= LEVEL_FACTOR * least or error == least
    ]
    if len(sweep.errors) == 1:
        return Cause.UNSETTLED, "one step alone was taken"
    if len(level) < 2:
        return Cause.UNSETTLED, f"{short(least)} at {short(level[0])} s alone, and no trend past it"
    harder = [other for other in others if other.works_harder_than(sweep)]
    tried = f", at {_hardest_working(harder).effort_words} too" if harder else ""
    return Cause.MODEL, f"steps of {short(level[0])} to {short(level[-1])} s all give about {short(least)}{tried}"


def _hardest_working(sweeps: Sequence[StepSweep]) -> StepSweep:
    most = sweeps[0]
    for sweep in sweeps[1:]:
        most = sweep if sweep.works_harder_than(most) else most
    return most
