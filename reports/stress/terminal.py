"""The stress maps for a terminal: verdicts by engine and axis, borders, and every cell that was missed or an alarm."""

from __future__ import annotations

from collections import Counter

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from comparisons.stress.cells import CellResult
from comparisons.stress.verdict import StressVerdict
from reports.stress.facts import SIGNS, Stress, axis_title, shown_verdicts, value_words
from reports.stress.section import border_words, long_run_table, summary

LOUD = (StressVerdict.MISSED, StressVerdict.ALARM)


def stress_tables(stress: Stress) -> Group:
    """Counts, then borders, then what was missed or raised for nothing, then what it all comes to."""
    parts: list[RenderableType] = [_counts(stress), Text(_key(stress), style="dim"), Text("")]
    parts += [_borders(stress), Text("")] if stress.borders else []
    long_runs = long_run_table(stress)
    parts += [long_runs, Text("")] if long_runs else []
    parts += [_incident(one) for verdict in LOUD for one in stress.of(verdict)]
    return Group(*parts, Text(summary(stress)))


def _counts(stress: Stress) -> Table:
    """A line to an axis, a column to an engine: how many cells came to what."""
    table = Table("axis", *stress.engines, box=None, pad_edge=False)
    for axis in stress.axes:
        table.add_row(axis, *(_compact(stress.count(engine, axis)) for engine in stress.engines))
    if len(stress.axes) > 1:
        table.add_row("all", *(_compact(stress.count(engine)) for engine in stress.engines), style="bold")
    return table


def _compact(count: Counter[StressVerdict]) -> Text:
    """``12✓ 3○ 2!``, what was missed in red."""
    told = Text()
    for verdict in StressVerdict:
        if count[verdict]:
            told.append(f"{count[verdict]}{SIGNS[verdict].symbol} ", style=SIGNS[verdict].terminal)
    return told


def _key(stress: Stress) -> str:
    return "  ".join(f"{SIGNS[verdict].symbol} {verdict.value}" for verdict in shown_verdicts(stress))


def _borders(stress: Stress) -> Table:
    """Narrow enough for a terminal: one line to a border."""
    table = Table("axis", "row", "engine", "usage", "last within, first beyond", box=None, pad_edge=False)
    before: tuple[str, ...] = ()
    for border in stress.borders:
        place = border.line
        told = [name if place[: n + 1] != before[: n + 1] else "" for n, name in enumerate(place)]
        table.add_row(*told, border_words(border), style=SIGNS[border.verdict].terminal)
        before = place
    return table


def _incident(result: CellResult) -> Text:
    cell = result.cell
    told = f"{axis_title(cell.axis)}, {cell.row}, {value_words(cell.value)}, {cell.engine} {cell.usage}"
    return Text.assemble(
        (f"{result.verdict.value}: ", SIGNS[result.verdict].terminal),
        f"{told}: {result.judgement.reason}\n  {result.document['command']}",
    )
