"""The record: one deviation of one run, flat and ready for JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from typing import Any


class Verdict(StrEnum):
    """What came of a record."""

    PASSED = "passed"
    OVER_LIMIT = "over-limit"
    DIVERGED = "diverged"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"
    TIMED_OUT = "timed-out"
    CRASHED = "crashed"


@dataclass(frozen=True)
class Record:
    """A deviation beside its limit. Errors are relative to ``peak``, the reference's largest magnitude in ``unit``.

    ``seconds`` is the stepping alone of the run the record belongs to, ``steps`` all its time steps; ``left_out``
    counts the samples not compared (acceleration jumps, standstill). ``detail`` says why, wherever it did not pass.
    """

    mechanism: str
    variant: str
    regime: str
    conditions: str
    engine: str
    engine_version: str
    setting: str
    quantity: str
    unit: str
    error_max: float | None
    error_rms: float | None
    limit: float | None
    baseline: float | None
    outcome: str
    detail: str
    peak: float | None
    worst_time: float | None
    samples: int
    left_out: int
    seconds: float
    setup_seconds: float
    steps: int

    @property
    def run(self) -> tuple[str, str, str, str, str]:
        """What identifies the run behind the record."""
        return (self.mechanism, self.variant, self.regime, self.engine, self.setting)


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
