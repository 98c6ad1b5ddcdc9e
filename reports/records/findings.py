"""What came of judging a folder anew, in lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from comparisons.folders.verification import Verification
from reports.document.parts import Table
from reports.document.terminal import Printed, Printout


def verification_printout(found: Verification) -> Printout:
    """A row for all that differs, and how much was judged anew."""
    rows = [(finding.place, finding.sentence) for finding in found.findings]
    table: list[Printed] = [Table("What differs.", ("where", "what"), rows, "l"), ""] if rows else []
    return Printout(table, [*found.notes, closing_line(found)])


def closing_line(found: Verification) -> str:
    """What was worked out again, what became of it, how much differs."""
    counts = Counter(record.outcome for record in (*found.records, *found.invariants))
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    again = f"computed again: curves {found.curves}, key figures {found.figures}, checksums {found.texts}"
    campaign = (again, f"{counts.total()} records: {outcomes}") if counts else ()
    differs = "nothing differs" if not found.findings else f"differing: {len(found.findings)}"
    return "; ".join((*campaign, *found.studies, differs))


def verification_told(found: Verification) -> Mapping[str, Any]:
    """All of it, JSON-ready."""
    return asdict(found)
