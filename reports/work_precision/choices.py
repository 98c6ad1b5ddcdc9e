"""What to use for an error: the cheapest engine, a table over all mechanisms, one by mechanism."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

from comparisons.work_precision.analysis import WANTED, PointChoice
from comparisons.work_precision.places import EngineFacts, PlaceFacts, Regimes
from reports.document.numbers import ABSENT, bound, error, seconds
from reports.document.parts import Cell, Fold, Paragraph, Section, Table, Words
from reports.work_precision.words import choice_words, failed_methods, judged_by, label_of, way_words

# Errors that the first table names a winner for, by their places among those wanted.
NAMED = (1, 4, 6)
Found = tuple[EngineFacts, PointChoice]


def section(regimes: Regimes, note: str) -> Section:
    """What to use for an error: over all mechanisms, then each of them in a fold; ``note`` is in small print."""
    about = (
        f"Time of an engine's cheapest way to each error of the peak in {judged_by(regimes)}, over all mechanisms; a "
        "point counts if every finer step holds the error too. Behind @ stand the steps a turn; x4: four runs, "
        "extrapolated."
    )
    each = _table("Each mechanism by itself.", "Mechanism", _by_mechanism(regimes))
    whole = _table(about, "Regime", _over_mechanisms(regimes))
    folds = (Fold("By mechanism", (each,)),) if len(each.rows) > len(whole.rows) else ()
    return Section("use", "What to use for an error", (whole, *folds, Paragraph(note, "small")))


def winners(regimes: Regimes) -> Table:
    """The cheapest engine for each of a few errors, a row for every regime."""
    rows: list[tuple[Cell | Words, ...]] = [
        (name, *(_winner(places, column) for column in NAMED)) for name, places in regimes.items()
    ]
    head = ("Regime", *(bound(WANTED[column]) for column in NAMED))
    return Table(f"The cheapest engine for an error of the peak in {judged_by(regimes)}:", head, tuple(rows), "l")


def _winner(places: Sequence[PlaceFacts], column: int) -> Cell:
    """The engines that are the cheapest somewhere, those of most mechanisms first."""
    wins: dict[str, list[Found]] = {}
    for place in places:
        if met := _met(((one, one.choices) for one in place.engines(place.foremost) if not one.is_control), column):
            best = min(met, key=_time)
            wins.setdefault(best[0].engine, []).append(best)
    order = sorted(wins.items(), key=lambda pair: -len(pair[1]))
    notes = []
    for name, won in order:
        share = f", in {len(won)} of {len(places)}" if len(places) > 1 else ""
        notes.append(f"{f'{name}: ' if len(order) > 1 else ''}{_span(won)}, {_way(won)}{share}")
    return Cell(" or ".join(dict(order)) or "none", "" if wins else "absent", note="; ".join(notes))


def _met(engines: Iterable[tuple[EngineFacts, Sequence[PointChoice]]], column: int) -> list[Found]:
    """The choices of those that get to an error."""
    return [(facts, choices[column]) for facts, choices in engines if choices and choices[column].record]


def _time(found: Found) -> float:
    """Stepping time of a choice that gets there, s."""
    return (found[1].record and found[1].record.seconds_min) or 0.0


def _span(found: Sequence[Found]) -> str:
    """The shortest and the longest time; one where they read alike."""
    times = [_time(one) for one in found]
    return " to ".join(dict.fromkeys((seconds(min(times)), seconds(max(times)))))


def _way(found: Sequence[Found]) -> str:
    """The way that most of the mechanisms take."""
    return Counter(way_words(facts, choice.record or choice.closest) for facts, choice in found).most_common(1)[0][0]


def _over_mechanisms(regimes: Regimes) -> Iterator[tuple[str, str, list[Cell]]]:
    for name, places in regimes.items():
        engines: dict[str, list[EngineFacts]] = {}
        for facts in (one for place in places for one in place.engines(place.foremost)):
            engines.setdefault(label_of(facts), []).append(facts)
        for label, mine in engines.items():
            yield name, label, [_cell(mine, column) for column in range(len(WANTED))]


def _cell(engines: Sequence[EngineFacts], column: int) -> Cell:
    """The times of one engine to one error over the mechanisms, and the way that most of them take."""
    met = _met(((facts, facts.choices) for facts in engines), column)
    if not met:
        least = [facts.choices[column].closest.error_max or 0.0 for facts in engines if facts.choices]
        return Cell(ABSENT, "absent", note=f"least {error(min(least))}" if least else "nothing finished")
    share = f"; in {len(met)} of {len(engines)}" if len(met) < len(engines) else ""
    return Cell(_span(met), note=f"{_way(met)}{share}")


def _by_mechanism(regimes: Regimes) -> Iterator[tuple[str, str, list[Cell]]]:
    for place in (one for places in regimes.values() for one in places):
        for facts in place.engines(place.foremost):
            failure = Cell("; ".join(failed_methods(facts)), "failed")
            cells = [_choice(choice, facts) for choice in facts.choices] or [failure] * len(WANTED)
            yield f"{place.mechanism}, {place.regime}", label_of(facts), cells


def _choice(choice: PointChoice, facts: EngineFacts) -> Cell:
    """Cost and way of a choice; all that is known of it for who points at it."""
    cost, taken, told = choice_words(choice, facts)
    return Cell(cost or ABSENT, "" if cost else "absent", note=taken, told=told)


def _table(caption: str, corner: str, rows: Iterable[tuple[str, str, list[Cell]]]) -> Table:
    """A row for every engine of a group, which its first row names; cells that say the same are one."""
    filled: list[tuple[Cell | Words, ...]] = []
    for group, mine in groupby(rows, key=lambda row: row[0]):
        for number, (_, label, cells) in enumerate(mine):
            spans = [(cell, len(list(same))) for cell, same in groupby(cells)]
            merged = (Cell(cell.words, cell.style, note=cell.note, told=cell.told, span=span) for cell, span in spans)
            filled.append(("" if number else group, label, *merged))
    return Table(caption, (corner, "Engine", *map(bound, WANTED)), tuple(filled), "l", style="choices")
