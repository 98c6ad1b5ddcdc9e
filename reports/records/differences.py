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


def difference_printout(found: FolderDifference) -> Printout:
    """Tables of what has moved; the runs themselves, and what only one folder has, are details."""
    tables: list[Printed] = []
    for table in (_facts(found), _linkages(found), moved_table(found), *_figures(found)):
        if table.rows:
            tables += [table, ""]
    details: list[Printed] = [_runs(found), ""]
    lacking = [
        *(f"only in the first folder: {words}" for words in found.only_before),
        *(f"only in the second folder: {words}" for words in found.only_after),
    ]
    return Printout(tables, [*lacking, closing_line(found)], details)


def study_printout(found: StudyDifference) -> Printout:
    """A table of what has moved in a benchmark or in stability maps; what only one folder has is a detail."""
    head = ("run", "quantity", "before", "after", "error before", "after", "")
    rows = [
        (move.run, move.quantity, *move.outcomes, *map(error_words, move.errors), "worse" if move.is_worse else "")
        for move in found.moves
    ]
    tables = [Table(f"{found.kind}: what is not the same.", head, rows, "lllllrl")] if rows else []
    sides = (("first", found.only_before), ("second", found.only_after))
    details = [f"only in the {side} folder: {key}" for side, keys in sides for key in keys]
    lacking = "".join(f"; {len(keys)} only in the {side}" for side, keys in sides if keys)
    worse = sum(move.is_worse for move in found.moves)
    closing = f"{found.kind}: {found.compared} runs in both folders: {len(rows)} moved; {worse} worse{lacking}"
    return Printout(tables, [closing], details)


def closing_line(found: FolderDifference) -> str:
    """How much is compared, has moved, and by more than is allowed."""
    figures = f", {len(found.figures)} key figures" if found.figures else ""
    return f"{found.compared} records in both folders: {len(found.moves)} moved{figures}; {found.beyond} beyond limits"


def _facts(found: FolderDifference) -> Table:
    return Table("What the folders were made on, where it is not the same.", ("", "first", "second"), found.facts, "l")


def _linkages(found: FolderDifference) -> Table:
    rows = [(_name(old), _name(new)) for old, new in found.linkages if old != new]
    return Table("Linkages of other names or variants that are compared.", ("first", "second"), rows, "l")


def _name(name: Name) -> str:
    return f"{name[0]} ({name[1]})"


def moved_table(found: FolderDifference) -> Table:
    """A row for every record that has moved."""
    head = ("mechanism", "regime", "engine", "quantity", "error before", "after", "factor", "peak", "")
    return Table("Errors over the peak, and peaks of the closed form over the samples.", head,
                 [tuple(_move(move)) for move in found.moves], "llllrrrrl")  # fmt: skip


def _move(move: MovedRecord) -> Iterator[TableCell | str]:
    record = move.after
    yield from (_name(record.run[:2]), record.regime, f"{record.engine} {record.setting}", record.quantity)
    for one in (move.before, record):
        sign = RUNS[one.outcome]
        words = sign.word if one.error_max is None else f"{error_words(one.error_max)} {sign.symbol}"
        yield TableCell(words, colour=sign.colour)
    yield ABSENT if move.factor is None else figure(move.factor, 2)
    share = move.peak_share
    yield ABSENT if share is None else change(share, ".1f").replace("-", "−")
    yield "beyond" if move.beyond else ""


def _figures(found: FolderDifference) -> Iterator[Table]:
    for table in changed_figures(found.figures):
        yield replace(table, caption=FIGURES)


def _runs(found: FolderDifference) -> Table:
    head = ("run", "version", "steps before", "after")
    times = ("seconds before", "after", "factor") if found.same_machine else ()
    return Table(TIMES if times else STEPS, (*head, *times), [tuple(_run(run, found)) for run in found.runs], "llr")


def _run(run: RunPair, found: FolderDifference) -> Iterator[str]:
    old, new = run.versions
    yield from ("/".join(run.run), old if old == new else f"{old} → {new}", *map(str, run.steps))
    if found.same_machine:
        yield from map(seconds, run.seconds)
        yield figure(run.seconds[1] / run.seconds[0], 2) if run.seconds[0] else ABSENT
