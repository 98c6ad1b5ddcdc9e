"""What to use for an error: the cheapest engine in a line each, a table over all mechanisms, one by mechanism."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import groupby

from comparisons.work_precision.analysis import WANTED, PointChoice
from comparisons.work_precision.records import Bench
from reports.document.numbers import ABSENT, bound, error, seconds
from reports.document.parts import Bullets, Cell, Fold, Paragraph, Part, Section, Table, Words
from reports.document.templates import plain
from reports.work_precision.facts import EngineFacts, PlaceFacts, engine_labels, failed_methods, regimes
from reports.work_precision.words import choice_words, noise_note, way_words

# Errors that the first table names a winner for.
NAMED = (WANTED[1], WANTED[4], WANTED[6])
Found = tuple[EngineFacts, PointChoice]


def section(bench: Bench) -> Section:
    """What to use for an error, by regime: over all mechanisms, then each of them in a fold."""
    parts: list[Part] = []
    for regime, places in regimes(bench).items():
        parts += _over_mechanisms(regime, places, engine_labels(bench))
        parts.append(Fold(f"Regime {regime}, by mechanism", (_by_mechanism(regime, places),)))
    return Section("use", "What to use for an error", (*parts, Paragraph(noise_note(bench), "small")))


def winners(bench: Bench) -> Table:
    """The cheapest engine for each of a few errors, a row for every regime."""
    found = regimes(bench)
    rows: list[tuple[Cell | Words, ...]] = [
        (regime, *(_winner(places, limit) for limit in NAMED)) for regime, places in found.items()
    ]
    return Table("The cheapest engine for an error of the peak:", ("Regime", *map(bound, NAMED)), tuple(rows), "l")


def _winner(places: Sequence[PlaceFacts], limit: float) -> Cell:
    """Engines by how many mechanisms they are the cheapest in; the times and way of the first."""
    best = [found for place in places if (found := _cheapest(place, WANTED.index(limit)))]
    if not best:
        return Cell("none", "absent")
    wins = Counter(facts.engine for facts, _ in best).most_common()
    mine = [found for found in best if found[0].engine == wins[0][0]]
    share = f" in {len(mine)} of {len(places)} mechanisms" if len(places) > 1 else ""
    others = "".join(f"; {name} in {count}" for name, count in wins[1:])
    note = f"{_span([_time(choice) for _, choice in mine])}, {_way(mine)}{others}"
    return Cell(f"{wins[0][0]}{share}", note=note)


def _cheapest(place: PlaceFacts, column: int) -> Found | None:
    """The engine, no control, that gets to an error in the shortest time."""
    facts = [one for one in place.engines(place.foremost) if not one.is_control and one.choices]
    met = [(one, one.choices[column]) for one in facts if one.choices[column].record]
    return min(met, key=lambda found: _time(found[1]), default=None)


def _time(choice: PointChoice) -> float:
    assert choice.record is not None
    return choice.record.seconds_min or 0.0


def _span(times: Sequence[float]) -> str:
    """The shortest and the longest of some times, s; one where they read alike."""
    return " to ".join(dict.fromkeys((seconds(min(times)), seconds(max(times)))))


def _way(found: Sequence[Found]) -> str:
    """The way that most of the mechanisms take."""
    ways = Counter(way_words(facts, choice.record) for facts, choice in found if choice.record)
    return ways.most_common(1)[0][0]


def _over_mechanisms(regime: str, places: Sequence[PlaceFacts], labels: dict[str, str]) -> Iterator[Part]:
    """One row an engine; an engine with the same to say of every error has a sentence."""
    rows: list[tuple[Cell | Words, ...]] = []
    sentences = []
    for name, label in labels.items():
        facts = [one for place in places for one in place.engines(place.foremost) if one.engine == name]
        cells = [_cell([(one, one.choices[k]) for one in facts if one.choices]) for k in range(len(WANTED))]
        spans = list(_merged(cells))
        if len(spans) > 1:
            rows.append((label, *spans))
        elif spans[0].words != ABSENT or spans[0].note:
            sentences.append(f"{label}, every error down to {bound(WANTED[-1])}: {spans[0].words}, {spans[0].note}.")
    if rows:
        yield Table(_caption(regime, places), ("Engine", *map(bound, WANTED)), tuple(rows), "l", style="choices")
    if sentences:
        yield Bullets(tuple(sentences))


def _caption(regime: str, places: Sequence[PlaceFacts]) -> str:
    names = " or ".join(dict.fromkeys(plain(place.foremost) for place in places))
    over = f" over {len(places)} mechanisms" if len(places) > 1 else ""
    return (
        f"Regime {regime}: time of the cheapest way to each error of the peak in {names}{over}, held by every finer "
        "step too; behind @ the steps a turn; x4: four runs, extrapolated."
    )


def _cell(found: Sequence[Found]) -> Cell:
    """The times of one engine to one error over the mechanisms, and the way that most of them take."""
    met = [one for one in found if one[1].record]
    if not met:
        least = [choice.closest.error_max or 0.0 for _, choice in found]
        return Cell(ABSENT, style="absent", note=f"least {error(min(least))}" if least else "")
    share = f"; in {len(met)} of {len(found)}" if len(met) < len(found) else ""
    return Cell(_span([_time(choice) for _, choice in met]), note=f"{_way(met)}{share}")


def _merged(cells: Sequence[Cell]) -> Iterator[Cell]:
    """Cells that say the same, as one over all their columns."""
    for cell, same in groupby(cells):
        yield Cell(cell.words, cell.style, note=cell.note, told=cell.told, span=len(list(same)))


def _by_mechanism(regime: str, places: Sequence[PlaceFacts]) -> Table:
    """A row for every engine of every mechanism."""
    rows: list[tuple[Cell | Words, ...]] = []
    for place in places:
        for number, facts in enumerate(place.engines(place.foremost)):
            name = place.mechanism if number == 0 else ""
            failure = Cell("; ".join(failed_methods(facts)), "failed", span=len(WANTED))
            cells = list(_merged([_choice(choice, facts) for choice in facts.choices])) or [failure]
            rows.append((name, facts.label, *cells))
    head = ("Mechanism", "Engine", *map(bound, WANTED))
    return Table(_caption(regime, places), head, tuple(rows), "l", style="choices")


def _choice(choice: PointChoice, facts: EngineFacts) -> Cell:
    """Cost and way of a choice; all that is known of it for who points at it."""
    cost, way, step, told = choice_words(choice, facts)
    return Cell(cost or ABSENT, "" if cost else "absent", note=f"{way} @ {step}" if step else way, told=told)
