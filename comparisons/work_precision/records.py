"""The records of a benchmark, one to a point, saved and read back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field, NonNegativeFloat, TypeAdapter
from typing_extensions import TypedDict

from comparisons.judging.records import Verdict
from comparisons.runs.study_folder import load_study, save_study, usable
from comparisons.runs.timing import Noise
from engines.contract import Outcome

KIND: Final = "bench"
SETTING, METHOD = "setting", "method"


@dataclass(frozen=True)
class PointError:
    """A point's errors in one quantity, over ``peak``, the truth's largest magnitude in ``unit``.

    ``order`` is that of the point's whole sweep. ``on_front``: no other point of the engine, single runs and
    extrapolated ones apart, is as cheap and as exact.
    """

    unit: str
    error_max: float
    error_rms: float
    peak: float
    order: float | None = None
    on_front: bool = False


@dataclass(frozen=True)
class PointRecord:
    """One point, as it is saved; ``errors`` by quantity are empty where it did not finish.

    ``kind`` tells a setting, whose steps its adapter fixes (``step`` is None), from a method, which takes the ``step``,
    s, it is requested. ``runs`` of the engine are extrapolated to make it; 1 is a single run, 0 one that gave no
    motion. ``is_control``: the engine is the reference's control, never ranked. ``seconds_min`` and ``seconds_median``
    are of ``repeats``, all wall times of the stepping alone, s; ``setup_seconds`` and ``readout_seconds`` are the
    shortest of theirs. ``left_out`` says of quantities, by name, what of them the engine does not tell. ``detail`` says
    why, where it did not finish; ``used`` is what the adapter says of the run, ``ended`` why its sweep goes no further.
    ``host`` names the machine of a cluster that all of it was measured on.
    """

    mechanism: str
    variant: str
    regime: str
    engine: str
    engine_version: str
    is_control: bool
    kind: str
    setting: str
    runs: int
    effort: float | None
    effort_unit: str
    step: float | None
    steps_per_turn: float | None
    errors: Mapping[str, PointError]
    left_out: Mapping[str, str]
    seconds_min: float | None
    seconds_median: float | None
    repeats: tuple[float, ...]
    setup_seconds: float | None
    readout_seconds: float | None
    steps: int
    solver_work: int
    work_unit: str
    outcome: str
    detail: str
    used: str
    ended: str
    host: str = field(default="", kw_only=True)

    @property
    def place(self) -> tuple[str, str, str]:
        """Mechanism, variant and regime."""
        return (self.mechanism, self.variant, self.regime)

    @property
    def total_seconds(self) -> float:
        """Set-up and stepping, each the shortest of the repeats, s; 0 where it did not finish."""
        return (self.setup_seconds or 0.0) + (self.seconds_min or 0.0)

    @property
    def is_extrapolated(self) -> bool:
        """Whether it is no single run."""
        return self.runs > 1


@dataclass(frozen=True)
class BenchRecord(PointRecord):
    """A point seen in one of its quantities."""

    quantity: str

    @property
    def sweep(self) -> tuple[str, str, str, str, str, str, float | None, str]:
        """What the points of one sweep share: all but the step."""
        return (*self.place, self.engine, self.kind, self.setting, self.effort, self.quantity)

    @property
    def error(self) -> PointError | None:
        """The errors in this quantity; None where it did not finish."""
        return self.errors.get(self.quantity)

    @property
    def error_max(self) -> float | None:
        """The largest error, over the peak."""
        return self.error.error_max if self.error else None

    @property
    def finished(self) -> bool:
        """Whether it has an error and a time to go with it."""
        return self.outcome == Outcome.FINISHED and self.error is not None and self.seconds_min is not None


def by_quantity(points: Iterable[PointRecord], quantities: Sequence[str]) -> tuple[BenchRecord, ...]:
    """Points in each of their quantities; one that did not finish in all requested ``quantities``.

    A quantity that the engine does not tell at all is not provided there.
    """
    found = []
    for point in points:
        for name in dict.fromkeys([*point.errors, *point.left_out]) or quantities:
            told = vars(point)
            if name in point.left_out and name not in point.errors:
                told = {**told, "outcome": Verdict.NOT_PROVIDED.value, "detail": point.left_out[name]}
            found.append(BenchRecord(**told, quantity=name))
    return tuple(found)


@dataclass(frozen=True)
class MeasuredCost:
    """One reduction of a linkage in one engine.

    ``solver`` is the engine, the reference's control where ``is_control``; ``about`` is what is recorded. ``seconds``
    are of every repeat, s: whole runs, of which ``stepping`` is the engine's own share.
    """

    mechanism: str
    variant: str
    solver: str
    reduction: str
    about: str
    outcome: str = Outcome.FINISHED.value
    reason: str = ""
    seconds: Annotated[tuple[float, ...], Field(min_length=1)] = ()
    stepping: tuple[float, ...] = ()
    steps: int = 0
    is_control: bool = False


class SavedExtent(TypedDict):
    """How much was measured."""

    budget: float
    repeats: int
    patience: float


class SavedNoise(TypedDict):
    """How long the same work took each time, s."""

    work: str
    samples: list[NonNegativeFloat]


class SavedFirstUse(TypedDict):
    """What an engine's first scene costs beyond its second, s."""

    engine: str
    seconds: list[float]


