"""What the methods of the engines are, their orders and floors, and the settings held against them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from comparisons.work_precision.records import Bench
from reports.document.numbers import ABSENT, error, seconds
from reports.document.parts import Cell, Fold, Section, Table, Words
from reports.document.templates import plain
from reports.work_precision.facts import EngineFacts, effort_words, engine_labels, regimes
from reports.work_precision.words import limit_words, noise_share, standing_words

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


def setting_section(bench: Bench) -> Section:
    """The settings against the methods of their engine."""
    table = _by_mechanism(bench, STANDING, "Setting", lambda facts: _settings(facts, noise_share(bench)))
    return Section("settings", "The settings against the methods", (table,))


def method_section(bench: Bench) -> Section:
    """Orders and floors of all methods, and what each method is."""
    folds = (
        Fold("Orders and floors", (_by_mechanism(bench, ORDERS, "Method", _sweeps),)),
        Fold("What each method is", (_what(bench),)),
    )
    return Section("methods", "The methods", folds)


def _settings(facts: EngineFacts, noise: float) -> Iterator[tuple[str, Cell]]:
    for standing, (short, told) in zip(facts.standings, standing_words(facts, noise), strict=True):
        words = f"{error(standing.record.error_max)} in {seconds(standing.record.seconds_min or 0.0)}"
        yield standing.record.setting, Cell(words, note=short, told=told.lstrip(":; "))


def _sweeps(facts: EngineFacts) -> Iterator[tuple[str, Cell]]:
    for sweep in facts.methods:
        order = "no order" if sweep.order is None else f"order {sweep.order:.1f}"
        yield facts.way(sweep.first), Cell(order, note=limit_words(sweep), told=sweep.floor.evidence)


def _by_mechanism(bench: Bench, about: str, name: str, rows_of: Rows) -> Table:
    """Engines and their rows down, mechanisms by regime across; an engine is named in its first row."""
    found: dict[str, dict[str, dict[int, Cell]]] = {}
    places = [place for part in regimes(bench).values() for place in part]
    for column, place in enumerate(places):
        for facts in place.engines(place.foremost):
            for row, cell in rows_of(facts):
                found.setdefault(facts.label, {}).setdefault(row, {})[column] = cell
    rows: list[tuple[Cell | Words, ...]] = []
    for label, cells in found.items():
        for number, (row, mine) in enumerate(cells.items()):
            filled = (mine.get(column, Cell(ABSENT, "absent")) for column in range(len(places)))
            rows.append(("" if number else label, row, *filled))
    judged = " or ".join(dict.fromkeys(plain(place.foremost) for place in places))
    groups = (("", 2), *((f"regime {regime}", len(part)) for regime, part in regimes(bench).items()))
    head = ("Engine", name, *(place.mechanism for place in places))
    return Table(f"{about} Largest error over the peak of {judged}.", head, tuple(rows), "l", groups=groups)


def _what(bench: Bench) -> Table:
    """Engine, method, what it is, of how many runs, and the solver effort it comes with."""
    labels = engine_labels(bench)
    rows = tuple(
        (labels[told["engine"]], told["name"], told["about"], f"{told['runs']}",
         effort_words(told["effort"], told["effort_unit"]))
        for told in bench.document["methods"]
    )  # fmt: skip
    return Table(WHAT, ("Engine", "Method", "What it is", "Runs", "Solver effort"), rows, "lllrl")
