"""A campaign for a terminal: errors beside their limits, and the details of every record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from types import MappingProxyType

from comparisons.campaign.campaign import RunResult
from comparisons.campaign.key_figures import KeyFigure
from comparisons.judging.records import CONTROL, Record, Verdict
from reports.document.numbers import bound, error, figure
from reports.document.parts import Paragraph, Table, TableCell, Words
from reports.document.signs import RUNS
from reports.document.terminal import Printed, Printout
from reports.records.changed_figures import changed_figures
from reports.records.environment import side_by_side
from reports.records.origins import exceptions, origin_words
from reports.records.views import family

ACROSS = 4  # runs side by side in a table of 80 columns
DETAILS = (
    *("engine", "setting", "quantity", "origin", "outcome", "error", "RMS", "limit", "baseline", "peak", "unit"),
    "worst at s",
    *("samples", "left out", "why"),
)


def printout(
    results: Sequence[RunResult],
    figures: Sequence[KeyFigure] = (),
    notes: Sequence[str] = (),
    environment: Mapping[str, str] = MappingProxyType({}),
) -> Printout:
    """One table per mechanism and regime, quantities down, engines and settings across; then key figures that changed.

    ``notes`` are sentences that always stand before the closing line. ``environment`` says how many ran at a time.
    """
    tables: list[Printed] = []
    details: list[Printed] = []
    kept = [result for result in results if result.records]
    for _, part in groupby(kept, key=lambda result: result.records[0].run[:3]):
        together = sorted(part, key=lambda result: result.records[0].origin == CONTROL)
        heading = _heading(together[0].records[0])
        tables.append(heading)
        for start in range(0, len(together), ACROSS):
            beside = together[start : start + ACROSS]
            tables += [_mechanism_table(beside, side_by_side(environment)), *_exceptions(beside), ""]
        rows = [_detail(record) for result in together for record in _all(result)]
        details += [heading, Table("", DETAILS, rows, "l"), ""]
    tables += [part for table in changed_figures(figures) for part in (table, "")]
    return Printout(tables, [*notes, *_reasons(results), *_changes(figures), _closing_line(results)], details)


def _changes(figures: Sequence[KeyFigure]) -> list[str]:
    """How many key figures are not as recorded, in a sentence."""
    known = [figure for figure in figures if figure.changed or figure.recorded is not None]
    changed = sum(figure.changed for figure in known)
    return [f"{changed} of {len(known)} key figures are not as recorded"] if changed else []


def _all(result: RunResult) -> tuple[Record, ...]:
    return (*result.records, *result.invariants)


def _heading(record: Record) -> Paragraph:
    words = f"{record.mechanism} ({record.variant}), {record.regime}: {record.conditions}"
    return Paragraph(words, colour="bold")


def _mechanism_table(results: Sequence[RunResult], while_others: str) -> Table:
    first = [result.records[0] for result in results]
    rows: list[Sequence[TableCell | Words]] = []
    for quantity in dict.fromkeys(family(record.quantity) for result in results for record in _all(result)):
        worst = [_worst(result, quantity) for result in results]
        rows.append((quantity, _limits(worst), *map(_cell, worst)))
    rows.append(("figures of", "", *(origin_words(_all(result)) for result in results)))
    rows.append(("seconds, set-up", while_others, *(f"{record.setup_seconds:.3f}" for record in first)))
    rows.append(("seconds, stepping", while_others, *(f"{record.seconds:.3f}" for record in first)))
    rows.append(("steps", "", *(f"{record.steps}" for record in first)))
    head = ("error over peak", "limit", *(f"{record.engine}\n{record.setting}" for record in first))
    return Table("", head, rows)


def _exceptions(results: Sequence[RunResult]) -> list[str]:
    """What is not the engines' own, a line for each run that has any."""
    told = {f"{r.records[0].engine} {r.records[0].setting}": exceptions(_all(r)) for r in results}
    return [f"{name}: {words}" for name, words in told.items() if words]


def _worst(result: RunResult, row: str) -> Record | None:
    """The record of a run that stands in a row; of several the one with the largest error."""
    candidates = [record for record in _all(result) if family(record.quantity) == row]
    return max(candidates, key=lambda record: record.error_max or 0.0, default=None)


def _limits(records: Sequence[Record | None]) -> str:
    limits = sorted({r.limit for r in records if r is not None and r.limit is not None}, reverse=True)
    return ", ".join(f"{limit:.0e}" if float(f"{limit:.0e}") == limit else f"{limit:.3g}" for limit in limits)


def _cell(record: Record | None) -> TableCell | str:
    if record is None:
        return ""
    sign = RUNS[record.outcome]
    words = sign.word if record.error_max is None else f"{record.error_max:.1e} {sign.symbol}"
    return TableCell(words, colour=sign.colour)


def _detail(record: Record) -> tuple[TableCell | str, ...]:
    time = "" if record.worst_time is None else f"{record.worst_time:.6g}"
    return (
        record.engine, record.setting, record.quantity, record.origin,
        TableCell(record.outcome, colour=RUNS[record.outcome].colour),
        error(record.error_max), error(record.error_rms), bound(record.limit), error(record.baseline),
        figure(record.peak), record.unit, time, f"{record.samples}", f"{record.left_out}", record.detail,
    )  # fmt: skip


def _reasons(results: Sequence[RunResult]) -> list[str]:
    """Why runs gave nothing, and which records the baseline rather than the limit caught; each once, with where."""
    reasons: dict[tuple[str, str], dict[str, None]] = {}
    for record in (record for result in results for record in _all(result)):
        within = record.error_max is not None and record.limit is not None and record.error_max <= record.limit
        if record.detail and (record.error_max is None or within):
            reasons.setdefault((f"{record.engine} {record.setting}", record.detail), {})[record.mechanism] = None
    return [f"{run}, {', '.join(where)}: {detail}" for (run, detail), where in reasons.items()]


def _closing_line(results: Sequence[RunResult]) -> str:
    records = [record for result in results for record in _all(result)]
    counts = {verdict: sum(r.outcome == verdict.value for r in records) for verdict in Verdict}
    left_out = sum(record.left_out for record in records)
    words = [f"{count} {verdict.value}" for verdict, count in counts.items() if count and verdict.judged]
    unjudged = [f"{count} {verdict.value}" for verdict, count in counts.items() if count and not verdict.judged]
    judged = sum(count for verdict, count in counts.items() if verdict.judged)
    words += [f"{len(records) - judged} not judged ({', '.join(unjudged)})"] if unjudged else []
    note = f"; {left_out} samples at acceleration jumps or near standstill left out" if left_out else ""
    deviations = "deviation" if judged == 1 else "deviations"
    return f"{judged} {deviations}: {', '.join(words)}{note}"
