"""Where figures come from: those of a run in words, those of an engine in the table of its read-outs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Mapping, Sequence
from typing import Final

from comparisons.conformance.mutants import MUTANT
from comparisons.conformance.trial import CheckResult, Finding
from comparisons.judging.records import CONTROL, IMPORTED, Record
from engines.contract import Origin
from reports.document.numbers import ABSENT
from reports.document.parts import Table, TableCell, Words
from reports.document.templates import plain
from reports.document.terminal import Printout
from reports.records.views import family

READOUTS = ("channel", "in the engine", "frame", "instant", "drive's share")


def origin_words(records: Sequence[Record]) -> str:
    """Of the records of one run: "1 run, read", "read in part", "4 runs, extrapolated", "control", "imported"."""
    words = [record for record in records if record.origin]
    if not words:
        return ""
    if words[0].origin in (CONTROL, IMPORTED):
        return words[0].origin
    runs = max(record.runs for record in words)
    if runs > 1:
        return f"{runs} runs, {Origin.EXTRAPOLATED}"
    return "read in part" if any(r.origin != Origin.READ for r in words) else f"1 run, {Origin.READ}"


def computed_or_shared(records: Sequence[Record]) -> str:
    """The quantities that the adapter computes or shares with the reference, in words; empty without any."""
    families = {
        origin: ", ".join(dict.fromkeys(family(record.quantity) for record in records if record.origin == origin))
        for origin in (Origin.COMPUTED, Origin.PARTLY)
    }
    shared = dict.fromkeys(f"{r.shared} of {r.quantity.replace('_', ' ')}" for r in records if r.shared)
    words = [f"{origin} by its adapter: {names}" for origin, names in families.items() if names]
    return "; ".join([*words, *([f"shared with the reference: {', '.join(shared)}"] if shared else [])])


def readout_table(engine_name: str, groups: Mapping[str, Mapping[str, str]]) -> Table:
    """The read-outs of an engine, as ``Abilities.as_dict`` has them."""
    rows = tuple(
        (plain(channel), names["source"], names["frame"], names["instant"], names["drive"] or ABSENT)
        for channel, names in groups.items()
    )
    return Table(f"{engine_name}: where its figures come from.", READOUTS, rows, align="l")


# The environment of results: date, machine and commit, then all versions on one line.

CONCURRENT_RUNS: Final = "runs at a time"  # how many ran side by side, each on a share of the machine


def environment_facts(environment: Mapping[str, str], leave_out: Container[str] = ()) -> list[tuple[str, str]]:
    """Name and value of each fact; names in ``leave_out`` are given elsewhere."""
    first = [name for name in ("date", "machine", "hosts", "commit", CONCURRENT_RUNS) if name in environment]
    rest = [f"{name} {version}" for name, version in environment.items() if name not in first and name not in leave_out]
    return [*((name.capitalize(), environment[name]) for name in first), ("Versions", ", ".join(rest))]


def concurrency_note(environment: Mapping[str, str]) -> str:
    """A note on times: "while 4 ran" where runs were made side by side, else empty."""
    return f"while {environment[CONCURRENT_RUNS]} ran" if CONCURRENT_RUNS in environment else ""


# The checks of an engine's adapter, as the terminal and Python print them.

STYLES = {Finding.PASSED: "green", Finding.FAILED: "bold red", Finding.EXPECTED: "yellow"}


def printout(engine_name: str, checks: Sequence[CheckResult]) -> Printout:
    """A line of every check, and how many came to what."""
    counts = Counter(each.finding for each in checks)
    closing = f"{engine_name}: " + ", ".join(f"{counts[finding]} {finding}" for finding in Finding if counts[finding])
    return Printout([Table("", ("check", "", ""), _rows(checks), "l")], [closing])


def _rows(results: Sequence[CheckResult]) -> list[Sequence[TableCell | Words]]:
    """A line of every check; of mutants that say the same, one line."""
    groups: Counter[tuple[str, Finding, str]] = Counter()
    for each in results:
        alike = each.check.startswith(MUTANT) and each.finding is not Finding.FAILED
        groups[MUTANT if alike else each.check, each.finding, each.detail] += 1
    return [
        (
            f"{count} mutant{'s' if count > 1 else ''}" if name == MUTANT else name,
            TableCell(finding.value, colour=STYLES.get(finding, "dim")),
            detail,
        )
        for (name, finding, detail), count in groups.items()
    ]
