"""The runs of a benchmark, one to a point, as a table; saved and read back."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from pydantic import TypeAdapter
from typing_extensions import TypedDict

from comparisons.trials.judging.records import Run, Verdict
from comparisons.trials.runs.store import load_study, save_study
from engines.contract import Outcome

if TYPE_CHECKING:
    from pandas import DataFrame

KIND: Final = "bench"
SETTING, METHOD = "setting", "method"


@dataclass(frozen=True, kw_only=True)
class BenchRun(Run):
    """The run of a point; ``errors`` are empty where it did not finish.

    ``kind`` tells a setting, whose steps its adapter fixes (``step`` is None), from a method, which takes the ``step``,
    s, it is requested. ``is_control``: the engine is the reference's control, never ranked. ``repeats`` are all wall
    times of the stepping alone, s. ``detail`` says why, where it did not finish; ``used`` is what the adapter says of
    the run, ``ended`` why its sweep goes no further. ``orders`` are those of the point's whole sweep, by quantity;
    in the quantities of ``fronts`` no other point of the engine, single runs and extrapolated ones apart, is as cheap
    and as exact.

    Set-up, stepping and reading out (wall time of the call less the other two) are the shortest of the repeats, s, 0
    where it did not finish; 0 ``runs`` gave no motion. So is ``engine_seconds``, the part of a setting's stepping
    inside the engine's own calls, clocked in runs of their own; None where the adapter does not name these. A quantity
    that the engine does not tell has no error, and says why.
    """

    is_control: bool
    kind: str
    effort: float | None
    effort_unit: str
    step: float | None
    steps_per_turn: float | None
    repeats: tuple[float, ...] = ()
    readout_seconds: float = 0.0
    engine_seconds: float | None = None
    solver_work: int = 0
    work_unit: str
    outcome: str
    detail: str = ""
    used: str = ""
    ended: str = ""
    orders: Mapping[str, float] = field(default_factory=dict)
    fronts: tuple[str, ...] = ()

    @property
    def seconds_median(self) -> float:
        """The median of the repeats, s."""
        return statistics.median(self.repeats) if self.repeats else 0.0

    @property
    def overhead(self) -> float | None:
        """Share of the stepping outside the engine's own calls; None where that is not known."""
        if self.engine_seconds is None or not self.seconds:
            return None
        return max(0.0, 1.0 - self.engine_seconds / self.seconds)

    @property
    def is_extrapolated(self) -> bool:
        """Whether several runs were extrapolated."""
        return self.runs > 1

    @property
    def key(self) -> str:
        """The unique key of the point."""
        return super().key + ("" if self.step is None else f", step {self.step!r}")

    def columns(self, quantities: Sequence[str]) -> Iterator[dict[str, Any]]:
        """A row for each of its quantities; of one that did not finish, for each of those requested.

        A quantity that the engine does not tell at all is not provided there. ``finished`` has both an error and a
        time, ``left_out`` says what of a quantity the engine does not tell.
        """
        derived = ("key", "total_seconds", "seconds_median", "overhead", "is_extrapolated")
        own = vars(self) | {name: getattr(self, name) for name in derived}
        for error in self.errors or [self.blank._replace(quantity=name) for name in quantities]:
            is_lacking = bool(self.errors) and error.error_max is None
            yield {
                **own,
                "quantity": error.quantity,
                "unit": error.unit,
                "error_max": error.error_max,
                "error_rms": error.error_rms,
                "peak": error.peak,
                "left_out": error.detail,
                "outcome": Verdict.NOT_PROVIDED.value if is_lacking else self.outcome,
                "detail": error.detail if is_lacking else self.detail,
                "finished": self.outcome == Outcome.FINISHED and error.error_max is not None and bool(self.repeats),
                "order": self.orders.get(error.quantity),
            }


class SavedBench(TypedDict):
    """The document of a benchmark, all but its records."""

    command: str
    conditions: str
    environment: Mapping[str, str]
    extent: Mapping[str, Any]
    mechanisms: list[Mapping[str, str]]
    methods: list[Mapping[str, Any]]  # as the engines describe them
    quantities: list[str]


FORM: Final[TypeAdapter[Any]] = TypeAdapter(SavedBench)


@dataclass(frozen=True)
class Bench:
    """A finished benchmark: its document as saved, and a run per point."""

    document: Mapping[str, Any]
    points: Sequence[BenchRun]

    @property
    def as_dict(self) -> dict[str, Any]:
        """The document and all points, JSON-ready."""
        return {**self.document, "records": [point.data for point in self.points]}

    @cached_property
    def table(self) -> DataFrame:
        """A row for every point in each of its quantities, with the columns of ``BenchRun.columns``."""
        from pandas import DataFrame  # noqa: PLC0415  half a second that a worker process saves

        rows = [row for point in self.points for row in point.columns(self.document["quantities"])]
        return DataFrame(rows, dtype=object).astype(dict.fromkeys(("finished", "is_control", "is_extrapolated"), bool))

    @cached_property
    def noise(self) -> float:
        """By which share the median of a point's repeats is longer than the shortest, in the median of all points."""
        excess = [point.seconds_median / min(point.repeats) - 1.0 for point in self.points if len(point.repeats) > 1]
        return statistics.median(excess) if excess else 0.0


def save(folder: Path, bench: Bench) -> None:
    """Write a benchmark into a folder."""
    save_study(folder, KIND, bench.document, ((point.key, *point.written()) for point in bench.points))


def load(folder: Path) -> Bench:
    """Read a benchmark back; no engine is imported. Raises LinkproofError if it is missing or damaged."""
    return Bench(*load_study(folder, KIND, FORM, BenchRun.from_row))
