"""The summary and the tables of a stress test, for pages and the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable

from comparisons.judging.limits import grouped
from comparisons.stress.campaign import Stress
from comparisons.stress.verdict import CellResult, StressVerdict
from reports.document.parts import Facts, Mono, Paragraph, Table, TableCell, Words
from reports.document.templates import sentence
from reports.document.terminal import Printed, Printout
from reports.records.views import blank_repeats
from reports.stress.maps import (
    NOT_JUDGED,
    SIGNS,
    WRONG_MOTIONS,
    axis_title,
    border_words,
    cell_facts,
    shown_verdicts,
    value_words,
)

LOUD = (StressVerdict.MISSED, StressVerdict.ALARM)
FAULTS = [verdict for verdict in StressVerdict if verdict not in (StressVerdict.WITHIN, *NOT_JUDGED)]
MOST_ALONE = 40  # incidents of one verdict that a table has row by row
INCIDENT = ("engine", "axis: row", "value", "usage", "reason", "command")
RANKED = "tuned"  # the setting by which engines are ranked


def summary(stress: Stress, macro: str) -> str:
    """A summary in the words of one macro: the runs, wrong motions flagged and missed, false alarms."""
    count = stress.count()
    caught, missed, alarms = (count[verdict] for verdict in (*WRONG_MOTIONS, StressVerdict.ALARM))
    extent = {"cells": len(stress.results), "axes": len(stress.axes), "quick": stress.document["quick"]}
    counts = {"wrong": caught + missed, "caught": caught, "missed": missed, "alarms": alarms}
    return sentence(macro, facts={**extent, **counts})


def ranking(stress: Stress) -> str:
    """How many cells are within limit, the best engine first, in a sentence.

    These are cells of the tuned setting where there are any, without those of the bisections, which all lie where an
    engine fails.
    """
    cells = [result for result in stress.results if result.cell.value in stress.columns[result.cell.axis]]
    tuned = [cell for cell in cells if cell.cell.usage == RANKED]
    count = Counter((result.cell.engine, result.verdict is StressVerdict.WITHIN) for result in tuned or cells
                    if result.verdict not in NOT_JUDGED)  # fmt: skip
    engines = [(name, count[name, True], count[name, True] + count[name, False]) for name in stress.engines]
    ranked = sorted((engine for engine in engines if engine[2]), key=lambda row: -row[1] / row[2])
    return sentence("stress_ranking", engines=ranked, setting=RANKED if tuned else "") if ranked else ""


def verdict_facts(stress: Stress) -> Facts:
    """How many cells came to each verdict, and its meaning; the claim is 0 for "missed"."""
    count = stress.count()
    return Facts(
        tuple(
            (f"{SIGNS[verdict].symbol} {verdict.value}", f"{count[verdict]}: {SIGNS[verdict].meaning}")
            for verdict in shown_verdicts(stress)
        )
    )


def count_table(stress: Stress, name: Callable[[str], Words], caption: str = "") -> Table:
    """A row to an axis, a column to an engine: how many cells came to what; ``name`` is how an axis is named."""
    rows: list[tuple[Words | TableCell, ...]] = [
        (name(axis), *(_compact(stress.count(engine, axis)) for engine in stress.engines)) for axis in stress.axes
    ]
    if len(stress.axes) > 1:
        rows.append(("all", *(_compact(stress.count(engine)) for engine in stress.engines)))
    return Table(caption, ("axis", *stress.engines), tuple(rows), align="l")


def _compact(count: Counter[StressVerdict]) -> TableCell:
    """``12✓ 3○ 2!``, in the colour of the worst."""
    text = " ".join(f"{count[verdict]}{SIGNS[verdict].symbol}" for verdict in StressVerdict if count[verdict])
    loud = next((SIGNS[verdict].terminal for verdict in LOUD if count[verdict]), "")
    fine = count[StressVerdict.WITHIN] and not any(count[fault] for fault in FAULTS)
    return TableCell(text, style="failed" if loud else ("pass" if fine else ""), colour=loud)


def border_table(stress: Stress, name: Callable[[str], str]) -> Table:
    """A row to a border; what it shares with the one before is left out. ``name`` is how an axis is named."""
    rows = blank_repeats(
        ((name(border.axis), *border.line[1:], TableCell(border_words(border), colour=SIGNS[border.verdict].terminal))
         for border in stress.borders), heads=4)  # fmt: skip
    return Table("", ("axis", "row", "engine", "usage", "last within, first beyond"), tuple(rows), align="l")


def incident_table(results: Iterable[CellResult]) -> Table:
    """A row per cell, with its reason and command; of many, the first of each axis and engine, with their number."""
    cell_results = sorted(results, key=lambda result: result.cell.engine)
    is_long = len(cell_results) > MOST_ALONE
    groups = grouped(
        ((result.cell.engine, result.cell.axis) if is_long else result.cell, result) for result in cell_results
    )
    rows = tuple(_incident_row(first, len(others)) for first, *others in groups.values())
    return Table("", INCIDENT, rows, align="llrl", style="incidents")


def _incident_row(result: CellResult, others: int) -> tuple[TableCell | Words, ...]:
    cell = result.cell
    place = TableCell(f"{axis_title(cell.axis)}: {cell.row}", note=f"and {others} more on this axis" if others else "")
    pair = (result.reason, Mono(result.cell.command))
    return (cell.engine, place, value_words(cell.value), cell.usage, *pair)


# The stress maps for a terminal: verdicts by engine and axis, borders, and every cell that was missed or an alarm.


def printout(stress: Stress) -> Printout:
    """Counts, borders, missed motions and false alarms, then the summary; each cell if verbose."""
    key = "  ".join(f"{SIGNS[verdict].symbol} {verdict.value}" for verdict in shown_verdicts(stress))
    parts: list[Printed] = [count_table(stress, str), Paragraph(key, colour="dim"), ""]
    parts += [border_table(stress, str), ""] if stress.borders else []
    parts += [_incident_line(result) for result in stress.of(*LOUD)]
    return Printout(
        parts,
        [f"{summary(stress, 'stress_scope')} {summary(stress, 'stress_outcome')}"],
        [*map(cell_details, stress.results), ""],
    )


def _incident_line(result: CellResult) -> Paragraph:
    cell = result.cell
    place = f"{axis_title(cell.axis)}, {cell.row}, {value_words(cell.value)}, {cell.engine} {cell.usage}"
    text = f"{result.verdict.value}: {place}: {result.reason}\n  {result.cell.command}"
    return Paragraph(text, colour=SIGNS[result.verdict].terminal)


def cell_details(result: CellResult) -> str:
    """The details of one cell, a line to a fact."""
    facts = (f"{name}: {words}" for name, words in cell_facts(result).items())
    return "\n  ".join([f"{result.cell.key}: {result.verdict.value}", *facts])
