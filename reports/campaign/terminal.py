"""A campaign for a terminal: errors beside their limits, and the details of every record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from types import MappingProxyType

from comparisons.trials.judging.changes import Change
from comparisons.trials.judging.records import CONTROL, Error, RunRecord, Verdict
from reports.document.parts import Paragraph, Table, TableCell, Words
from reports.document.terminal import Printed, Printout
from reports.mechanism.engines import error_cell, error_rows, limit_words, reasons, remedies
from reports.records import (
    appeared_note,
    changes_table,
    computed_or_shared,
    concurrency_note,
    family,
    origin_words,
)

ACROSS = 4  # runs side by side in a table of 80 columns
# Columns of the table of all records that the terminal has if it is verbose.
DETAILS = ["mechanism", "variant", "regime", "engine", "setting", "quantity", "origin", "outcome", "error_max",
           "error_rms", "limit", "peak", "unit", "worst_time", "samples", "left_out", "detail"]  # fmt: skip


def printout(
    runs: Iterable[RunRecord],
    changes: Sequence[Change] = (),
    environment: Mapping[str, str] = MappingProxyType({}),
) -> Printout:
    """The printed comparison: one table per mechanism and regime, quantities down, runs across; then the changes.

    ``runs`` are gone through again for each part of it, so no iterator will do. ``environment`` says how many ran at a
    time. Reasons, advice and counts close it; tables and details are made as they are printed.
    """
    closing = [
        *appeared_note(changes),
        *reasons(_unjudged(runs), _place),
        *remedies((run.every for run in runs), _place),
        *_counts(changes),
        _closing_line(runs),
    ]
    return Printout(_motion_tables(runs, changes, concurrency_note(environment)), closing, _details(runs))


def _motion_tables(runs: Iterable[RunRecord], changes: Sequence[Change], while_others: str) -> Iterator[Printed]:
    """Yield the tables of each mechanism and regime, four runs each, then of what has changed.

    ``while_others`` notes how many ran at a time, "" for one.
    """
    for together in _by_motion(runs):
        yield _motion_heading(together[0])
        for start in range(0, len(together), ACROSS):
            beside = together[start : start + ACROSS]
            yield _mechanism_table(beside, while_others)
            yield from _computed_or_shared(beside)
            yield ""
    for table in changes_table(changes):
        yield table
        yield ""


def _details(runs: Iterable[RunRecord]) -> Iterator[str]:
    """Yield the table of every record with all its numbers as a text, then a blank line.

    Raises KeyError without records.
    """
    import pandas as pd  # noqa: PLC0415 - half a second that only a verbose command pays

    table = pd.DataFrame([record._asdict() for run in runs for record in run.every])[DETAILS]
    yield table.to_string(index=False, na_rep="", float_format="{:.4g}".format)
    yield ""


def _by_motion(runs: Iterable[RunRecord]) -> Iterator[list[RunRecord]]:
    """Yield the runs of each mechanism, variant and regime, as a list with those of the control last.

    Runs without errors are left out; those of one motion have to follow each other.
    """
    for _, part in groupby((run for run in runs if run.errors), key=lambda run: run.run[:3]):
        yield sorted(part, key=lambda run: run.errors[0].origin == CONTROL)


def _counts(changes: Sequence[Change]) -> list[str]:
    """How many results fail as changed since they were recorded, by kind, as one line; [] where none fails."""
    counts = Counter(entry.kind for entry in changes if entry.fails)
    return [f"not as recorded: {', '.join(f'{count} {kind}' for kind, count in counts.items())}"] if counts else []


def _motion_heading(run: RunRecord) -> Paragraph:
    """The heading of a table: mechanism, variant, regime and conditions."""
    return Paragraph(f"{run.mechanism} ({run.variant}), {run.regime}: {run.conditions}", colour="bold")


def _mechanism_table(runs: Sequence[RunRecord], while_others: str) -> Table:
    """The table of the runs of one mechanism and regime: families of quantities down, runs across.

    Errors are over the peak; times and steps close it. ``while_others`` notes how many ran at a time.
    """
    rows: list[Sequence[TableCell | Words]] = [
        (name, limit_words(records), *map(error_cell, records))
        for name, records in error_rows([run.every for run in runs], family).items()
    ]
    rows.append(("figures of", "", *(origin_words(run.every, run.runs) for run in runs)))
    rows.append(("seconds, set-up", while_others, *(f"{run.setup_seconds:.3f}" for run in runs)))
    rows.append(("seconds, stepping", while_others, *(f"{run.seconds:.3f}" for run in runs)))
    rows.append(("steps", "", *(f"{run.steps}" for run in runs)))
    head = ("error over peak", "limit", *(f"{run.engine}\n{run.setting}" for run in runs))
    return Table("", head, rows)


def _computed_or_shared(runs: Sequence[RunRecord]) -> list[str]:
    """Lines on the values that adapters compute themselves or share with the reference, one for each run with such."""
    names = {f"{run.engine} {run.setting}": computed_or_shared(run.every) for run in runs}
    return [f"{name}: {words}" for name, words in names.items() if words]


def _place(record: Error) -> str:
    """The mechanism of a record, which sentences on it name."""
    return record.mechanism


def _unjudged(runs: Iterable[RunRecord]) -> list[Error]:
    """The records whose reasons are told: those without an error, and those whose error is within its limit."""
    every = (record for run in runs for record in run.every)
    return [record for record in every if record.error_max is None or record.error_max <= (record.limit or -1.0)]


def _closing_line(runs: Iterable[RunRecord]) -> str:
    """The last line: how many deviations came to each verdict or were not judged, and how many samples left out."""
    counts, left_out = Counter[str](), 0
    for record in (quantity_record for run in runs for quantity_record in (*run.errors, *run.invariants)):
        counts[record.outcome] += 1
        left_out += record.left_out
    words = [f"{counts[verdict]} {verdict.value}" for verdict in Verdict if counts[verdict] and verdict.judged]
    judged = sum(count for outcome, count in counts.items() if Verdict(outcome).judged)
    unjudged = {verdict: counts[verdict] for verdict in Verdict if counts[verdict] and not verdict.judged}
    reasons = ", ".join(f"{count} {verdict.value}" for verdict, count in unjudged.items())
    words += [f"{sum(unjudged.values())} not judged ({reasons})"] if unjudged else []
    note = f"; {left_out} samples at acceleration jumps or near standstill left out" if left_out else ""
    deviations = "deviation" if judged == 1 else "deviations"
    return f"{judged} {deviations}: {', '.join(words)}{note}"
