"""The ledger of a benchmark under way: everything taken so far, kept in a journal if there is one, and its records."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from comparisons.reference.case import Case
from comparisons.runs.failures import Failure
from comparisons.runs.journal import Journal
from comparisons.runs.timing import smallest_and_median
from comparisons.work_precision.measure import Taken, longest_step
from comparisons.work_precision.points import Extent, Point, Track
from comparisons.work_precision.records import METHOD, SETTING, PointError, PointRecord
from engines.contract import Engine, Outcome


@dataclass
class Ledger:
    """What was taken, by round and point; a journal hands back what an interrupted benchmark has."""

    journal: Journal | None = None
    taken: dict[str, Taken] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for key, payload in (self.journal.kept() if self.journal else {}).items():
            self.taken[key] = _from_json(payload)

    def has(self, number: int, point: Point) -> bool:
        """Whether a point has been taken in a round."""
        return _key(number, point) in self.taken

    def get(self, number: int, point: Point) -> Taken:
        """What a point took in a round."""
        return self.taken[_key(number, point)]

    def keep(self, number: int, point: Point, taken: Taken) -> None:
        """Write down what a point took in a round."""
        self.taken[_key(number, point)] = taken
        if self.journal:
            self.journal.keep(_key(number, point), json.dumps(asdict(taken)).encode())

    def repeats(self, point: Point, rounds: int) -> list[Taken]:
        """What a point took, round by round, where it finished."""
        found = [self.get(number, point) for number in range(rounds) if self.has(number, point)]
        return [taken for taken in found if taken.outcome == Outcome.FINISHED]

    def is_worth_repeating(self, point: Point, number: int, extent: Extent) -> bool:
        """Whether a point takes part in a later round: while it has not taken too long."""
        before = self.repeats(point, number)
        return bool(before) and sum(taken.seconds for taken in before) < extent.patience

    @property
    def calibrations(self) -> tuple[float, ...]:
        """How long the fixed work took beside every run, s."""
        return tuple(taken.calibration for taken in self.taken.values() if taken.calibration > 0.0)


def _key(number: int, point: Point) -> str:
    return f"{number} {point.key}"


def _from_json(payload: bytes) -> Taken:
    row: dict[str, Any] = json.loads(payload)
    return Taken(**{**row, "errors": {name: PointError(**error) for name, error in row["errors"].items()}})


@dataclass(frozen=True)
class Subject:
    """What a sweep's records share: its case, its engine, that engine's version."""

    case: Case
    adapter: Engine
    version: str


def records(subject: Subject, track: Track, ledger: Ledger, rounds: int) -> Iterator[PointRecord]:
    """A record per point of a sweep; a sweep there was no time for has its first point to say so."""
    for point, taken in zip(track.points, track.taken or [Taken(Failure.TIMED_OUT.value, track.ended)], strict=False):
        yield _record(subject, point, taken, ledger.repeats(point, rounds), track.ended)


def _record(subject: Subject, point: Point, taken: Taken, repeats: Sequence[Taken], ended: str) -> PointRecord:
    linkage, method = subject.case.mechanism.linkage, point.method
    least, median = smallest_and_median([one.seconds for one in repeats])
    steps = point.steps_per_turn
    return PointRecord(
        mechanism=linkage.name,
        variant=linkage.variant,
        regime=subject.case.motion.regime,
        engine=point.engine,
        engine_version=subject.version,
        kind=METHOD if method else SETTING,
        setting=method.name if method else str(point.setting or ""),
        levels=method.levels if method else 0,
        effort=method.effort if method else None,
        effort_unit=method.effort_unit if method else "",
        step=longest_step(subject.case, steps) if steps else None,
        steps_per_turn=steps,
        errors=taken.errors,
        seconds_min=least,
        seconds_median=median,
        repeats=tuple(one.seconds for one in repeats),
        setup_seconds=min((one.setup for one in repeats), default=None),
        readout_seconds=min((one.readout for one in repeats), default=None),
        steps=taken.steps,
        solver_work=taken.solver_work,
        work_unit=subject.adapter.work_unit,
        outcome=taken.outcome,
        detail=taken.reason,
        used=taken.used,
        ended=ended,
    )
