"""Work-precision: every engine, method and step measured on every case, round after round, one run at a time.

The first round goes down all sweeps of a case at once, coarse steps first, and takes the errors; the rounds after it
repeat every point of the case for its time alone. Each round visits all points in turn, so that a slow spell of the
machine hits all alike.
"""

from __future__ import annotations

import math
import pickle
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from itertools import groupby
from typing import Any

from analytic.errors import UnknownNameError
from comparisons.case import Case, unpickle_case
from comparisons.runs.environment import environment
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import Failure, Lost
from comparisons.runs.store import Runs
from comparisons.runs.study import Announce, Study, Task
from comparisons.runs.workers import ONE_BY_ONE, Bounds, Pool
from comparisons.work_precision.fronts import judged
from comparisons.work_precision.measure import (
    FULL,
    WORK,
    Extent,
    Point,
    PointSweep,
    measure,
    planned_sweeps,
    point_record,
)
from comparisons.work_precision.table import CALIBRATION, FIRST_USE, Bench, BenchRun
from engines.contract import Method, Outcome, Setting, StudiedEngine
from engines.registry import engine_names, why_unavailable
from engines.scene import Channel

# The rounds of a benchmark: points measured one after the other in one worker process, and their results.


# A run that takes this much longer than its budget, s, hangs.
HANG_SECONDS = 60.0


class Rounds:
    """The measurements of every point in every round; no run begins after the deadline of ``extent``.

    The first round takes the errors, the others the time alone. ``finished`` ones are not measured again.
    """

    def __init__(
        self,
        cases: Sequence[Case],
        quantities: Sequence[str],
        extent: Extent,
        *,
        announce: Announce,
        finished: Runs | None,
        pool: Pool,
    ) -> None:
        self.cases, self.quantities, self.extent = cases, quantities, extent
        self.pickled = [pickle.dumps(case) for case in cases]
        self.ends = time.monotonic() + extent.deadline
        self.study: Study[BenchRun] = Study(
            measure, self._lost_point, BenchRun.written, BenchRun.from_row, finished, announce, pool
        )

    def run(self, number: int, points: Sequence[Point]) -> None:
        """Measure points in a round, as long as there is time."""
        tasks = [self._point_task(number, point) for point in points if point.usage]
        self.study.expect(tasks)
        bounds = Bounds(seconds=min(HANG_SECONDS + 20.0 * self.extent.budget, max(1.0, self.seconds_left())))
        with closing(self.study.make(tasks, bounds)) as ended:  # which ends the worker, if the time is up
            while self.seconds_left() > 0.0 and next(ended, None) is not None:
                pass

    def measurement(self, number: int, point: Point) -> BenchRun | None:
        """The measurement of a point in a round; None if it was not measured."""
        if not point.usage:
            return self._unmeasured_record(
                point, Outcome.UNAVAILABLE.value, why_unavailable(engine(point.engine)) or ""
            )
        key = _task_key(number, point)
        return self.study.result(key) if self.study.has(key) else None

    def repeats(self, point: Point, rounds: int) -> list[BenchRun]:
        """The finished measurements of a point, round by round."""
        every = [record for number in range(rounds) if (record := self.measurement(number, point)) is not None]
        return [run for run in every if run.outcome == Outcome.FINISHED]

    def is_worth_repeating(self, point: Point, number: int) -> bool:
        """Whether a point takes part in a later round: while it has not taken too long."""
        before = self.repeats(point, number)
        return bool(before) and sum(record.total_seconds for record in before) < self.extent.patience

    @property
    def calibrations(self) -> tuple[float, ...]:
        """Time of the fixed work beside every run, s."""
        return tuple(float(record.details[CALIBRATION]) for record in self.study.results() if record.details)

    def records(self, sweep: PointSweep) -> Iterator[BenchRun]:
        """A record per point of a sweep; a sweep there was no time for has its first point to say so."""
        if not sweep.measurements:
            yield replace(
                self._unmeasured_record(sweep.points[0], Failure.TIMED_OUT.value, sweep.ended), ended=sweep.ended
            )
        for point, first in zip(sweep.points, sweep.measurements, strict=False):
            repeats = self.repeats(point, self.extent.repeats)
            yield replace(
                first,
                seconds=min((repeat.seconds for repeat in repeats), default=0.0),
                setup_seconds=min((repeat.setup_seconds for repeat in repeats), default=0.0),
                engine_seconds=min(
                    (repeat.engine_seconds for repeat in repeats if repeat.engine_seconds is not None), default=None
                ),
                readout_seconds=min((repeat.readout_seconds for repeat in repeats), default=0.0),
                repeats=tuple(repeat.seconds for repeat in repeats),
                ended=sweep.ended,
                details={},
            )

    def _unmeasured_record(self, point: Point, outcome: str, detail: str) -> BenchRun:
        case, adapter = self.cases[point.case], engine(point.engine)
        return point_record(case, adapter, point.usage, point.steps_per_turn, outcome=outcome, detail=detail)

    def _point_task(self, number: int, point: Point) -> Task:
        case = self.cases[point.case]
        place = f"{case.mechanism.linkage.name}, {case.motion.regime}"
        return Task(
            key=_task_key(number, point),
            job=(
                self.pickled[point.case],
                point.engine,
                point.usage,
                point.steps_per_turn,
                self.quantities,
                number == 0,
            ),
            label=f"round {number + 1}: {place}, {point.engine} {point.words}",
        )

    def _lost_point(
        self, lost: Lost, pickled: bytes, engine_name: str, usage: Setting | Method, steps: float | None, *_: object
    ) -> BenchRun | None:
        """The record of a run without a result; None if our own deadline ended it, not a fault of the engine."""
        if self.seconds_left() <= 0.0:
            return None
        case, adapter = unpickle_case(pickled), engine(engine_name)
        return point_record(case, adapter, usage, steps, outcome=lost.outcome.value, detail=lost.reason)

    def seconds_left(self) -> float:
        """Time until the deadline, s."""
        return self.ends - time.monotonic()


