"""What has moved between two folders, in tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from analytic.written import change
from comparisons.folders.difference import FolderDifference, MovedRecord, Name, RunPair
from comparisons.folders.studies import StudyDifference
from reports.document.numbers import ABSENT, figure, seconds
from reports.document.numbers import error as error_words
from reports.document.parts import Table, TableCell
from reports.document.signs import RUNS
from reports.document.terminal import Printed, Printout
from reports.records.changed_figures import changed_figures

FIGURES = "Key figures of the closed form, SI, that are not the same: recorded is the first folder's."
TIMES = "Steps and seconds of stepping, both on the same machine."
STEPS = "Steps; seconds are not compared, for the machines are not the same."


def difference_printout(difference: FolderDifference) -> Printout:
    """Tables of what has moved; the runs themselves, and what only one folder has, are details."""
    tables: list[Printed] = []
    for table in (_facts(difference), _linkages(difference), moved_table(difference), *_figures(difference)):
        if table.rows:
            tables += [table, ""]
    details: list[Printed] = [_runs(difference), ""]
    lacking = [
        *(f"only in the first folder: {words}" for words in difference.only_before),
        *(f"only in the second folder: {words}" for words in difference.only_after),
    ]
    return Printout(tables, [*lacking, closing_line(difference)], details)


def study_printout(difference: StudyDifference) -> Printout:
    """A table of what has moved in a benchmark or in stability maps; what only one folder has is a detail."""
    head = ("run", "quantity", "before", "after", "error before", "after", "")
    rows = [
        (move.run, move.quantity, *move.outcomes, *map(error_words, move.errors), "worse" if move.is_worse else "")
        for move in difference.moves
    ]
    tables = [Table(f"{difference.kind}: what is not the same.", head, rows, "lllllrl")] if rows else []
    sides = (("first", difference.only_before), ("second", difference.only_after))
    details = [f"only in the {side} folder: {key}" for side, keys in sides for key in keys]
    lacking = "".join(f"; {len(keys)} only in the {side}" for side, keys in sides if keys)
    worse = sum(move.is_worse for move in difference.moves)
    closing = (
        f"{difference.kind}: {difference.compared} runs in both folders: {len(rows)} moved; {worse} worse{lacking}"
    )
    return Printout(tables, [closing], details)


def closing_line(difference: FolderDifference) -> str:
    """How much is compared, has moved, and by more than is allowed."""
    figures = f", {len(difference.figures)} key figures" if difference.figures else ""
    moved = f"{len(difference.moves)} moved{figures}"
    return f"{difference.compared} records in both folders: {moved}; {difference.beyond} beyond limits"


def _facts(difference: FolderDifference) -> Table:
    return Table(
        "What the folders were made on, where it is not the same.", ("", "first", "second"), difference.facts, "l"
    )


def _linkages(difference: FolderDifference) -> Table:
    rows = [(_name(old), _name(new)) for old, new in difference.linkages if old != new]
    return Table("Linkages of other names or variants that are compared.", ("first", "second"), rows, "l")


def _name(name: Name) -> str:
    return f"{name[0]} ({name[1]})"


def moved_table(difference: FolderDifference) -> Table:
    """A row for every record that has moved."""
    head = ("mechanism", "regime", "engine", "quantity", "error before", "after", "factor", "peak", "")
    return Table("Errors over the peak, and peaks of the closed form over the samples.", head,
                 [tuple(_move(move)) for move in difference.moves], "llllrrrrl")  # fmt: skip


def _move(move: MovedRecord) -> Iterator[TableCell | str]:
    record = move.after
    yield from (_name(record.run[:2]), record.regime, f"{record.engine} {record.setting}", record.quantity)
    for entry in (move.before, record):
        sign = RUNS[entry.outcome]
        words = sign.word if entry.error_max is None else f"{error_words(entry.error_max)} {sign.symbol}"
        yield TableCell(words, colour=sign.colour)
    yield ABSENT if move.factor is None else figure(move.factor, 2)
    share = move.peak_share
    yield ABSENT if share is None else change(share, ".1f").replace("-", "−")
    yield "beyond" if move.beyond else ""


def _figures(difference: FolderDifference) -> Iterator[Table]:
    for table in changed_figures(difference.figures):
        yield replace(table, caption=FIGURES)


def _runs(difference: FolderDifference) -> Table:
    head = ("run", "version", "steps before", "after")
    times = ("seconds before", "after", "factor") if difference.same_machine else ()
    return Table(
        TIMES if times else STEPS, (*head, *times), [tuple(_run(run, difference)) for run in difference.runs], "llr"
    )


def _run(run: RunPair, difference: FolderDifference) -> Iterator[str]:
    old, new = run.versions
    yield from ("/".join(run.run), old if old == new else f"{old} → {new}", *map(str, run.steps))
    if difference.same_machine:
        yield from map(seconds, run.seconds)
        yield figure(run.seconds[1] / run.seconds[0], 2) if run.seconds[0] else ABSENT
