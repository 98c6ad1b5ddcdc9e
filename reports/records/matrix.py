"""All records of a campaign in order: their limits, and those that the baseline caught."""

from __future__ import annotations

from comparisons.campaign.results import Results
from comparisons.judging.limits import LimitTable
from comparisons.judging.records import IMPORTED, Record, Verdict
from comparisons.judging.verdicts import grouped
from reports.document.numbers import bound
from reports.document.parts import Table
from reports.document.templates import plain
from reports.records.views import SETTINGS, columns, family, ordered


def every_record(results: Results) -> tuple[Record, ...]:
    """Records and invariants in stable order."""
    return ordered(results, (*results.records, *results.invariants))


def past_baseline(results: Results) -> tuple[str, ...]:
    """Records that are within their limit and were caught by the recorded baseline, each in one sentence."""
    return tuple(
        f"{r.mechanism} ({r.variant}), {r.regime}, {r.engine} {r.setting}, {r.quantity}: {r.detail}"
        for r in every_record(results)
        if r.outcome == Verdict.OVER_LIMIT.value and r.baseline is not None and is_within(r)
    )


def is_within(record: Record) -> bool:
    """Whether there is an error within the limit, so that only the baseline can have caught it."""
    return record.error_max is not None and record.limit is not None and record.error_max <= record.limit


def _limit(record: Record, limits: LimitTable) -> tuple[float, str]:
    """The limit of a record and its reason; that of another tool's results is the user's."""
    if record.origin == IMPORTED and record.limit is not None:
        return record.limit, "your --limit, or for a check the rounding of its columns"
    table = limits.limit(record.quantity, record.setting, record.regime, record.mechanism)
    value = record.limit if record.limit is not None else table.value
    return value, table.reason if value == table.value else "as the table of limits stood when the campaign ran"


def limit_table(results: Results) -> Table:
    """The limits of these records, largest first within the order of the quantities."""
    names = [name for part in columns(results) for name in part]
    groups = grouped((_limit(record, results.limits), record) for record in every_record(results))
    rows = []
    for (value, reason), records in groups.items():
        families = {family(record.quantity) for record in records}
        settings, regimes = {r.setting for r in records}, {r.regime for r in records}
        quantities = [name for name in names if name in families]
        cells = (
            plain(", ".join(quantities)),
            ", ".join(s for s in SETTINGS if s in settings),
            ", ".join(sorted(regimes)),
            bound(value),
            reason,
        )
        rows.append((names.index(quantities[0]), -value, cells))
    ordered_rows = tuple(cells for _, _, cells in sorted(rows, key=lambda entry: entry[:2]))
    caption = "What a largest error over the reference's peak may be, and why."
    return Table(caption, ("Quantities", "Settings", "Regimes", "Limit", "Reason"), ordered_rows, align="lllrl")