def _task_key(number: int, point: Point) -> str:
    return f"{number} {point.key}"


QUANTITIES = ("Mkr", "Jeq", "phi", "joint_force")


@dataclass(frozen=True)
class BenchRequest:
    """The request of a benchmark; no ``methods`` means all of them.

    The ``pool`` makes one run at a time on a machine. ``command`` repeats it.
    """

    cases: tuple[Case, ...]
    engines: tuple[str, ...]
    quantities: tuple[str, ...] = QUANTITIES
    settings: tuple[Setting, ...] = tuple(Setting)
    methods: tuple[str, ...] = ()
    extent: Extent = FULL
    pool: Pool = ONE_BY_ONE
    command: str = ""


def bench(request: BenchRequest, announce: Announce = lambda *_: None, finished: Runs | None = None) -> Bench:
    """Measure everything requested; ``finished`` points are not measured again.

    ``announce`` hears a label, how many runs are done and how many are known of. Raises UnknownNameError before any run
    is made.
    """
    for name in request.engines:
        if name not in engine_names():
            raise UnknownNameError("engine", name, engine_names())
    sweeps = list(_sweeps(request))
    rounds = Rounds(
        *(request.cases, request.quantities, request.extent),
        announce=announce,
        finished=finished,
        pool=request.pool,
    )
    longest = 0.0
    for turn in _sweep_groups(request.cases, sweeps):
        begun = time.monotonic()
        if rounds.seconds_left() < longest:  # some points of a curve would show nothing
            for sweep in turn:
                sweep.add(None)
        while batch := [(sweep, point) for sweep in turn if (point := sweep.next()) is not None]:
            rounds.run(0, [point for _, point in batch])
            for sweep, point in batch:
                sweep.add(rounds.measurement(0, point))
        done = [point for sweep in turn for point in sweep.points[: len(sweep.measurements)]]
        for number in range(1, request.extent.repeats):
            rounds.run(number, [point for point in done if rounds.is_worth_repeating(point, number)])
        longest = max(longest, time.monotonic() - begun)
    return judged(Bench(_document(request, sweeps, rounds), _records(request, sweeps, rounds)))


