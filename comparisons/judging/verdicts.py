"""Judging a record: its error against the table of limits and against what was recorded of it before."""

from __future__ import annotations

from dataclasses import replace

from comparisons.judging import baseline
from comparisons.judging.limits import limit
from comparisons.judging.records import Record, Verdict


def judge(record: Record) -> Record:
    """Hold a record's error against its limit and against three times its recorded value."""
    error = record.error_max
    assert error is not None
    bound = limit(record.quantity, record.setting, record.regime).value
    grown = baseline.allowed(replace(record, limit=bound))
    record = replace(record, limit=bound, baseline=grown)
    if not error <= bound:
        detail = f"error {error:.2g} of peak is over its limit {bound:.2g}"
    elif grown is not None and error > grown:
        detail = (
            f"error {error:.2g} of peak is within its limit {bound:.2g} but over {grown:.2g}, three times its "
            "recorded value"
        )
    else:
        return record
    return replace(record, outcome=Verdict.OVER_LIMIT.value, detail=detail)
