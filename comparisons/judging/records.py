"""The record: one deviation of one run, flat and ready for JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from comparisons.reference.case import Case


class Verdict(StrEnum):
    """What came of a record: ``failed`` ones count against an engine, those that are not ``judged`` say nothing."""

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
    COMPUTED = "computed"  # compared, but with a number of the adapter's own, not the engine's

    @property
    def failed(self) -> bool:
        """Whether the engine or its adapter is to blame."""
        return self in FAILED

    @property
    def judged(self) -> bool:
        """Whether it says anything of the engine."""
        return self is Verdict.PASSED or self.failed


CONTROL = "control"  # the origin of what is no engine's: the suite's second derivation
IMPORTED = "imported"  # the origin of what another tool's files say
FAILED = frozenset((Verdict.OVER_LIMIT, Verdict.DIVERGED, Verdict.TIMED_OUT, Verdict.CRASHED, Verdict.ADAPTER_ERROR))


@dataclass(frozen=True)
class Record:
    """A deviation beside its limit. Errors are relative to ``peak``, the reference's largest magnitude in ``unit``.

    Of the run the record belongs to, ``setup_seconds`` is the building of the model, ``seconds`` the stepping alone,
    ``steps`` all its time steps; ``left_out``
    counts the samples not compared (acceleration jumps, standstill); ``error_at_jumps`` is the error at acceleration
    jumps, beyond the jumps themselves. ``detail`` says why, wherever it did not pass.
    ``origin`` says where the engine's figure comes from (``engines.contract.Origin``, the weakest of all that it is
    made of, or ``CONTROL``), ``runs`` of how many runs of the engine it is made, ``shared`` what of it the reference
    and the engine have in common. ``host`` names the machine of a cluster that it was made on.
    """

    mechanism: str
    variant: str
    regime: str
    conditions: str
    engine: str
    engine_version: str
    setting: str
    quantity: str = ""
    unit: str = ""
    error_max: float | None = None
    error_rms: float | None = None
    error_at_jumps: float = 0.0
    limit: float | None = None
    baseline: float | None = None
    outcome: str = Verdict.PASSED.value
    detail: str = ""
    peak: float | None = None
    worst_time: float | None = None
    samples: int = 0
    left_out: int = 0
    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    origin: str = ""
    runs: int = 0
    shared: str = ""
    host: str = ""

    @property
    def total_seconds(self) -> float:
        """Set-up and stepping, s."""
        return self.setup_seconds + self.seconds

    @property
    def run(self) -> tuple[str, str, str, str, str]:
        """What identifies the run behind the record."""
        return (self.mechanism, self.variant, self.regime, self.engine, self.setting)


def blank_record(case: Case, setting: str, engine: str = "", version: str = "", host: str = "") -> Record:
    """What all records of one run of a case share."""
    linkage = case.mechanism.linkage
    names = (linkage.name, linkage.variant, case.motion.regime, case.conditions)
    return Record(*names, engine, version, setting, host=host)


def to_json(document: Mapping[str, Any]) -> str:
    """JSON text with records written out; NaN never appears."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False, default=_plain) + "\n"


def _plain(value: object) -> object:
    if isinstance(value, Record):
        return asdict(value)
    raise TypeError(f"cannot write {type(value).__name__} as JSON")


def from_rows(rows: Iterable[Mapping[str, Any]]) -> tuple[Record, ...]:
    """Records back from their JSON rows; raises KeyError where one lacks a field."""
    names = [field.name for field in fields(Record)]
    return tuple(Record(**{name: row[name] for name in names}) for row in rows)