def _document(request: BenchRequest, sweeps: Sequence[PointSweep], rounds: Rounds) -> dict[str, Any]:
    """All but the points, ready for JSON."""
    linkages = {case.mechanism.linkage.name: case.mechanism.linkage for case in request.cases}
    return {
        "command": request.command,
        "conditions": "; ".join(dict.fromkeys(case.conditions for case in request.cases)),
        "environment": environment(request.engines),
        "extent": {name: value for name, value in asdict(request.extent).items() if value != math.inf},
        "noise": {"work": WORK, "samples": [round(calibration, 9) for calibration in rounds.calibrations]},
        "first_use": [{"engine": name, "seconds": _first_uses(sweeps, name)} for name in request.engines],
        "mechanisms": [
            {"name": linkage.name, "title": linkage.title, "variant": linkage.variant} for linkage in linkages.values()
        ],
        "methods": _method_descriptions(request),
        "quantities": list(request.quantities),
    }


def _first_uses(sweeps: Sequence[PointSweep], engine: str) -> tuple[float, ...]:
    """The additional times of an engine's first runs, s: one for every process that measured it."""
    mine = (
        measurement.details
        for sweep in sweeps
        if sweep.points[0].engine == engine
        for measurement in sweep.measurements
    )
    return tuple(float(table[FIRST_USE]) for table in mine if table.get(FIRST_USE))


def _method_descriptions(request: BenchRequest) -> list[Mapping[str, Any]]:
    """The engines' descriptions of their methods, once each."""
    methods: dict[tuple[str, str], Mapping[str, Any]] = {}
    for case in request.cases:
        for name in request.engines:
            for method in _methods(request, case, name):
                methods.setdefault((name, method.name), {"engine": name, **asdict(method)})
    return list(methods.values())


def _methods(request: BenchRequest, case: Case, name: str) -> list[Method]:
    """The requested methods of an engine; empty if it cannot be used here."""
    adapter = engine(name)
    if why_unavailable(adapter) is not None or not isinstance(adapter, StudiedEngine):
        return []
    try:
        offered = adapter.methods(case.scene([Channel.POSITION]))
    except Exception as error:  # a run tells what the adapter raises
        return [Method(name, str(error)) for name in request.methods or ("methods",)]
    return [method for method in offered if not request.methods or method.name in request.methods]


def _sweeps(request: BenchRequest) -> Iterator[PointSweep]:
    """All sweeps of the request; an engine that is not installed has one point that says so."""
    for number, case in enumerate(request.cases):
        for name in request.engines:
            if why_unavailable(engine(name)) is not None:
                yield PointSweep([Point(number, name)], 0.0)
            else:
                methods = _methods(request, case, name)
                yield from planned_sweeps(number, name, methods, request.settings, request.extent)


def _sweep_groups(cases: Sequence[Case], sweeps: Sequence[PointSweep]) -> list[list[PointSweep]]:
    """Sweeps that are measured to their ends and repeated, one group after the other: those of a case at a time.

    Where the time ends first, a linkage of each structure has whole curves, rather than every linkage a point: the
    first case of a structure comes before all that repeat one, single runs before extrapolated ones.
    """
    known: set[frozenset[str]] = set()
    repeated = []
    for case in cases:
        kinds = frozenset(group.kind for group in case.mechanism.structure.groups)
        repeated.append(kinds in known)
        known.add(kinds)

    def place(sweep: PointSweep) -> tuple[bool, bool, int]:
        point = sweep.points[0]
        return repeated[point.case], point.method is not None and point.method.runs > 1, point.case

    return [list(group) for _, group in groupby(sorted(sweeps, key=place), place)]


def _records(request: BenchRequest, sweeps: Sequence[PointSweep], rounds: Rounds) -> list[BenchRun]:
    """All records, by case and engine in the requested order, then as measured."""
    places = {name: place for place, name in enumerate(request.engines)}
    ordered = sorted(sweeps, key=lambda sweep: (sweep.points[0].case, places[sweep.points[0].engine]))
    return [record for sweep in ordered for record in rounds.records(sweep)]
