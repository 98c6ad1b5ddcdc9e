"""The points of a benchmark: methods and steps, the end of each sweep, the number of repeats."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from comparisons.judging.records import Verdict
from comparisons.runs.run_engine import Failure
from comparisons.work_precision.records import PointRecord
from comparisons.work_precision.step_sweep import still_improves
from engines.contract import Method, Outcome, Setting

# A step too long for an engine may be cured by a shorter one, but not for ever.
MOST_FAILURES = 3
# Steps that every sweep takes, whatever they cost and gain: fewer are no curve, and show neither order nor floor.
FEWEST = 6
LASTING_FAILURES = (
    Failure.TIMED_OUT,
    Outcome.UNSUPPORTED,
    Outcome.UNAVAILABLE,
    Verdict.NOT_PROVIDED,
)  # whatever the step


@dataclass(frozen=True)
class Extent:
    """The extent of a benchmark.

    ``steps_per_turn`` of the crank's peak speed, coarse to fine; after ``FEWEST`` a sweep ends before a point that
    would take longer than ``budget``, s. A point is timed ``repeats`` times, fewer once it has taken ``patience``, s,
    in all; both count set-up and stepping. No run is begun after ``deadline``, s from the start. ``fronts_only``
    measures of each engine the most advanced method, of a single run and of several, and leaves out the best setting,
    which repeats one.
    """

    steps_per_turn: tuple[float, ...]
    budget: float
    repeats: int
    patience: float
    deadline: float = math.inf
    fronts_only: bool = False


FULL = Extent(tuple(12.0 * 2.0**k for k in range(12)), budget=1.0, repeats=5, patience=0.6)
QUICK = Extent(
    tuple(6.0 * 2.0**k for k in range(8)), budget=0.3, repeats=2, patience=0.1, deadline=45.0, fronts_only=True
)
OUT_OF_TIME = "the time for the whole benchmark was up"


@dataclass(frozen=True)
class Point:
    """One way of running one engine on one case: a setting as it is, or a method at a step.

    ``case`` is its place among the cases.
    """

    case: int
    engine: str
    setting: Setting | None = None
    method: Method | None = None
    steps_per_turn: float | None = None

    @property
    def usage(self) -> Setting | Method | None:
        """The setting or method to run; None if the engine is not installed."""
        return self.setting or self.method

    @property
    def words(self) -> str:
        """Setting, or method with its steps, in words."""
        if self.method is None:
            return f"setting {self.setting}"
        return f"{self.method.name}, {self.steps_per_turn:g} steps a turn"

    @property
    def key(self) -> str:
        """A name that tells it from all others of the same benchmark."""
        return f"{self.case} {self.engine} {self.words}"


@dataclass
class PointSweep:
    """A sweep under way: the points still to come, coarse to fine, and what came of those done.

    ``ended`` says why it went no further, once it has ended.
    """

    points: Sequence[Point]
    budget: float
    measurements: list[PointRecord] = field(default_factory=list)
    ended: str = ""

    def next(self) -> Point | None:
        """The point to measure next; None when the sweep has ended."""
        if not self.ended:
            self.ended = self._why_ended()
        return None if self.ended else self.points[len(self.measurements)]

    def add(self, measurement: PointRecord | None) -> None:
        """Record the measurement of the next point; None if there was no time left for it."""
        if measurement is None:
            self.ended = OUT_OF_TIME
        else:
            self.measurements.append(measurement)

    def _why_ended(self) -> str:
        done = self.measurements
        if done and done[-1].outcome != Outcome.FINISHED:
            return self._why_failed()
        if len(done) == len(self.points):
            return "the sweep ends here"
        if len(done) < FEWEST:
            return ""
        finished = [each for each in done if each.outcome == Outcome.FINISHED]
        errors = [[error.error_max for error in each.errors if error.error_max is not None] for each in finished]
        if not any(still_improves(entries) for entries in zip(*errors, strict=True)):
            return "two refinements in a row improved nothing"
        price = self._estimated_seconds(self.points[len(done)])
        if price > self.budget:
            return f"the next step would take about {price:.2g} s, over {self.budget:g} s"
        return ""

    def _estimated_seconds(self, point: Point) -> float:
        """Estimated time of a point, s, from the cheapest set-up and step so far, without slow spells."""
        pairs = zip(self.points, self.measurements, strict=False)
        rates = [
            record.seconds / done.steps_per_turn for done, record in pairs if done.steps_per_turn and record.seconds
        ]
        setup = min((measurement.setup_seconds for measurement in self.measurements), default=0.0)
        return setup + min(rates, default=0.0) * (point.steps_per_turn or 0.0)

    def _why_failed(self) -> str:
        """Failures end a sweep that worked before, and one that never did after three."""
        last = self.measurements[-1]
        lasting = last.outcome in LASTING_FAILURES
        worked = any(each.outcome == Outcome.FINISHED for each in self.measurements)
        if lasting or worked or len(self.measurements) in (MOST_FAILURES, len(self.points)):
            return f"{last.outcome}: {last.detail}"
        return ""


def planned_sweeps(
    case: int, engine: str, methods: Sequence[Method], settings: Sequence[Setting], extent: Extent
) -> list[PointSweep]:
    """The sweeps of one engine on one case: settings, then methods."""
    if extent.fronts_only:
        settings = [setting for setting in settings if setting is not Setting.BEST]
        methods = [*_most_advanced(methods, extrapolated=False), *_most_advanced(methods, extrapolated=True)]
    sweeps = [PointSweep([Point(case, engine, setting)], math.inf) for setting in settings]
    for method in methods:
        points = [Point(case, engine, method=method, steps_per_turn=n) for n in extent.steps_per_turn]
        sweeps.append(PointSweep(points, extent.budget))
    return sweeps


def _most_advanced(methods: Sequence[Method], *, extrapolated: bool) -> list[Method]:
    """The most advanced method of a single run, or of several extrapolated: an engine names its simplest first."""
    return [method for method in methods if (method.runs > 1) == extrapolated][-1:]
