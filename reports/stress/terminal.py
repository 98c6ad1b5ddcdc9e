"""The stress maps for a terminal: verdicts by engine and axis, borders, and every cell that was missed or an alarm."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from comparisons.stress.axes import axes
from comparisons.stress.cells import CellResult, from_document
from comparisons.stress.verdict import MEANINGS, StressVerdict
from reports.stress.facts import SYMBOLS, Stress, axis_title, shown_verdicts, value_words
from reports.stress.section import border_words, long_run_table, summary
from reports.text.numbers import bound, error, seconds

LOUD: dict[StressVerdict, str] = {StressVerdict.MISSED: "bold red", StressVerdict.ALARM: "magenta"}


def stress_tables(stress: Stress) -> Group:
    """Counts, then borders, then what was missed or raised for nothing, then what it all comes to."""
    parts: list[RenderableType] = [_counts(stress), Text(_key(stress), style="dim"), Text("")]
    parts += [_borders(stress), Text("")] if stress.borders else []
    parts += _long_runs(stress)
    for verdict, style in LOUD.items():
        parts += [_incident(one, style) for one in stress.of(verdict)]
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
            told.append(f"{count[verdict]}{SYMBOLS[verdict]} ", style=LOUD.get(verdict, ""))
    return told


def _key(stress: Stress) -> str:
    return "  ".join(f"{SYMBOLS[verdict]} {verdict.value}" for verdict in shown_verdicts(stress))


def _borders(stress: Stress) -> Table:
    """Narrow enough for a terminal: one line to a border."""
    table = Table("axis", "row", "engine", "usage", "last within, first beyond", box=None, pad_edge=False)
    before: tuple[str, ...] = ()
    for border in stress.borders:
        place = border.line
        told = [name if place[: n + 1] != before[: n + 1] else "" for n, name in enumerate(place)]
        table.add_row(*told, border_words(border), style=LOUD.get(border.verdict, ""))
        before = place
    return table


def _long_runs(stress: Stress) -> list[RenderableType]:
    found = long_run_table(stress)
    if found is None:
        return []
    table = Table(*found.head, box=None, pad_edge=False)
    for number in range(found.words, len(found.head)):
        table.columns[number].justify = "right"
    for row in found.rows:
        table.add_row(*row)
    return [Text(found.lead), table, Text("")]


def _incident(result: CellResult, style: str) -> Text:
    cell = result.cell
    told = f"{axis_title(cell.axis)}, {cell.row}, {value_words(cell.value)}, {cell.engine} {cell.usage}"
    return Text.assemble(
        (f"{result.verdict.value}: ", style), f"{told}: {result.judgement.reason}\n  {result.document['command']}"
    )


def cell_lines(document: Mapping[str, Any]) -> Text:
    """All that is known of one cell, given as its document, a line to a fact."""
    result = from_document(document)
    cell, judgement = result.cell, result.judgement
    known = axes().get(cell.axis)
    told = Text.assemble(
        (f"{axis_title(cell.axis)}, {cell.row}, {cell.engine} {cell.usage}", "bold"),
        f"\n{known.label if known else 'value'} {value_words(cell.value)}: {SYMBOLS[result.verdict]} ",
        (result.verdict.value, LOUD.get(result.verdict, "bold")),
        f" ({MEANINGS[result.verdict]})",
    )
    facts = {
        "why": judgement.reason,
        "quantity": _against(judgement.quantity, judgement.deviation, judgement.deviation_limit),
        "invariant": _against(judgement.invariant, judgement.invariant_error, judgement.invariant_limit),
        "alarms": ", ".join(judgement.alarms),
        "conditions": ", ".join(f"{name} {value}" for name, value in result.conditions.items()),
        "cost": f"{seconds(result.seconds)} of stepping, {seconds(result.spent)} in all, {result.steps} steps",
    }
    told.append("".join(f"\n  {name}: {fact}" for name, fact in facts.items() if fact))
    return told


def _against(name: str, found: float | None, limit: float | None) -> str:
    return f"{name} off by {error(found)}, limit {bound(limit)}" if name else ""
