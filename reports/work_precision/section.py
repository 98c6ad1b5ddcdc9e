"""What to use for which error: a table per engine and a plot per regime, for pages.

Needs no engine: a saved benchmark is read and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup
from matplotlib.figure import Figure

from comparisons.work_precision.analysis import WANTED
from comparisons.work_precision.records import Bench
from reports.drawing.style import picture
from reports.facts.views import anchor
from reports.text.numbers import bound
from reports.text.templates import render
from reports.work_precision.circumstances import note
from reports.work_precision.facts import EngineFacts, PlaceFacts, engine_names, failed_methods, places
from reports.work_precision.figure import bench_figure
from reports.work_precision.stories import LEAD, SettingStory, stories
from reports.work_precision.words import ChoiceCell, choice_cell, noise_share

TITLE = "How accurate an engine is for its cost"
ABOUT = (
    "Every engine's methods and settings over a sweep of steps, each error beside the wall time of the stepping alone. "
    "The bold lines join the points that no other point of that engine beats in both; thin lines are single methods, "
    "coarse steps to fine ones."
)


@dataclass(frozen=True)
class ChoiceRow:
    """One mechanism and regime: a cell for every error wanted; ``failure`` where nothing finished."""

    mechanism: str
    regime: str
    quantity: str
    cells: tuple[ChoiceCell, ...]
    failure: str


@dataclass(frozen=True)
class ChoiceTable:
    """What one engine is to be used with, and how its settings stand."""

    engine: str
    lead: str
    rows: tuple[ChoiceRow, ...]
    stories: tuple[SettingStory, ...]


@dataclass(frozen=True)
class Overview:
    """The plot of one regime and the sentence before it."""

    regime: str
    lead: str
    drawing: Markup


def choice_tables(bench: Bench) -> tuple[ChoiceTable, ...]:
    """One table per engine, rows in the order measured."""
    every = places(bench)
    told = stories(every, noise_share(bench))
    return tuple(
        ChoiceTable(
            name,
            f"The cheapest point of {name} {_version(bench, name)} at or below each error of the peak, held by every "
            "finer step of its sweep too.",
            tuple(
                _row(place, facts) for place in every for facts in place.engines(place.foremost) if facts.engine == name
            ),
            tuple(one for one in told if one.engine == name),
        )
        for name in engine_names(bench)
    )


def _version(bench: Bench, name: str) -> str:
    return next((record.engine_version for record in bench.records if record.engine == name), "")


def _row(place: PlaceFacts, facts: EngineFacts) -> ChoiceRow:
    cells = tuple(choice_cell(choice, facts) for choice in facts.choices)
    failure = "" if cells else "; ".join(failed_methods(facts))
    return ChoiceRow(place.mechanism, place.regime, place.foremost.replace("_", " "), cells, failure)


def regimes(bench: Bench) -> dict[str, list[PlaceFacts]]:
    """The places of each regime, in the order measured."""
    found: dict[str, list[PlaceFacts]] = {}
    for place in places(bench):
        if place.quantities:
            found.setdefault(place.regime, []).append(place)
    return found


def overview(bench: Bench, regime: str) -> Figure:
    """The plot of one regime over its mechanisms."""
    return bench_figure(regimes(bench)[regime], engine_names(bench))


def overviews(bench: Bench, only_first: bool = False) -> tuple[Overview, ...]:
    """A plot for every regime; of the first alone where the page has little room."""
    names = list(regimes(bench))[: 1 if only_first else None]
    return tuple(
        Overview(
            name,
            f"Regime {name}: largest error over the peak against the wall time of the stepping, down to each engine's "
            "floor.",
            picture(overview(bench, name), anchor("bench", name), f"error over stepping time, {name}, every engine"),
        )
        for name in names
    )


def section(bench: Bench, *, only_first: bool = False) -> Markup:
    """The section's HTML, heading, plots and tables, as a page has it."""
    return render(
        "bench_section.html",
        title=TITLE,
        about=ABOUT,
        figures=overviews(bench, only_first),
        tables=choice_tables(bench),
        wanted=[bound(error) for error in WANTED],
        lead=LEAD,
        note=note(bench),
    )
