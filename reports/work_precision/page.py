"""The benchmark's page: the cheapest engines, the diagram, what to use for an error, methods and settings, costs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from comparisons.work_precision.records import FILE, Bench
from reports.document import html
from reports.document.html import write_assets
from reports.document.numbers import seconds
from reports.document.parts import Bullets, Command, Facts, Figures, Fold, Mono, Page, Paragraph, Part, Section
from reports.document.templates import lines
from reports.records.environment import environment_facts
from reports.work_precision import choices
from reports.work_precision.costs import cost_section
from reports.work_precision.diagram import widget
from reports.work_precision.facts import failed_methods, places, regimes
from reports.work_precision.methods import method_section, setting_section
from reports.work_precision.overview import figures
from reports.work_precision.words import noise_share

FILE_NAME = "bench.html"
TITLE = "Work-precision"
READING = (
    "Thin lines: a method, coarse steps to fine ones, broken where several runs are extrapolated. Bold: an engine's "
    "front, which none of its points beats in both. Broad grey: the front over the engines shown. Marks: the settings "
    "(open circle naive, square tuned, star best). The reference's control is no engine: it is shown and not ranked."
)


def page(bench: Bench) -> Page:
    """The page of one benchmark."""
    titles = "; ".join(dict.fromkeys(place.title for place in places(bench)))
    first: tuple[Part, ...] = (Paragraph("Nothing finished: no engine has an error and a time.", "verdict"),)
    sections: tuple[Section, ...] = ()
    if regimes(bench):
        first = (
            choices.winners(bench),
            widget(bench),
            Paragraph(READING, "small"),
            Fold("The same as figures", (Figures(figures(bench)),)),
        )
        sections = (choices.section(bench), setting_section(bench), method_section(bench))
    return Page(
        FILE_NAME,
        TITLE,
        "How accurate is an engine for its cost?",
        f"Error against the closed form over the time of the stepping. {titles}.",
        first,
        (*sections, *_failures(bench), *_costs(bench), _measured(bench)),
        charts=True,
    )


def _failures(bench: Bench) -> Iterator[Section]:
    """What gave nothing: each reason once, with the places it was given in."""
    every, told = places(bench), dict[str, list[str]]()
    for place in every:
        for facts in place.engines(place.foremost):
            for reason in failed_methods(facts):
                told.setdefault(f"{facts.label}, {reason}", []).append(f"{place.mechanism} in {place.regime}")
    lines = [f"{reason} ({', '.join(met) if len(met) < len(every) else 'everywhere'})" for reason, met in told.items()]
    if lines:
        yield Section("failed", "What gave nothing", (Fold(f"Failures: {len(lines)}", (Bullets(tuple(lines)),)),))


def _costs(bench: Bench) -> Iterator[Section]:
    if bench.costs:
        yield cost_section(bench.costs)


def _measured(bench: Bench) -> Section:
    """How it was measured, in sentences, and everything that decides a figure or a time."""
    document, repeats = bench.document, sum(len(point.repeats) for point in bench.points)
    told = lines(
        "measurement",
        extent=document["extent"],
        noise=bench.noise,
        work=document["noise"]["work"],
        share=noise_share(bench),
    )
    first = ", ".join(
        f"{one['engine']} {seconds(min(one['seconds']))}" for one in document["first_use"] if one["seconds"]
    )
    facts = Facts((
        ("Conditions", document["conditions"]),
        *environment_facts(document["environment"]),
        ("Points", f"{len(bench.points)}, timed {repeats} times in all"),
        ("First use", f"{first or 'not measured'}: the first run of a process beyond the second, import included"),
        ("Records", Mono(FILE)),
    ))  # fmt: skip
    return Section("measured", "How it was measured", (
        Fold("Rounds, times, errors and orders", (Bullets(tuple(told)),)), facts, Command(document["command"]),
    ))  # fmt: skip


def write(bench: Bench, folder: Path) -> Path:
    """Write the page, what it shares with others and its figures into a folder; returns its path."""
    write_assets(folder)
    return html.write(page(bench), folder, ())
