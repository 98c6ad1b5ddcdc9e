"""The stress maps for a terminal: verdicts by engine and axis, borders, and every cell that was missed or an alarm."""

from __future__ import annotations

from comparisons.stress.cell_result import CellResult
from comparisons.stress.saved import Stress
from reports.document.parts import Paragraph
from reports.document.terminal import Printed, Printout
from reports.stress.facts import SIGNS, axis_title, shown_verdicts, value_words
from reports.stress.maps import story
from reports.stress.tables import LOUD, border_table, count_table, summary


def printout(stress: Stress) -> Printout:
    """Counts, borders, missed motions and false alarms, then the summary; each cell if verbose."""
    key = "  ".join(f"{SIGNS[verdict].symbol} {verdict.value}" for verdict in shown_verdicts(stress))
    parts: list[Printed] = [count_table(stress, str), Paragraph(key, colour="dim"), ""]
    parts += [border_table(stress, str), ""] if stress.borders else []
    parts += [_incident(result) for result in stress.of(*LOUD)]
    return Printout(
        parts,
        [f"{summary(stress, 'stress_scope')} {summary(stress, 'stress_outcome')}"],
        [*map(cell_details, stress.results), ""],
    )


def _incident(result: CellResult) -> Paragraph:
    cell = result.cell
    place = f"{axis_title(cell.axis)}, {cell.row}, {value_words(cell.value)}, {cell.engine} {cell.usage}"
    text = f"{result.verdict.value}: {place}: {result.reason}\n  {result.cell.command}"
    return Paragraph(text, colour=SIGNS[result.verdict].terminal)


def cell_details(result: CellResult) -> str:
    """The details of one cell, a line to a fact."""
    facts = (f"{name}: {words}" for name, words in story(result).items())
    return "\n  ".join([f"{result.cell.key}: {result.verdict.value}", *facts])