class SavedMechanism(TypedDict):
    """A linkage that was measured."""

    name: str
    title: str


class SavedMethod(TypedDict):
    """What an engine says of a method."""

    engine: str
    name: str
    about: str
    runs: int
    effort: float | None
    effort_unit: str


class SavedBench(TypedDict):
    """The document of a benchmark, all but its records."""

    command: str
    conditions: str
    environment: Mapping[str, str]
    extent: SavedExtent
    noise: SavedNoise
    first_use: list[SavedFirstUse]
    mechanisms: list[SavedMechanism]
    methods: list[SavedMethod]
    costs: list[MeasuredCost]
    quantities: list[str]


FORM: Final[TypeAdapter[Any]] = TypeAdapter(SavedBench)
_POINTS: Final = TypeAdapter(tuple[PointRecord, ...])
_COSTS: Final = TypeAdapter(tuple[MeasuredCost, ...])


@dataclass(frozen=True)
class Bench:
    """A finished benchmark: its document as saved, and its records."""

    document: Mapping[str, Any]

    @cached_property
    def points(self) -> tuple[PointRecord, ...]:
        """One record per point."""
        return _POINTS.validate_python(self.document["records"])

    @cached_property
    def records(self) -> tuple[BenchRecord, ...]:
        """Every point in each of its quantities."""
        return by_quantity(self.points, self.document["quantities"])

    @cached_property
    def costs(self) -> tuple[MeasuredCost, ...]:
        """What each output and load costs; empty if not requested."""
        return _COSTS.validate_python(self.document["costs"])

    @cached_property
    def noise(self) -> Noise:
        """The machine's, as measured beside the points."""
        return Noise(tuple(self.document["noise"]["samples"]))


def rows(records: Iterable[PointRecord | MeasuredCost]) -> list[dict[str, Any]]:
    """Records as JSON has them."""
    return [asdict(record) for record in records]


def save(folder: Path, document: Mapping[str, Any]) -> None:
    """Write a benchmark into a folder."""
    head = {name: value for name, value in document.items() if name != "records"}
    save_study(folder, KIND, head, ((f"{number}", row, {}) for number, row in enumerate(document["records"])))


def load(folder: Path) -> Bench:
    """Read a benchmark back; no engine is imported. Raises LinkproofError where there is none, or it is damaged."""
    saved = load_study(folder, KIND, FORM)
    bench = Bench({**saved.document, "records": list(saved.rows())})
    with usable(folder, KIND):
        _ = bench.records, bench.costs
    return bench
