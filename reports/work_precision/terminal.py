"""The benchmark for a terminal: what each method comes to, what to use for an error, how the settings stand."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from comparisons.work_precision.analysis import WANTED
from comparisons.work_precision.records import Bench
from reports.text.numbers import bound
from reports.work_precision.circumstances import note
from reports.work_precision.facts import PlaceFacts, failed_methods, places
from reports.work_precision.words import choice_cell, method_row, noise_share, standing_words


def bench_tables(bench: Bench, quantities: Sequence[str] = ()) -> Group:
    """A block per mechanism, regime and quantity: those asked for, else the one each place is judged by."""
    blocks: list[RenderableType] = []
    for place in places(bench):
        for name in [one for one in quantities if one in place.quantities] or [place.foremost]:
            blocks += _block(place, name, noise_share(bench))
    return Group(*blocks, Text(note(bench)))


def _block(place: PlaceFacts, quantity: str, noise: float) -> list[RenderableType]:
    words = f"{place.mechanism} ({place.variant}), {place.regime}"
    if not place.quantities:
        return [Text(f"{words}: nothing finished", style="bold"), *_failures(place, quantity)]
    title = Text(f"{words}: {quantity.replace('_', ' ')}, largest error over the peak", style="bold")
    parts: list[RenderableType] = [title, _methods(place, quantity), Text(""), _choices(place, quantity), Text("")]
    for facts in place.engines(quantity):
        for one in facts.standings:
            way = facts.way(one.rival) if one.rival else ""
            parts.append(Text(f"{facts.engine} {standing_words(one, way, noise)}"))
        parts += [Text(facts.saving.sentence)] if facts.saving else []
    return [*parts, *_failures(place, quantity), Text("")]


def _failures(place: PlaceFacts, quantity: str) -> list[Text]:
    return [
        Text(f"{facts.engine} {told}", style="yellow")
        for facts in place.engines(quantity)
        for told in failed_methods(facts)
    ]


def _methods(place: PlaceFacts, quantity: str) -> Table:
    table = Table(
        "engine", "method", "order", "least error", "steps/turn", "time", "why not less", box=None, pad_edge=False
    )
    for number in range(2, 6):
        table.columns[number].justify = "right"
    for facts in place.engines(quantity):
        for sweep in facts.methods:
            row = method_row(facts, sweep)
            table.add_row(row.engine, row.way, row.order, row.floor, row.step, row.cost, row.cause)
    return table


def _choices(place: PlaceFacts, quantity: str) -> Table:
    """What to use for an error: errors down, engines across."""
    engines = [facts for facts in place.engines(quantity) if facts.choices]
    table = Table("to get", *(facts.engine for facts in engines), box=None, pad_edge=False)
    for number, wanted in enumerate(WANTED):
        cells = [choice_cell(facts.choices[number], facts) for facts in engines]
        words = [
            f"{cell.cost}: {cell.way}{f' @ {cell.step}' if cell.step else ''}"
            if cell.reached
            else f"not reached; {cell.way}"
            for cell in cells
        ]
        table.add_row(bound(wanted), *words)
    return table
