"""How a run ends and what it costs; and a prescribed motion cut into intervals of a whole number of basic steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import pairwise
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.law import FULL_TURN
from analytic.errors import LinkproofError
from engines.contract import History, Outcome, Run, signal_words

Array = NDArray[np.float64]

# How a run ends, its cost, and in how many steps it is taken.


ROUNDING = 1e-6  # of a step: what a whole number of steps may lack of a duration


class DivergedError(Exception):
    """The engine stopped early, or computed another motion than the scene's; the message gives the reason."""


class UnsupportedError(Exception):
    """The engine does not support the scene, which shows only while it is built; the message gives the reason."""


@dataclass
class Cost:
    """Cost of a run so far, passes that failed included, and the ``details`` of the settings used."""

    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    passes: tuple[float, ...] = ()
    details: dict[str, str | int | float] = field(default_factory=dict)

    @contextmanager
    def timing(self, name: str) -> Iterator[None]:
        """Add the block's wall time, s, even if it raises, to the field ``name``: ``seconds`` or ``setup_seconds``."""
        begun = perf_counter()
        try:
            yield
        finally:
            setattr(self, name, getattr(self, name) + perf_counter() - begun)

    def run(self, outcome: Outcome, reason: str = "", history: History | None = None) -> Run:
        """A Run with this outcome, reason and history, and with the cost so far."""
        return Run(outcome, reason, history, **vars(self))


def run_stepping(cost: Cost, history: Callable[[], History]) -> Run:
    """Call ``history`` and make a Run of its result and ``cost``: FINISHED if all values are finite, else DIVERGED.

    A DivergedError or an UnsupportedError that it raises becomes the outcome and its message the reason; other errors
    pass.
    """
    try:
        result = history()
        for key, signal in result.signals.items():
            if not np.isfinite(signal.values).all():
                raise DivergedError(f"the {signal_words(*key)} is not finite everywhere")
        return cost.run(Outcome.FINISHED, history=result)
    except DivergedError as stop:
        return cost.run(Outcome.DIVERGED, str(stop))
    except UnsupportedError as stop:
        return cost.run(Outcome.UNSUPPORTED, str(stop))


def check_step(step: float) -> None:
    """Raise LinkproofError for a step, s, that is not positive and finite."""
    if not 0.0 < step < math.inf:
        raise LinkproofError(f"step: expected a positive finite number of seconds, got {step:g}; correct it")


# A prescribed motion cut into intervals, each started anew, in a whole number of basic steps.


GRADES = (0.5, 0.75)  # of the peak speed: where the step changes; no step is more than twice another's
EVEN = 1.0 + 1e-9  # so that rounding does not cut a constant speed
MANY = 20  # more segments than this are the pieces of a table, which share the least number of steps
SAMPLED = 64  # places of a segment at which its speed is looked at


@dataclass(frozen=True)
class Interval:
    """A part of a run between fresh starts, in ``samples`` basic steps.

    If the motion is prescribed it lies in one ``segment`` of it. ``after_jump``: the acceleration jumps at its start.
    """

    start: float
    end: float
    samples: int
    segment: Segment | None = None
    after_jump: bool = False

    @property
    def step(self) -> float:
        """The basic step of the interval, s."""
        return (self.end - self.start) / self.samples


@dataclass(frozen=True)
class Pace:
    """Fineness of the steps of a motion: of at most ``step``, s, and at least ``steps_per_turn`` at each part's peak.

    A segment has ``least_steps`` or more and is started anew at least every so many ``turns``. ``turn`` is how much of
    φ counts as one, rad or m.
    """

    step: float = math.inf
    steps_per_turn: float = 0.0
    least_steps: int = 8
    turns: float = math.inf
    turn: float = FULL_TURN


def even_intervals(duration: float, step: float, least: int, cuts: Sequence[float] = ()) -> list[Interval]:
    """A run of a duration, s, cut at ``cuts``, s: each part in ``least`` or more equal steps of at most ``step``, s.

    ``cuts`` increase; those outside the run do not count.
    """
    borders = [0.0, *(cut for cut in cuts if 0.0 < cut < duration), duration]
    return [
        Interval(start, end, max(least, math.ceil((end - start) / step - ROUNDING))) for start, end in pairwise(borders)
    ]


def intervals(motion: CrankMotion, pace: Pace) -> list[Interval]:
    """The motion as intervals, in order, each of equal steps no longer than the pace allows.

    A segment is cut where its speed comes to another grade of the peak, if the pace has steps per turn, and after every
    ``pace.turns`` turns. The segments of a table, more than MANY, share the least number of steps.
    """
    first = motion.segments[0]
    if len(motion.segments) > MANY:  # a table: its pieces need not be resolved each by itself
        pace = replace(pace, least_steps=math.ceil(pace.least_steps * MANY / len(motion.segments)))
    return [
        interval
        for segment in motion.segments
        for interval in _cut_segment(segment, segment is not first and segment.start in motion.jumps, motion, pace)
    ]


def _cut_segment(segment: Segment, after_jump: bool, motion: CrankMotion, pace: Pace) -> Iterator[Interval]:
    """Yield the intervals of a segment, cut at grades of the motion's peak speed and after ``pace.turns`` turns.

    The step of an interval gives ``pace.steps_per_turn`` at the highest speed of its part, so slow parts have longer
    steps: loads by inertia grow with the square of the speed, and a slow part's error is small beside the peak of a
    fast one. A step given in seconds, ``pace.step``, is never exceeded. ``after_jump``: the acceleration jumps at the
    segment's, and so the first interval's, start.
    """
    time = np.linspace(segment.start, segment.end, SAMPLED + 1)
    speed = np.abs(segment.value(time, 1))
    cuts = [0, *(_grade_changes(speed, motion.peak_speed) if pace.steps_per_turn else []), SAMPLED]
    longest = min(pace.step, (segment.end - segment.start) / pace.least_steps)
    for first, last in pairwise(cuts):
        length = float(time[last] - time[first])
        turns = length * float(speed[first : last + 1].max()) / pace.turn
        parts = max(1, math.ceil(turns / pace.turns - ROUNDING))
        samples = max(1, math.ceil(max(length / longest, turns * pace.steps_per_turn) / parts - ROUNDING))
        for start, end in pairwise(np.linspace(time[first], time[last], parts + 1).tolist()):
            yield Interval(start, end, samples, segment, after_jump)
            after_jump = False


def _grade_changes(speed: Array, peak: float) -> list[int]:
    """Indices, but the first and last, at which sampled speeds (n,) have crossed a share in GRADES of the peak."""
    grade = np.digitize(speed, np.multiply(GRADES, peak * EVEN))
    changes = np.flatnonzero(np.diff(grade)) + 1
    return [int(change) for change in changes if change < len(speed) - 1]
