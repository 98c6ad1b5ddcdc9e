"""The record of a run: its identity, cost and errors; and a flat record for each of its quantities."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Self

from pydantic import InstanceOf, TypeAdapter

from comparisons.runs.store import Curve

if TYPE_CHECKING:
    from comparisons.case import Case


class Verdict(StrEnum):
    """The outcome of a record: ``failed`` ones count against an engine, those that are not ``judged`` do not count."""

    PASSED = "passed"
    OVER_LIMIT = "over-limit"
    DIVERGED = "diverged"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"
    TIMED_OUT = "timed-out"
    CRASHED = "crashed"
    ADAPTER_ERROR = "adapter-error"  # the engine's adapter raised
    SUITE_ERROR = "suite-error"  # the reference, the judging or a check raised: no fault of the engine
    UNDEFINED = "undefined"  # no sample to judge by
    NOT_PROVIDED = "not-provided"  # a channel that the engine does not offer
    MEASURED = "measured"  # compared, without a limit
    COMPUTED = "computed"  # compared, but with a number of the adapter's own, not the engine's

    @property
    def failed(self) -> bool:
        """Whether the engine or its adapter is to blame."""
        return self in FAILED

    @property
    def judged(self) -> bool:
        """Whether the engine passed or failed; False for a result that could not be judged."""
        return self is Verdict.PASSED or self.failed


CONTROL = "control"  # the origin of the suite's second derivation, which is no engine
IMPORTED = "imported"  # the origin of values read from another tool's files
OUTCOMES: Final = frozenset(verdict.value for verdict in Verdict)
FAILED = frozenset((Verdict.OVER_LIMIT, Verdict.DIVERGED, Verdict.TIMED_OUT, Verdict.CRASHED, Verdict.ADAPTER_ERROR))


@dataclass(frozen=True)
class RunFacts:
    """The identity and cost of a run.

    ``setup_seconds`` is the building of the model, ``seconds`` the stepping alone, ``steps`` all its time steps;
    ``runs`` of the engine make its figures.
    """

    mechanism: str
    variant: str
    regime: str
    conditions: str
    engine: str
    engine_version: str
    setting: str
    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    runs: int = 0

    @property
    def total_seconds(self) -> float:
        """Set-up and stepping, s."""
        return self.setup_seconds + self.seconds

    @property
    def run(self) -> tuple[str, str, str, str, str]:
        """The key of the run within its study."""
        return (self.mechanism, self.variant, self.regime, self.engine, self.setting)

    @property
    def key(self) -> str:
        """The key of the run as one text."""
        return "/".join(self.run)


@dataclass(frozen=True)
class QuantityRecord:
    """A quantity's error beside its limit, relative to ``peak``, the reference's largest magnitude in ``unit``.

    ``left_out`` counts the samples not compared (acceleration jumps, standstill); ``error_at_jumps`` is the error at
    acceleration jumps, beyond the jumps themselves. ``detail`` says why, wherever it did not pass.
    ``origin`` says where the engine's figure comes from (``engines.contract.Origin``, the weakest of all that it is
    made of, or ``CONTROL``), ``shared`` what of it the reference and the engine have in common.
    """

    quantity: str = ""
    unit: str = ""
    error_max: float | None = None
    error_rms: float | None = None
    error_at_jumps: float = 0.0
    limit: float | None = None
    outcome: str = Verdict.PASSED.value
    detail: str = ""
    peak: float | None = None
    worst_time: float | None = None
    samples: int = 0
    left_out: int = 0
    origin: str = ""
    shared: str = ""


@dataclass(frozen=True)
class Record(QuantityRecord, RunFacts):
    """A run seen in one of its quantities: flat, for tables."""


FACTS: Final = tuple(field.name for field in fields(RunFacts))
ERRORS: Final = tuple(field.name for field in fields(QuantityRecord))


@dataclass(frozen=True)
class RunRecord(RunFacts):
    """One run: its errors by quantity, its invariants, what its adapter says of it, and the curves behind the errors.

    A curve, by its quantity, has ``CURVE`` of the store in its rows, (4, samples). A study whose runs have more to them
    has a class of its own below this one.
    """

    errors: tuple[QuantityRecord, ...] = ()
    invariants: tuple[QuantityRecord, ...] = ()
    details: Mapping[str, str | int | float] = field(default_factory=dict)
    curves: Mapping[str, InstanceOf[Curve]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def records(self) -> tuple[Record, ...]:
        """The run in each of its quantities."""
        return self._flat_records(self.errors)

    @property
    def checks(self) -> tuple[Record, ...]:
        """A record of each of the run's invariants."""
        return self._flat_records(self.invariants)

    @property
    def every(self) -> tuple[Record, ...]:
        """A record of each of the run's quantities, then of each of its invariants."""
        return (*self.records, *self.checks)

    def _flat_records(self, errors: Iterable[QuantityRecord]) -> tuple[Record, ...]:
        facts = {name: getattr(self, name) for name in FACTS}
        return tuple(Record(**facts, **vars(error)) for error in errors)

    def judged(self, judge: Callable[[Record], Record]) -> RunRecord:
        """The run with a new verdict of every error and invariant: ``judge`` returns each record with its verdict."""
        errors, checks = (
            tuple(_quantity_record(judge(record)) for record in part) for part in (self.records, self.checks)
        )
        return replace(self, errors=errors, invariants=checks)

    @property
    def data(self) -> dict[str, Any]:
        """All but the curves, JSON-ready."""
        own = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "curves"}
        errors, invariants = ([vars(record) for record in part] for part in (self.errors, self.invariants))
        return {**own, "errors": errors, "invariants": invariants, "details": dict(self.details)}

    def written(self) -> tuple[Mapping[str, Any], Mapping[str, Curve]]:
        """The run for a file: ``data`` and curves."""
        return self.data, self.curves

    @classmethod
    @cache
    def _adapter(cls) -> TypeAdapter[Self]:
        return TypeAdapter(cls)

    @classmethod
    def from_row(cls, row: Mapping[str, Any], curves: Mapping[str, Curve] = MappingProxyType({})) -> Self:
        """A run back from what was ``written``; raises ValueError for anything else."""
        parts = ("errors", "invariants")
        errors, checks = (tuple(QuantityRecord(*values) for values in row[part]) for part in parts)
        if not {error.outcome for error in (*errors, *checks)} <= OUTCOMES:
            raise ValueError("it has an outcome that no run can have")
        facts = cls._adapter().validate_python({name: row[name] for name in row if name not in parts})
        return replace(facts, errors=errors, invariants=checks, curves=curves)


def run_record(
    facts: RunFacts,
    records: Iterable[Record],
    checks: Iterable[Record] = (),
    curves: Mapping[str, Curve] = MappingProxyType({}),
    details: Mapping[str, str | int | float] = MappingProxyType({}),
) -> RunRecord:
    """A run of its facts and of flat records."""
    own = {name: getattr(facts, name) for name in FACTS}
    errors, invariants = (tuple(map(_quantity_record, part)) for part in (records, checks))
    return RunRecord(**own, errors=errors, invariants=invariants, details=dict(details), curves=dict(curves))


def _quantity_record(record: Record) -> QuantityRecord:
    return QuantityRecord(**{name: getattr(record, name) for name in ERRORS})


def blank_record(case: Case, setting: str, engine: str = "", version: str = "") -> Record:
    """A record with the fields that all records of one run of a case share."""
    linkage = case.mechanism.linkage
    names = (linkage.name, linkage.variant, case.motion.regime, case.conditions)
    return Record(*names, engine, version, setting)
