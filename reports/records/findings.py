"""What came of judging a folder anew, in lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from comparisons.folders.verification import Verification
from reports.document.parts import Table
from reports.document.terminal import Printed, Printout


def verification_printout(verification: Verification) -> Printout:
    """A row for all that differs, and how much was judged anew."""
    rows = [(finding.place, finding.sentence) for finding in verification.findings]
    table: list[Printed] = [Table("What differs.", ("where", "what"), rows, "l"), ""] if rows else []
    return Printout(table, [*verification.notes, closing_line(verification)])


def closing_line(verification: Verification) -> str:
    """What was worked out again, what became of it, how much differs."""
    counts = Counter(record.outcome for record in (*verification.records, *verification.invariants))
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    texts = f"checksums {verification.texts}"
    again = f"computed again: curves {verification.curves}, key figures {verification.figures}, {texts}"
    campaign = (again, f"{counts.total()} records: {outcomes}") if counts else ()
    differs = "nothing differs" if not verification.findings else f"differing: {len(verification.findings)}"
    return "; ".join((*campaign, *verification.studies, differs))


def verification_as_dict(verification: Verification) -> Mapping[str, Any]:
    """All of it, JSON-ready."""
    return asdict(verification)
