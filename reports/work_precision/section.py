"""What to use for which error: a table per engine and a plot per regime, for pages.

Needs no engine: a saved benchmark is read and nothing else.
"""

from __future__ import annotations

from markupsafe import Markup
from matplotlib.figure import Figure

from comparisons.work_precision.analysis import WANTED
from comparisons.work_precision.records import Bench
from reports.charts.style import ReportFigure, picture
from reports.document.numbers import bound
from reports.document.tables import ReportTable
from reports.document.templates import plain, render
from reports.records.views import anchor
from reports.work_precision.facts import EngineFacts, PlaceFacts, engine_labels, failed_methods, places
from reports.work_precision.figure import bench_figure, inks
from reports.work_precision.words import choice_words, noise_note

TITLE = "How accurate an engine is for its cost"
ABOUT = (
    "Every engine's methods and settings over a sweep of steps, each error beside the wall time of the stepping alone. "
    "The bold lines join the points that no other point of that engine beats in both: solid those of a single run, "
    "dashed those of several runs extrapolated. Thin lines are single methods, coarse steps to fine ones. The "
    "reference's control is no engine: it is shown and not ranked."
)


def choice_tables(bench: Bench) -> dict[str, ReportTable]:
    """One table per engine, rows in the order measured: the point to choose for each error wanted."""
    head = ("Mechanism", "Regime", "Quantity", *map(bound, WANTED))
    return {
        label: ReportTable(
            f"The cheapest point of {name} {_version(bench, name)} at or below each error of the peak, held by every "
            "finer step of its sweep too; x4: of four runs, extrapolated.",
            head,
            tuple(
                _row(place, facts)
                for place in places(bench)
                for facts in place.engines(place.foremost)
                if facts.engine == name
            ),
            align="l",
        )
        for name, label in engine_labels(bench).items()
    }


def _version(bench: Bench, name: str) -> str:
    return next((record.engine_version for record in bench.records if record.engine == name), "")


def _row(place: PlaceFacts, facts: EngineFacts) -> tuple[str, ...]:
    cells: list[str] = [_cell(*choice_words(choice, facts)) for choice in facts.choices]
    if not cells:
        failure = Markup('<span class="failure">{}</span>').format("; ".join(failed_methods(facts)))
        cells = [failure, *[""] * (len(WANTED) - 1)]
    return (place.mechanism, place.regime, plain(place.foremost), *cells)


def _cell(cost: str, way: str, step: str, told: str) -> Markup:
    """Cost, way and step of a choice; all that is known of it where a reader points at it."""
    if not cost:
        return Markup('<span class="none" title="{}">{}</span>').format(told, way)
    turn = Markup("<br>{} a turn").format(step) if step else ""
    return Markup('<span title="{}">{}<small>{}{}</small></span>').format(told, cost, way, turn)


def regimes(bench: Bench) -> dict[str, list[PlaceFacts]]:
    """The places of each regime, in the order measured."""
    found: dict[str, list[PlaceFacts]] = {}
    for place in places(bench):
        if place.quantities:
            found.setdefault(place.regime, []).append(place)
    return found


def overview(bench: Bench, regime: str) -> Figure:
    """The plot of one regime over its mechanisms."""
    return bench_figure(regimes(bench)[regime], inks(bench))


def overviews(bench: Bench, only_first: bool = False) -> tuple[ReportFigure, ...]:
    """A plot for every regime; of the first alone where the page has little room."""
    names = list(regimes(bench))[: 1 if only_first else None]
    return tuple(
        ReportFigure(
            f"Regime {name}: largest error over the peak against the wall time of the stepping, down to each engine's "
            "floor.",
            picture(overview(bench, name), anchor("bench", name), f"error over stepping time, {name}, every engine"),
            wide=True,
        )
        for name in names
    )


def section(bench: Bench, *, only_first: bool = False) -> Markup:
    """The section's HTML, heading, plots and tables, as a page has it."""
    return render(
        "study_section.html",
        title=TITLE,
        about=ABOUT,
        figures=overviews(bench, only_first),
        choices=choice_tables(bench),
        note=noise_note(bench),
    )
