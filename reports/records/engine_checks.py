"""The checks of an engine's adapter, as the terminal and Python print them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from comparisons.conformance.mutants import MUTANT
from comparisons.conformance.results import CheckResult, Finding
from reports.document.parts import Table, TableCell, Words
from reports.document.terminal import Printout

STYLES = {Finding.PASSED: "green", Finding.FAILED: "bold red", Finding.EXPECTED: "yellow"}


def printout(name: str, checks: Sequence[CheckResult]) -> Printout:
    """A line of every check, and how many came to what."""
    counts = Counter(each.finding for each in checks)
    closing = f"{name}: " + ", ".join(f"{counts[finding]} {finding}" for finding in Finding if counts[finding])
    return Printout([Table("", ("check", "", ""), _rows(checks), "l")], [closing])


def _rows(results: Sequence[CheckResult]) -> list[Sequence[TableCell | Words]]:
    """A line of every check; of mutants that say the same, one line."""
    groups: dict[tuple[str, Finding, str], int] = {}
    for each in results:
        alike = each.check.startswith(MUTANT) and each.finding is not Finding.FAILED
        key = (MUTANT if alike else each.check, each.finding, each.detail)
        groups[key] = groups.get(key, 0) + 1
    return [
        (
            f"{count} mutant{'s' if count > 1 else ''}" if name == MUTANT else name,
            TableCell(finding.value, colour=STYLES.get(finding, "dim")),
            detail,
        )
        for (name, finding, detail), count in groups.items()
    ]
