"""The benchmark's page: the cheapest engines, the diagram, what to use for an error, methods and settings, costs."""

from __future__ import annotations

from collections.abc import Sequence

from comparisons.work_precision.places import PlaceFacts, by_regime, places
from comparisons.work_precision.records import FILE, Bench
from reports.document.numbers import seconds
from reports.document.parts import Bullets, Command, Facts, Figures, Fold, Mono, Page, Paragraph, Part, Section
from reports.document.templates import lines
from reports.records.environment import environment_facts
from reports.work_precision import choices
from reports.work_precision.costs import cost_section
from reports.work_precision.diagram import widget
from reports.work_precision.methods import method_section, setting_section
from reports.work_precision.overview import figures, inks
from reports.work_precision.words import engine_labels, failed_methods, label_of, noise_note, noise_share

FILE_NAME = "bench.html"
TITLE = "Work-precision"
READING = (
    "Thin lines: a method, coarse steps to fine ones, broken where several runs are extrapolated. Bold: an engine's "
    "front at any solver effort, which none of its points beats in both. Broad grey: the front over the engines shown. "
    "Marks: the settings (open circle naive, square tuned, star best). The reference's control is no engine: it is "
    "shown and not ranked."
)


def page(bench: Bench) -> Page:
    """The page of one benchmark."""
    every, labels = places(bench), engine_labels(bench)
    titles = "; ".join(dict.fromkeys(place.title for place in every))
    first: tuple[Part, ...] = (Paragraph("Nothing finished: no engine has an error and a time.", "verdict"),)
    sections: list[Section] = []
    if found := by_regime(every):
        as_figures = Fold("The same as figures", (Figures(figures(found, inks(labels))),))
        first = (choices.winners(found), widget(found, labels), Paragraph(READING, "small"), as_figures)
        sections += [choices.section(found, noise_note(bench)), setting_section(found, noise_share(bench))]
    if bench.document["methods"]:
        sections.append(method_section(found, bench.document["methods"]))
    if failures := _failures(every):
        sections.append(
            Section("failed", "What gave nothing", (Fold(f"Failures: {len(failures)}", (Bullets(failures),)),))
        )
    if bench.costs:
        sections.append(cost_section(bench.costs))
    about = f"Error against the closed form over the time of the stepping. {titles}."
    heading = "How accurate is an engine for its cost?"
    return Page(FILE_NAME, TITLE, heading, about, first, (*sections, _measured(bench)), charts=bool(found))


def _failures(every: Sequence[PlaceFacts]) -> tuple[str, ...]:
    """What gave nothing: each reason once, with the places it was given in."""
    told: dict[str, list[str]] = {}
    for place in every:
        for facts in place.engines(place.foremost):
            for reason in failed_methods(facts):
                told.setdefault(f"{label_of(facts)}, {reason}", []).append(f"{place.mechanism} in {place.regime}")
    where = {reason: ", ".join(met) if len(met) < len(every) else "everywhere" for reason, met in told.items()}
    return tuple(f"{reason} ({place})" for reason, place in where.items())


def _measured(bench: Bench) -> Section:
    """How it was measured, in sentences, and everything that decides a figure or a time."""
    document, repeats = bench.document, sum(len(point.repeats) for point in bench.points)
    work, share = document["noise"]["work"], noise_share(bench)
    told = lines("measurement", extent=document["extent"], noise=bench.noise, work=work, share=share)
    known = {one["engine"]: one["seconds"] for one in document["first_use"] if one["seconds"]}
    first = ", ".join(f"{name} {seconds(min(times))}" for name, times in known.items())
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
