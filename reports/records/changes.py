"""What has changed since results were recorded, in a table and in a line."""

from __future__ import annotations

from collections.abc import Sequence

from analytic.description.written import change
from comparisons.judging.changes import CLOSED_FORM, Change, Kind
from comparisons.judging.limits import grouped
from reports.document.numbers import ABSENT, error
from reports.document.parts import Table

CAPTION = "What is not as it was recorded: errors over the peak, and figures of the closed form in SI."
HEAD = ("mechanism", "regime", "engine", "quantity", "", "before", "now", "unit", "change")


def changes_table(changes: Sequence[Change]) -> tuple[Table, ...]:
    """A table with a row for every change that fails; no table without any.

    Quantities of a run that have no value any more share a row.
    """
    rows = [_row(entry) for entry in changes if entry.fails and entry.after is not None]
    gone = grouped(((entry.run, entry.kind), entry) for entry in changes if entry.fails and entry.after is None)
    rows += [_row(entries[0], len(entries)) for entries in gone.values()]
    return (Table(CAPTION, HEAD, rows, align="lllllrrlr"),) if rows else ()


def _row(entry: Change, count: int = 1) -> tuple[str, ...]:
    """The row of a change, or of ``count`` quantities of a run that have vanished or failed alike."""
    place = (f"{entry.mechanism} ({entry.variant})", entry.regime, f"{entry.engine} {entry.setting}".rstrip())
    is_figure = entry.engine == CLOSED_FORM
    what = f"{entry.kind}: {entry.outcome}" if entry.kind is Kind.FAILING else entry.kind.value
    if count > 1:
        return (*place, f"{count} quantities", what, "", "", "", "")
    values = (ABSENT if v is None else f"{v:.9g}" if is_figure else error(v) for v in (entry.before, entry.after))
    share = entry.share
    words = ABSENT if share is None else change(share, ".2g") if is_figure else f"{1.0 + share:.1f} times"
    return (*place, entry.quantity, what, *values, entry.unit, words)


def appeared_note(changes: Sequence[Change]) -> tuple[str, ...]:
    """A line about what was not recorded, which is no failure; none if everything was."""
    new = [entry for entry in changes if not entry.fails]
    if not new:
        return ()
    runs = list(dict.fromkeys(entry.run for entry in new))
    more = f", and {len(runs) - 1} more" if len(runs) > 1 else ""
    what = "1 result" if len(new) == 1 else f"{len(new)} results"
    return (f"not recorded, which is no failure: {what} of {runs[0]}{more}",)
