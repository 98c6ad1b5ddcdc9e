"""The rounds of a benchmark: points measured one after the other in one worker process, and what they come to."""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict
from functools import partial
from typing import Any, Final

from pydantic import TypeAdapter

from comparisons.reference.case import Case
from comparisons.runs.failures import Failure, Lost
from comparisons.runs.journal import Journal
from comparisons.runs.plugins import engine
from comparisons.runs.study import Announce, Study, Task, Written
from comparisons.runs.workers import Bounds, Pool
from comparisons.work_precision.measure import Measurement, longest_step, measure
from comparisons.work_precision.points import Extent, Point, PointSweep
from comparisons.work_precision.records import METHOD, SETTING, PointRecord
from engines.contract import Outcome, StudiedEngine
from engines.registry import why_unavailable

# A run that takes this much longer than its budget, s, hangs.
HANGS = 60.0


class Rounds:
    """What every point took in every round; no run is begun after the deadline of ``extent``.

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
        self.study: Study[Measurement] = Study(measure, self._lost, _written, _read, journal, announce, pool)

    def run(self, number: int, points: Sequence[Point]) -> None:
        """Measure points in a round, as long as there is time."""
        tasks = [self._task(number, point) for point in points if point.is_run]
        self.study.expect(tasks)
        bounds = Bounds(seconds=min(HANGS + 20.0 * self.extent.budget, max(1.0, self.left())))
        with closing(self.study.make(tasks, bounds)) as ended:  # which ends the worker, if the time is up
            while self.left() > 0.0 and next(ended, None) is not None:
                pass

    def measurement(self, number: int, point: Point) -> Measurement | None:
        """What a point took in a round; None where it was not measured."""
        if not point.is_run:
            return Measurement(Outcome.UNAVAILABLE.value, why_unavailable(engine(point.engine)) or "")
        key = _key(number, point)
        return self.study.result(key) if self.study.has(key) else None

    def repeats(self, point: Point, rounds: int) -> list[Measurement]:
        """What a point took, round by round, where it finished, on the machine that made the first."""
        every = [one for number in range(rounds) if (one := self.measurement(number, point)) is not None]
        return [one for one in every if one.outcome == Outcome.FINISHED and one.host == every[0].host]

    def is_worth_repeating(self, point: Point, number: int) -> bool:
        """Whether a point takes part in a later round: while it has not taken too long."""
        before = self.repeats(point, number)
        return bool(before) and sum(one.setup + one.seconds for one in before) < self.extent.patience

    @property
    def calibrations(self) -> tuple[float, ...]:
        """How long the fixed work took beside every run, s."""
        return tuple(one.calibration for one in self.study.results() if one.calibration > 0.0)

    def _task(self, number: int, point: Point) -> Task:
        case = self.cases[point.case]
        way, run = point.setting or point.method, f"{point.engine} {point.way}"
        return Task(
            key=_key(number, point),
            job=(self.pickled[point.case], point.engine, way, point.steps_per_turn, self.quantities, number == 0),
            label=f"round {number + 1}: {case.mechanism.linkage.name}, {case.motion.regime}, {run}",
        )

    def _lost(self, lost: Lost, *_: object) -> Measurement | None:
        """A run that gave no result; None where it was ended by our own deadline, not by the engine's fault."""
        return Measurement(lost.outcome.value, lost.reason, host=lost.host) if self.left() > 0.0 else None

    def left(self) -> float:
        """Time until the deadline, s."""
        return self.ends - time.monotonic()


_MEASUREMENT: Final = TypeAdapter(Measurement)


def _key(number: int, point: Point) -> str:
    return f"{number} {point.key}"


def _written(measurement: Measurement) -> Written:
    return asdict(measurement), {}


def _read(row: Mapping[str, Any], _: object) -> Measurement:
    return _MEASUREMENT.validate_python(row)


def records(case: Case, sweep: PointSweep, rounds: Rounds) -> Iterator[PointRecord]:
    """A record per point of a sweep; a sweep there was no time for has its first point to say so."""
    adapter = engine(sweep.points[0].engine)
    unit = adapter.work_unit if isinstance(adapter, StudiedEngine) else ""
    blank = partial(
        PointRecord,
        engine_version=adapter.version() or "",
        is_control=adapter.is_control,
        work_unit=unit,
        ended=sweep.ended,
    )
    for point, measurement in zip(
        sweep.points, sweep.measurements or [Measurement(Failure.TIMED_OUT.value, sweep.ended)], strict=False
    ):
        yield _record(blank, case, point, measurement, rounds.repeats(point, rounds.extent.repeats))


def _record(
    blank: Callable[..., PointRecord],
    case: Case,
    point: Point,
    measurement: Measurement,
    repeats: Sequence[Measurement],
) -> PointRecord:
    linkage, method = case.mechanism.linkage, point.method
    steps = point.steps_per_turn
    return blank(
        mechanism=linkage.name,
        variant=linkage.variant,
        regime=case.motion.regime,
        conditions=case.conditions,
        engine=point.engine,
        kind=METHOD if method else SETTING,
        setting=method.name if method else str(point.setting or ""),
        runs=measurement.runs,
        effort=method.effort if method else None,
        effort_unit=method.effort_unit if method else "",
        step=longest_step(case, steps) if steps else None,
        steps_per_turn=steps,
        errors=measurement.errors,
        seconds=min((run.seconds for run in repeats), default=0.0),
        repeats=tuple(run.seconds for run in repeats),
        setup_seconds=min((run.setup for run in repeats), default=0.0),
        readout_seconds=min((run.readout for run in repeats), default=0.0),
        steps=measurement.steps,
        solver_work=measurement.solver_work,
        outcome=measurement.outcome,
        detail=measurement.reason,
        used=measurement.used,
        host=measurement.host,
    )
