"""The settings compared with the methods of their engine, and the methods' orders and floors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from comparisons.work_precision.places import EngineFacts, Regimes
from reports.document.numbers import ABSENT, error, seconds
from reports.document.parts import Fold, Section, Table, TableCell
from reports.document.templates import sentence
from reports.records.views import once
from reports.work_precision.words import comparison_words, judged_by, label_of, limit_words, way

# Of one engine in one place: a row's head and its cell there.
Rows = Callable[[EngineFacts], Iterator[tuple[TableCell, TableCell]]]


def method_section(regimes: Regimes, methods: Sequence[Mapping[str, Any]], noise: float) -> Section:
    """Settings, orders and floors; times closer than the share ``noise`` are the same.

    ``methods`` are what the benchmark's document says of each.
    """
    about = {(method["engine"], method["name"]): method["about"] for method in methods}

    def settings(facts: EngineFacts) -> Iterator[tuple[TableCell, TableCell]]:
        for setting_comparison in facts.setting_comparisons:
            comparison = comparison_words(setting_comparison, facts, noise).lstrip(":; ") if facts.sweeps else ""
            words = (
                f"{error(setting_comparison.record.error_max)} in {seconds(setting_comparison.record.total_seconds)}"
            )
            yield (
                TableCell(setting_comparison.record.setting),
                TableCell(words.replace(" ", "\u00a0"), note=comparison.partition(":")[0], tooltip=comparison),
            )

    def sweeps(facts: EngineFacts) -> Iterator[tuple[TableCell, TableCell]]:
        for method in facts.methods:
            order = "no order" if method.order is None else f"order {method.order:.1f}"
            row = TableCell(way(facts, method.first), note=about[facts.engine, method.first.setting])
            yield row, TableCell(order, note=limit_words(method), tooltip=method.floor.evidence)

    orders = _by_mechanism(regimes, "bench_orders", "Method", sweeps)
    folds = (Fold("The methods: orders and floors", (orders,)),) if orders.rows else ()
    name = "bench_standings" if folds else "bench_settings"
    table = _by_mechanism(regimes, name, "Setting", settings)
    heading = "The settings against the methods" if folds else "The settings"
    return Section("settings", heading, (table, *folds))


def _by_mechanism(regimes: Regimes, about: str, name: str, rows_of: Rows) -> Table:
    """Engines and their rows down, mechanisms by regime across; an engine is named in its first row."""
    places = [place for part in regimes.values() for place in part]
    table: dict[str, dict[TableCell, dict[int, TableCell]]] = {}
    for column, place in enumerate(places):
        for facts in place.engines(place.foremost):
            for row, cell in rows_of(facts):
                table.setdefault(label_of(facts), {}).setdefault(row, {})[column] = cell
    none = TableCell(ABSENT, "absent")
    rows = once(
        (label, row, *(mine.get(column, none) for column in range(len(places))))
        for label, cells in table.items()
        for row, mine in cells.items()
    )
    groups = (("", 2), *((f"regime {regime}", len(part)) for regime, part in regimes.items()))
    head = ("Engine", name, *(place.mechanism for place in places))
    return Table(sentence(about, judged=judged_by(regimes)), head, tuple(rows), "l", groups=groups)
