"""Differences in tables: between two folders, in a folder judged anew, and of key figures from their record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from analytic.written import change
from comparisons.campaign.key_figures import KeyFigure
from comparisons.folders.difference import FolderDifference, MovedRecord, Name, RunPair
from comparisons.folders.studies import StudyDifference
from comparisons.folders.verification import Verification
from reports.document.numbers import ABSENT, figure, seconds
from reports.document.numbers import error as error_words
from reports.document.parts import RUNS, Table, TableCell
from reports.document.terminal import Printed, Printout

CHANGED = "Key figures of the closed form, SI, that are not as recorded in the baseline."
CHANGED_HEAD = ("mechanism", "regime", "figure", "recorded", "now", "unit", "change")
FIGURES = "Key figures of the closed form, SI, that are not the same: recorded is the first folder's."
TIMES = "Steps and seconds of stepping, both on the same machine."
STEPS = "Steps; seconds are not compared, for the machines are not the same."


def difference_printout(difference: FolderDifference) -> Printout:
    """Tables of the differences; the runs themselves are details."""
    tables: list[Printed] = []
    figures = changed_figures(difference.figures, FIGURES)
    for table in (_facts_table(difference), _linkages_table(difference), moved_table(difference), *figures):
        if table.rows:
            tables += [table, ""]
    details: list[Printed] = [_runs_table(difference), ""]
    lacking = [
        *(f"only in the first folder: {words}" for words in difference.only_before),
        *(f"only in the second folder: {words}" for words in difference.only_after),
    ]
    return Printout(tables, [*lacking, closing_line(difference)], details)


def study_printout(difference: StudyDifference) -> Printout:
    """A table of the differences of two benchmarks or stability maps; runs of one folder alone are details."""
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
    return f"{difference.compared} records in both folders: {moved}; {difference.beyond_count} beyond limits"


def _facts_table(difference: FolderDifference) -> Table:
    return Table(
        "What the folders were made on, where it is not the same.", ("", "first", "second"), difference.facts, "l"
    )


def _linkages_table(difference: FolderDifference) -> Table:
    rows = [(_linkage_name_text(old), _linkage_name_text(new)) for old, new in difference.linkages if old != new]
    return Table("Linkages of other names or variants that are compared.", ("first", "second"), rows, "l")


def _linkage_name_text(name: Name) -> str:
    return f"{name[0]} ({name[1]})"


def moved_table(difference: FolderDifference) -> Table:
    """A row for every record whose outcome, error or peak is not the same in both folders."""
    head = ("mechanism", "regime", "engine", "quantity", "error before", "after", "factor", "peak", "")
    return Table("Errors over the peak, and peaks of the closed form over the samples.", head,
                 [tuple(_moved_cells(move)) for move in difference.moves], "llllrrrrl")  # fmt: skip


def _moved_cells(move: MovedRecord) -> Iterator[TableCell | str]:
    """The cells of a record that has moved: its run, both errors, their factor, the change of the peak."""
    record = move.after
    yield from (_linkage_name_text(record.run[:2]), record.regime, f"{record.engine} {record.setting}", record.quantity)
    for entry in (move.before, record):
        sign = RUNS[entry.outcome]
        words = sign.word if entry.error_max is None else f"{error_words(entry.error_max)} {sign.symbol}"
        yield TableCell(words, colour=sign.colour)
    yield ABSENT if move.factor is None else figure(move.factor, 2)
    share = move.peak_share
    yield ABSENT if share is None else change(share, ".1f").replace("-", "−")
    yield "beyond" if move.is_beyond else ""


def _runs_table(difference: FolderDifference) -> Table:
    head = ("run", "version", "steps before", "after")
    times = ("seconds before", "after", "factor") if difference.same_machine else ()
    return Table(
        TIMES if times else STEPS,
        (*head, *times),
        [tuple(_run_cells(run, difference)) for run in difference.runs],
        "llr",
    )


def _run_cells(run: RunPair, difference: FolderDifference) -> Iterator[str]:
    """The cells of a run: versions and steps, and the seconds, s, if both are of one machine."""
    old, new = run.versions
    yield from ("/".join(run.run), old if old == new else f"{old} → {new}", *map(str, run.steps))
    if difference.same_machine:
        yield from map(seconds, run.seconds)
        yield figure(run.seconds[1] / run.seconds[0], 2) if run.seconds[0] else ABSENT


def changed_figures(figures: Sequence[KeyFigure], caption: str = CHANGED) -> tuple[Table, ...]:
    """A table with a row for every key figure that has changed; no table without changes."""
    rows = tuple(_changed_row(figure) for figure in figures if figure.changed)
    return (Table(caption, CHANGED_HEAD, rows, align="lllrrlr"),) if rows else ()


def _changed_row(figure: KeyFigure) -> tuple[str, ...]:
    """The row of a changed key figure: its place, both values, unit and relative change."""
    place = f"{figure.mechanism} ({figure.variant})"
    share = ABSENT if figure.share is None else change(figure.share, ".2g")
    recorded, now = (ABSENT if value is None else f"{value:.9g}" for value in (figure.recorded, figure.now))
    return (place, figure.regime, figure.figure, recorded, now, figure.unit, share)


def verification_printout(verification: Verification) -> Printout:
    """A row for every finding, and how much was judged anew."""
    rows = [(finding.place, finding.sentence) for finding in verification.findings]
    table: list[Printed] = [Table("What differs.", ("where", "what"), rows, "l"), ""] if rows else []
    return Printout(table, [*verification.notes, verification_line(verification)])


def verification_line(verification: Verification) -> str:
    """The counts of curves, key figures and records judged anew, and of findings."""
    counts = Counter(record.outcome for record in (*verification.records, *verification.invariants))
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    texts = f"checksums {verification.texts}"
    again = f"computed again: curves {verification.curves}, key figures {verification.figures}, {texts}"
    campaign = (again, f"{counts.total()} records: {outcomes}") if counts else ()
    differs = "nothing differs" if not verification.findings else f"differing: {len(verification.findings)}"
    return "; ".join((*campaign, *verification.studies, differs))
