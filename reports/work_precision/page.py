"""The benchmark as one page: opens offline beside its script, and needs no engine."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from comparisons.runs.files import write_text
from comparisons.work_precision.measure import JOINTS
from comparisons.work_precision.records import FILE, Bench
from reports.facts.views import anchor
from reports.text.tables import ReportTable
from reports.text.templates import render
from reports.work_precision.circumstances import facts, measured
from reports.work_precision.facts import PlaceFacts, engine_names, failed_methods, places
from reports.work_precision.figure import save_figure
from reports.work_precision.interactive import SCRIPT, bench_html, script
from reports.work_precision.section import overview, regimes, section
from reports.work_precision.words import floor_table, method_table, noise_share, standing_words

PAGE = "bench.html"


@dataclass(frozen=True)
class QuantityPart:
    """One quantity of one mechanism and regime."""

    name: str
    table: ReportTable
    standings: tuple[str, ...]


@dataclass(frozen=True)
class PlacePart:
    """One mechanism and regime on the page."""

    key: str
    title: str
    mechanism: str
    variant: str
    regime: str
    interactive: Markup
    quantities: tuple[QuantityPart, ...]
    failures: tuple[str, ...]


def write(bench: Bench, folder: Path) -> Path:
    """Write the page, the script it needs and the static plots into a folder; returns the page's path."""
    write_text(folder / SCRIPT, script())
    for regime in regimes(bench):
        save_figure(overview(bench, regime), folder / anchor("bench", regime))
    write_text(folder / PAGE, page(bench))
    return folder / PAGE


def page(bench: Bench) -> str:
    """The page's HTML."""
    every = places(bench)
    return render(
        "bench.html",
        script=SCRIPT,
        titles=list(dict.fromkeys(place.title for place in every)),
        facts=facts(bench),
        section=section(bench),
        places=[_place(bench, place) for place in every],
        methods=method_table(bench),
        measured=measured(bench),
        command=bench.document["command"],
        file=FILE,
    )


def _place(bench: Bench, place: PlaceFacts) -> PlacePart:
    key = anchor("bench", place.mechanism, place.variant, place.regime)
    names = place.quantities
    interactive = bench_html(place, engine_names(bench), f"{key}-plot") if names else ""
    ordered = sorted(names, key=lambda name: name != place.foremost)
    return PlacePart(
        key=key,
        title=place.title,
        mechanism=place.mechanism,
        variant=place.variant,
        regime=place.regime,
        interactive=Markup(interactive),
        quantities=tuple(_quantity(place, name, noise_share(bench)) for name in ordered),
        failures=tuple(
            f"{facts.engine}: {told}" for facts in place.engines(place.foremost) for told in failed_methods(facts)
        ),
    )


def _quantity(place: PlaceFacts, name: str, noise: float) -> QuantityPart:
    engines = place.engines(name)
    found = next((r.error for r in place.records if r.quantity == name and r.error), None)
    over = f" ({found.peak:.4g} {found.unit})" if found and found.peak else ""
    worst = "; of joint forces the worst joint's" if name == JOINTS else ""
    return QuantityPart(
        name=name.replace("_", " "),
        table=floor_table(engines, f"Largest error over the closed form's peak{over}{worst}."),
        standings=tuple(
            f"{facts.engine} {standing_words(one, facts.way(one.rival) if one.rival else '', noise)}"
            for facts in engines
            for one in facts.standings
        ),
    )
