"""The rounds of a benchmark: points measured one after the other in one worker process, and their results."""

from __future__ import annotations

import pickle
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace

from comparisons.reference.case import Case, unpickled
from comparisons.runs.failures import Failure, Lost
from comparisons.runs.plugins import engine
from comparisons.runs.study import Announce, Journal, Study, Task
from comparisons.runs.workers import Bounds, Pool
from comparisons.work_precision.measure import measure, point_record
from comparisons.work_precision.points import Extent, Point, PointSweep
from comparisons.work_precision.records import CALIBRATION, PointRecord
from engines.contract import Method, Outcome, Setting
from engines.registry import why_unavailable

# A run that takes this much longer than its budget, s, hangs.
HANGS = 60.0


class Rounds:
    """The measurements of every point in every round; no run begins after the deadline of ``extent``.

    The first round takes the errors, the others the time alone. What the journal has is not measured again.
    """

    def __init__(
        self,
        cases: Sequence[Case],
        quantities: Sequence[str],
        extent: Extent,
        *,
        announce: Announce,
        journal: Journal | None,
        pool: Pool,
    ) -> None:
        self.cases, self.quantities, self.extent = cases, quantities, extent
        self.pickled = [pickle.dumps(case) for case in cases]
        self.ends = time.monotonic() + extent.deadline
        self.study: Study[PointRecord] = Study(
            measure, self._lost, PointRecord.written, PointRecord.from_row, journal, announce, pool
        )

    def run(self, number: int, points: Sequence[Point]) -> None:
        """Measure points in a round, as long as there is time."""
        tasks = [self._task(number, point) for point in points if point.way]
        self.study.expect(tasks)
        bounds = Bounds(seconds=min(HANGS + 20.0 * self.extent.budget, max(1.0, self.left())))
        with closing(self.study.make(tasks, bounds)) as ended:  # which ends the worker, if the time is up
            while self.left() > 0.0 and next(ended, None) is not None:
                pass

    def measurement(self, number: int, point: Point) -> PointRecord | None:
        """The measurement of a point in a round; None if it was not measured."""
        if not point.way:
            return self._unmeasured(point, Outcome.UNAVAILABLE.value, why_unavailable(engine(point.engine)) or "")
        key = _key(number, point)
        return self.study.result(key) if self.study.has(key) else None

    def repeats(self, point: Point, rounds: int) -> list[PointRecord]:
        """The finished measurements of a point, round by round, on the machine of the first."""
        every = [record for number in range(rounds) if (record := self.measurement(number, point)) is not None]
        return [run for run in every if run.outcome == Outcome.FINISHED and run.host == every[0].host]

    def is_worth_repeating(self, point: Point, number: int) -> bool:
        """Whether a point takes part in a later round: while it has not taken too long."""
        before = self.repeats(point, number)
        return bool(before) and sum(record.total_seconds for record in before) < self.extent.patience

    @property
    def calibrations(self) -> tuple[float, ...]:
        """Time of the fixed work beside every run, s."""
        return tuple(float(record.details[CALIBRATION]) for record in self.study.results() if record.details)

    def records(self, sweep: PointSweep) -> Iterator[PointRecord]:
        """A record per point of a sweep; a sweep there was no time for has its first point to say so."""
        if not sweep.measurements:
            yield replace(self._unmeasured(sweep.points[0], Failure.TIMED_OUT.value, sweep.ended), ended=sweep.ended)
        for point, first in zip(sweep.points, sweep.measurements, strict=False):
            repeats = self.repeats(point, self.extent.repeats)
            yield replace(
                first,
                seconds=min((repeat.seconds for repeat in repeats), default=0.0),
                setup_seconds=min((repeat.setup_seconds for repeat in repeats), default=0.0),
                readout_seconds=min((repeat.readout_seconds for repeat in repeats), default=0.0),
                repeats=tuple(repeat.seconds for repeat in repeats),
                ended=sweep.ended,
                details={},
            )

    def _unmeasured(self, point: Point, outcome: str, detail: str) -> PointRecord:
        case, adapter = self.cases[point.case], engine(point.engine)
        return point_record(case, adapter, point.way, point.steps_per_turn, outcome=outcome, detail=detail)

    def _task(self, number: int, point: Point) -> Task:
        case = self.cases[point.case]
        place = f"{case.mechanism.linkage.name}, {case.motion.regime}"
        return Task(
            key=_key(number, point),
            job=(self.pickled[point.case], point.engine, point.way, point.steps_per_turn, self.quantities, number == 0),
            label=f"round {number + 1}: {place}, {point.engine} {point.words}",
        )

    def _lost(
        self, lost: Lost, pickled: bytes, name: str, way: Setting | Method, steps: float | None, *_: object
    ) -> PointRecord | None:
        """The record of a run without a result; None if our own deadline ended it, not a fault of the engine."""
        if self.left() <= 0.0:
            return None
        sentences = {"outcome": lost.outcome.value, "detail": lost.reason, "host": lost.host}
        return point_record(unpickled(pickled), engine(name), way, steps, **sentences)

    def left(self) -> float:
        """Time until the deadline, s."""
        return self.ends - time.monotonic()


def _key(number: int, point: Point) -> str:
    return f"{number} {point.key}"
