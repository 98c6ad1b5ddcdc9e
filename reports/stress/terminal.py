"""The stress maps for a terminal: verdicts by engine and axis, borders, and every cell that was missed or an alarm."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from comparisons.stress.cells import CellResult
from comparisons.stress.verdict import StressVerdict
from reports.document.numbers import bound, error, seconds
from reports.document.screen import Cell, Printout, line, table
from reports.stress.facts import SIGNS, Stress, axis_title, shown_verdicts, value_words
from reports.stress.section import border_words, summary

LOUD = (StressVerdict.MISSED, StressVerdict.ALARM)


def printout(stress: Stress) -> Printout:
    """Counts, borders, what was missed or raised for nothing, then what it all comes to; each cell if verbose."""
    parts: list[RenderableType] = [_counts(stress), line(_key(stress), "dim"), line("")]
    parts += [_borders(stress), line("")] if stress.borders else []
    parts += [_incident(result) for result in stress.of(*LOUD)]
    return Printout(parts, [line(summary(stress))], [*map(cell_details, stress.results), line("")])


def _counts(stress: Stress) -> Table:
    """A row to an axis, a column to an engine: how many cells came to what."""
    rows = [(axis, *(_compact(stress.count(engine, axis)) for engine in stress.engines)) for axis in stress.axes]
    if len(stress.axes) > 1:
        rows.append(("all", *(_compact(stress.count(engine)) for engine in stress.engines)))
    return table(("axis", *stress.engines), rows)


def _compact(count: Counter[StressVerdict]) -> Cell:
    """``12✓ 3○ 2!``, in the colour of the worst."""
    text = " ".join(f"{count[verdict]}{SIGNS[verdict].symbol}" for verdict in StressVerdict if count[verdict])
    return text, next((SIGNS[verdict].terminal for verdict in LOUD if count[verdict]), "")


def _key(stress: Stress) -> str:
    return "  ".join(f"{SIGNS[verdict].symbol} {verdict.value}" for verdict in shown_verdicts(stress))


def _borders(stress: Stress) -> Table:
    """One row to a border; what it shares with the one before is left out."""
    rows: list[Sequence[Cell]] = []
    before: tuple[str, ...] = ()
    for border in stress.borders:
        place = border.line
        names = [name if place[: n + 1] != before[: n + 1] else "" for n, name in enumerate(place)]
        rows.append((*names, (border_words(border), SIGNS[border.verdict].terminal)))
        before = place
    return table(("axis", "row", "engine", "usage", "last within, first beyond"), rows)


def _incident(result: CellResult) -> Text:
    cell = result.cell
    place = f"{axis_title(cell.axis)}, {cell.row}, {value_words(cell.value)}, {cell.engine} {cell.usage}"
    text = f"{result.verdict.value}: {place}: {result.judgement.reason}\n  {result.document['command']}"
    return line(text, SIGNS[result.verdict].terminal)


def cell_details(result: CellResult) -> Text:
    """All that is known of one cell, a line to a fact."""
    judgement = result.judgement
    facts = (
        judgement.reason,
        _against("worst deviation", judgement.quantity, judgement.deviation, judgement.deviation_limit),
        _against("worst invariant", judgement.invariant, judgement.invariant_error, judgement.invariant_limit),
        f"{result.steps} steps in {seconds(result.seconds)}; "
        f"{', '.join(f'{name} {value}' for name, value in result.conditions.items())}",
    )
    return line("\n  ".join([f"{result.cell.key}: {result.verdict.value}", *filter(None, facts)]))


def _against(kind: str, name: str, found: float | None, limit: float | None) -> str:
    return "" if found is None else f"{kind}: {name} {error(found)}, limit {bound(limit)}"
