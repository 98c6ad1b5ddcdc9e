"""The cheapest way to an error: the engine, a table over all mechanisms, one by mechanism."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby

from comparisons.judging.limits import grouped
from comparisons.work_precision.analysis import WANTED, EngineFacts, PlaceFacts, Regimes
from comparisons.work_precision.records import BenchRecord
from reports.document.numbers import ABSENT, bound, error, seconds
from reports.document.parts import Fold, Paragraph, Section, Table, TableCell
from reports.document.templates import sentence
from reports.records.views import blank_repeats
from reports.work_precision.words import judged_by, label_of, way_words

# Errors that the page begins with, by their places among those wanted.
NAMED = (0, 1, 4)


def verdicts(regimes: Regimes) -> tuple[Paragraph, ...]:
    """The cheapest engines for a few errors, in a sentence for every regime."""
    return tuple(
        Paragraph(sentence("bench_verdict", regime=name, judged=judged_by({name: places}), count=len(places),
                           wins=[(_share(WANTED[column]), _winners(places, column)) for column in NAMED]), "verdict")
        for name, places in regimes.items()
    )  # fmt: skip


def _share(error: float) -> str:
    """An error over the peak as a reader says it."""
    return f"{100.0 * error:g} %" if error >= 0.01 else bound(error)


def _winners(places: Sequence[PlaceFacts], column: int) -> list[tuple[str, str, int]]:
    """The engines that are the cheapest somewhere, their times and in how many places, those of most first."""
    best = []
    for place in places:
        engines = [facts for facts in place.engines(place.foremost) if not facts.is_control]
        records = [record for _, record in _points_reaching(engines, column)]
        best += sorted(records, key=lambda record: record.total_seconds)[:1]
    wins = grouped((record.engine, record) for record in best)
    return [(name, _time_span(won), len(won)) for name, won in sorted(wins.items(), key=lambda pair: -len(pair[1]))]


def _points_reaching(engines: Iterable[EngineFacts], column: int) -> list[tuple[EngineFacts, BenchRecord]]:
    """Every engine that reaches the error of a column, with its cheapest point that does."""
    return [(engine, record) for engine in engines if engine.choices and (record := engine.choices[column].record)]


def _time_span(records: Sequence[BenchRecord]) -> str:
    """The shortest and the longest time, set-up and stepping; one where they read alike."""
    times = [record.total_seconds for record in records]
    return " to ".join(dict.fromkeys((seconds(min(times)), seconds(max(times)))))


def section(regimes: Regimes, note: str) -> Section:
    """The section on the cheapest way to an error: all mechanisms, then each in a fold; ``note`` is in small print."""
    each = {f"{place.mechanism}, {name}": (place,) for name, places in regimes.items() for place in places}
    whole = _table(sentence("bench_use", judged=judged_by(regimes)), "Regime", regimes)
    folds = (Fold("By mechanism", (_table("Each mechanism by itself.", "Mechanism", each),)),)
    return Section(
        "use",
        "What to use for an error",
        (whole, *(folds if len(each) > len(regimes) else ()), Paragraph(note, "small")),
    )


def _table(caption: str, corner: str, groups: Mapping[str, Sequence[PlaceFacts]]) -> Table:
    """A row for every engine of a group; cells that say the same are one."""
    head = (corner, "Engine", *map(bound, WANTED))
    return Table(caption, head, tuple(blank_repeats(_rows(groups))), "l", style="choices")


def _rows(groups: Mapping[str, Sequence[PlaceFacts]]) -> Iterator[tuple[TableCell | str, ...]]:
    """A row per group and engine; equal cells side by side become one."""
    for name, places in groups.items():
        engines = grouped((label_of(facts), facts) for place in places for facts in place.engines(place.foremost))
        for label, mine in engines.items():
            cells = [(cell, len(list(same))) for cell, same in groupby(_cell(mine, n) for n in range(len(WANTED)))]
            yield name, label, *(TableCell(cell.words, cell.style, note=cell.note, span=span) for cell, span in cells)


def _cell(engines: Sequence[EngineFacts], column: int) -> TableCell:
    """The times of one engine to one error over the mechanisms, and the way that most of them take."""
    met = _points_reaching(engines, column)
    if not met:
        least = [facts.choices[column].closest.error_max or 0.0 for facts in engines if facts.choices]
        return TableCell(ABSENT, "absent", note=f"least {error(min(least))}" if least else "nothing finished")
    share = f"; in {len(met)} of {len(engines)}" if len(met) < len(engines) else ""
    taken = Counter(way_words(record) for _, record in met).most_common(1)[0][0]
    return TableCell(_time_span([record for _, record in met]), note=f"{taken}{share}")
