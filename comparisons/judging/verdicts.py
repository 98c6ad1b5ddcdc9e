"""Judging a record: its error against the table of limits and against what was recorded of it before."""

from __future__ import annotations

from dataclasses import replace

from comparisons.judging import baseline
from comparisons.judging.limits import limit
from comparisons.judging.records import Record, Verdict
from engines.contract import Origin


def judge(record: Record, error_at_jumps: float = 0.0) -> Record:
    """Compare a record's error with its limit and with three times its recorded value.

    ``error_at_jumps``, the error beyond the jump of samples at an acceleration jump, has the same limit. A figure that
    is the adapter's own says nothing of the engine.
    """
    error = record.error_max
    assert error is not None
    bound = limit(record.quantity, record.setting, record.regime).value
    grown = baseline.allowed(replace(record, limit=bound))
    record = replace(record, limit=bound, baseline=grown)
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
    elif not error_at_jumps <= bound:
        record = replace(record, error_max=error_at_jumps)
        detail = (
            f"error {error_at_jumps:.2g} of peak at an acceleration jump, besides the jump itself, is over "
            f"its limit {bound:.2g}"
        )
    else:
        return record
    return replace(record, outcome=Verdict.OVER_LIMIT.value, detail=detail)
