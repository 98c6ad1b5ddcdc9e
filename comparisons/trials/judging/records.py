"""What was run, and what was found: a ``RunRecord`` is a row of the one table, an ``Error`` a row of the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from functools import cache
from operator import attrgetter
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Self

from pydantic import InstanceOf, TypeAdapter

from comparisons.trials.runs.store import Curve

if TYPE_CHECKING:
    from comparisons.motion.case import Case


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
        """Whether it counts against the engine or its adapter.

        Those are over the limit, diverged, timed out, crashed and an adapter's error.
        """
        return self in FAILED

    @property
    def judged(self) -> bool:
        """Whether the engine passed or failed; False for a result that could not be judged."""
        return self is Verdict.PASSED or self.failed


CONTROL = "control"  # the origin of the suite's second derivation, which is no engine
IMPORTED = "imported"  # the origin of values read from another tool's files
OUTCOMES: Final = frozenset(verdict.value for verdict in Verdict)
FAILED = frozenset((Verdict.OVER_LIMIT, Verdict.DIVERGED, Verdict.TIMED_OUT, Verdict.CRASHED, Verdict.ADAPTER_ERROR))


class Error(NamedTuple):
    """What was found of a run: the error of a quantity or of a check, beside its limit.

    The first six columns tell the run, and with ``quantity`` the row, from all others. Errors are relative to ``peak``,
    the reference's largest magnitude in ``unit``; ``worst_time``, s, is that of the largest. ``left_out`` counts the
    samples not compared (acceleration jumps, standstill); ``error_at_jumps`` is the error at acceleration jumps, beyond
    the jumps themselves. ``detail`` says why, wherever it did not pass. ``origin`` says where the engine's figure comes
    from (``engines.contract.Origin``, the weakest of all that it is made of, or ``CONTROL``), ``shared`` what of it the
    reference and the engine have in common.
    """

    mechanism: str
    variant: str
    regime: str
    conditions: str
    engine: str
    setting: str
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

    @property
    def run(self) -> RunName:
        """The name of the run that it belongs to: mechanism, variant, regime, engine and setting, a tuple."""
        return (self.mechanism, self.variant, self.regime, self.engine, self.setting)


RunName = tuple[str, str, str, str, str]  # mechanism, variant, regime, engine and setting
NAMES: Final = Error._fields[:6]  # the columns that errors share with their run
_names: Final = attrgetter(*NAMES)
PARTS: Final = ("errors", "invariants")


@dataclass(frozen=True)
class RunRecord:
    """What was run, what it cost, and what was found: its errors by quantity, its invariants, and its curves.

    ``setup_seconds`` is the building of the model, ``seconds`` the stepping alone, ``steps`` all its time steps;
    ``runs`` of the engine make its figures. ``details`` are what its adapter says of it. A curve, by its quantity, has
    ``CURVE`` of the store in its rows, (4, samples). A study whose runs have more columns has a class below this one.
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
    errors: tuple[Error, ...] = ()
    invariants: tuple[Error, ...] = ()
    details: Mapping[str, str | int | float] = field(default_factory=dict)
    curves: Mapping[str, InstanceOf[Curve]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def run(self) -> RunName:
        """The name of the run within its study: mechanism, variant, regime, engine and setting, a tuple."""
        return (self.mechanism, self.variant, self.regime, self.engine, self.setting)

    @property
    def key(self) -> str:
        """The name of the run as one text: MECHANISM/VARIANT/REGIME/ENGINE/SETTING."""
        return "/".join(self.run)

    @property
    def total_seconds(self) -> float:
        """The time of set-up and stepping together, s."""
        return self.setup_seconds + self.seconds

    @property
    def blank(self) -> Error:
        """An Error record of the run with nothing filled in but its names; its outcome is "passed"."""
        return Error(*_names(self))

    def own(self, errors: Iterable[tuple[Any, ...]]) -> tuple[Error, ...]:
        """The ``errors``, rows that end with the columns ``ERRORS``, in this order, as Error records of this run.

        What stands before those columns is replaced by the run's names.
        """
        names = _names(self)
        return tuple([Error._make(names + error[-len(ERRORS) :]) for error in errors])

    @property
    def every(self) -> tuple[Error, ...]:
        """The run's errors, followed by its invariants."""
        return (*self.errors, *self.invariants)

    def judged(self, judge: Callable[[Error], Error]) -> Self:
        """A copy of the run with each error and invariant as ``judge(error)`` returns it, with a new verdict."""
        return replace(self, errors=tuple(map(judge, self.errors)), invariants=tuple(map(judge, self.invariants)))

    def rows(self, errors: Iterable[Error]) -> list[dict[str, Any]]:
        """These ``errors`` as rows, JSON-ready, with the run's own columns, ``FACTS``, in each.

        They are all columns but errors, invariants, details and curves.
        """
        own = {name: getattr(self, name) for name in FACTS}
        return [{**own, **error._asdict()} for error in errors]

    @property
    def data(self) -> dict[str, Any]:
        """The run without its curves, JSON-ready, by column; its errors without the columns that repeat the run's."""
        own = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "curves"}
        parts = {part: [dict(zip(ERRORS, row[len(NAMES) :], strict=True)) for row in own[part]] for part in PARTS}
        return {**own, **parts, "details": dict(self.details)}

    def written(self) -> tuple[Mapping[str, Any], Mapping[str, Curve]]:
        """The run as its two parts for the store: ``data``, and its curves by quantity."""
        return self.data, self.curves

    @classmethod
    @cache
    def _adapter(cls) -> TypeAdapter[Self]:
        """Pydantic's reader and writer of this class, made once."""
        return TypeAdapter(cls)

    @classmethod
    def from_row(cls, row: Mapping[str, Any], curves: Mapping[str, Curve] = MappingProxyType({})) -> Self:
        """A run back from what was ``written``, as the store reads it: errors and invariants are tuples of ``ERRORS``.

        Raises ValueError for a wrong field or outcome, KeyError for a row that lacks errors or invariants, TypeError
        for one of these with a column too few.
        """
        run = cls._adapter().validate_python({name: row[name] for name in row if name not in PARTS})
        errors, checks = (run.own(row[part]) for part in PARTS)
        if not {error.outcome for error in (*errors, *checks)} <= OUTCOMES:
            raise ValueError("it has an outcome that no run can have")
        return replace(run, errors=errors, invariants=checks, curves=curves)


ERRORS: Final = Error._fields[len(NAMES) :]
FACTS: Final = tuple(field.name for field in fields(RunRecord) if field.name not in (*PARTS, "details", "curves"))


def run_of(case: Case, setting: str, engine: str = "", version: str = "") -> RunRecord:
    """The record of a run that is still to be made: its names and the engine's ``version`` alone are filled in.

    ``setting`` may be a method's name; ``engine`` is a name.
    """
    linkage = case.mechanism.linkage
    names = (linkage.name, linkage.variant, case.motion.regime, case.conditions)
    return RunRecord(*names, engine, version, setting)
