"""Judging a record: its error against its limit and against its baseline."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TypeVar

from comparisons.judging.baseline import Baseline
from comparisons.judging.limits import LimitTable, shipped_limits
from comparisons.judging.records import Record, Verdict
from engines.contract import Origin, Setting

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")


@dataclass(frozen=True)
class Standard:
    """The standard for records: a table of limits and a baseline."""

    limits: LimitTable
    baseline: Baseline = field(default_factory=Baseline)

    def judge(self, record: Record) -> Record:
        """Compare a record's error with its limit and with three times its recorded value.

        ``error_at_jumps``, the error beyond the jump of samples at an acceleration jump, has the same limit. A figure
        that is the adapter's own says nothing of the engine; what has no error, or was left undecided, stays as it is.
        """
        error = record.error_max
        if error is None or not (record.outcome == Verdict.COMPUTED or Verdict(record.outcome).judged):
            return record
        bound = self.limits.limit(record.quantity, record.setting, record.regime, record.mechanism).value
        grown = self.baseline.allowed(replace(record, limit=bound))
        record = replace(record, limit=bound, baseline=grown, outcome=Verdict.PASSED.value, detail="")
        if record.origin == Origin.COMPUTED:
            detail = "computed by the adapter from the linkage's data, not read from the engine"
            return replace(record, outcome=Verdict.COMPUTED.value, detail=detail)
        if not error <= bound:
            detail = f"error {error:.2g} of peak is over its limit {bound:.2g}"
        elif grown is not None and error > grown:
            detail = (
                f"error {error:.2g} of peak is within its limit {bound:.2g} but over {grown:.2g}, three times its "
                "recorded value"
            )
        elif not record.error_at_jumps <= bound:
            detail = (
                f"error {record.error_at_jumps:.2g} of peak at an acceleration jump, besides the jump itself, is over "
                f"its limit {bound:.2g}"
            )
            record = replace(record, error_max=record.error_at_jumps)
        else:
            return record
        return replace(record, outcome=Verdict.OVER_LIMIT.value, detail=detail)


@cache
def shipped_standard() -> Standard:
    """The suite's own limits, and no baseline."""
    return Standard(shipped_limits())


def judge(record: Record) -> Record:
    """A record by the suite's own limits."""
    return shipped_standard().judge(record)


def deciding(records: Sequence[Record]) -> Sequence[Record]:
    """The records that decide whether a campaign has passed: naive ones only where nothing else ran."""
    return [record for record in records if record.setting != Setting.NAIVE] or records


def grouped(pairs: Iterable[tuple[K, V]]) -> dict[K, list[V]]:
    """The second parts of pairs grouped by the first, both in the order of the pairs."""
    groups: dict[K, list[V]] = {}
    for key, entry in pairs:
        groups.setdefault(key, []).append(entry)
    return groups
