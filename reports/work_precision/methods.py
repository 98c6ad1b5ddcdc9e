"""What the methods of the engines are, their orders and floors, and the settings held against them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from comparisons.work_precision.places import EngineFacts, Regimes
from reports.document.numbers import ABSENT, error, seconds
from reports.document.parts import Cell, Fold, Section, Table, Words
from reports.work_precision.words import effort_words, judged_by, label_of, limit_words, standing_words, way

# Of one engine in one place: a row's name and its cell there.
Rows = Callable[[EngineFacts], Iterator[tuple[str, Cell]]]
WHAT = (
    "What an engine offers for study, each taking the step it is asked for; several runs, at fractions of that step, "
    "are extrapolated. The steps per turn of a setting are fixed numbers in the adapter."
)
STANDING = (
    "Error and time of every setting, and its time over that of the cheapest method at the same error: best is held "
    "against all methods, the others against those of a single run."
)
ORDERS = (
    "Observed order and least error of every method at its own solver effort; it is a floor where a finer step does "
    "not lower it."
)


def setting_section(regimes: Regimes, noise: float) -> Section:
    """The settings against the methods of their engine; times closer than the share ``noise`` are the same."""
    table = _by_mechanism(regimes, STANDING, "Setting", lambda facts: _settings(facts, noise))
    return Section("settings", "The settings against the methods", (table,))


def method_section(regimes: Regimes, methods: Sequence[Mapping[str, Any]]) -> Section:
    """Orders and floors of all methods, and what the benchmark's document says of each."""
    rows = tuple(
        (told["engine"], told["name"], told["about"], f"{told['runs']}",
         effort_words(told["effort"], told["effort_unit"]))
        for told in methods
    )  # fmt: skip
    what = Table(WHAT, ("Engine", "Method", "What it is", "Runs", "Solver effort"), rows, "lllrl")
    orders = _by_mechanism(regimes, ORDERS, "Method", _sweeps)
    folds = {"Orders and floors": orders, "What each method is": what}
    parts = tuple(Fold(name, (table,)) for name, table in folds.items() if table.rows)
    return Section("methods", "The methods", parts)


def _settings(facts: EngineFacts, noise: float) -> Iterator[tuple[str, Cell]]:
    for standing in facts.standings:
        short, told = standing_words(standing, facts, noise)
        words = f"{error(standing.record.error_max)} in {seconds(standing.record.seconds_min or 0.0)}"
        yield standing.record.setting, Cell(words, note=short, told=told.lstrip(":; "))


def _sweeps(facts: EngineFacts) -> Iterator[tuple[str, Cell]]:
    for sweep in facts.methods:
        order = "no order" if sweep.order is None else f"order {sweep.order:.1f}"
        yield way(facts, sweep.first), Cell(order, note=limit_words(sweep), told=sweep.floor.evidence)


def _by_mechanism(regimes: Regimes, about: str, name: str, rows_of: Rows) -> Table:
    """Engines and their rows down, mechanisms by regime across; an engine is named in its first row."""
    found: dict[str, dict[str, dict[int, Cell]]] = {}
    places = [place for part in regimes.values() for place in part]
    for column, place in enumerate(places):
        for facts in place.engines(place.foremost):
            for row, cell in rows_of(facts):
                found.setdefault(label_of(facts), {}).setdefault(row, {})[column] = cell
    rows: list[tuple[Cell | Words, ...]] = []
    for label, cells in found.items():
        for number, (row, mine) in enumerate(cells.items()):
            filled = (mine.get(column, Cell(ABSENT, "absent")) for column in range(len(places)))
            rows.append(("" if number else label, row, *filled))
    groups = (("", 2), *((f"regime {regime}", len(part)) for regime, part in regimes.items()))
    head = ("Engine", name, *(place.mechanism for place in places))
    return Table(f"{about} Largest error over the peak of {judged_by(regimes)}.", head, tuple(rows), "l", groups=groups)
