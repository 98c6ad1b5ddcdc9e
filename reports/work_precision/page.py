"""The benchmark's page: the cheapest engines, the diagram, what to use for an error, settings and methods, costs."""

from __future__ import annotations

from collections.abc import Sequence

from comparisons.judging.verdicts import grouped
from comparisons.runs.record_file import RECORDS
from comparisons.work_precision.places import PlaceFacts, by_regime, places
from comparisons.work_precision.records import KIND, Bench
from reports.document.numbers import seconds
from reports.document.parts import Bullets, Command, Facts, FigureGroup, Fold, Mono, Page, Paragraph, Part, Section
from reports.document.templates import lines, sentence
from reports.records.environment import environment_facts
from reports.work_precision import choices
from reports.work_precision.costs import cost_section
from reports.work_precision.diagram import widget
from reports.work_precision.methods import method_section
from reports.work_precision.overview import figures, inks
from reports.work_precision.words import engine_labels, failed_methods, label_of, noise_note, noise_share

FILE_NAME = "bench.html"


def page(bench: Bench) -> Page:
    """The page of one benchmark."""
    every, labels = places(bench), engine_labels(bench)
    first: tuple[Part, ...] = (Paragraph("Nothing finished: no engine has an error and a time.", "verdict"),)
    sections: list[Section] = []
    if groups := by_regime(every):
        as_figures = Fold("The same as figures", (FigureGroup(figures(groups, inks(labels))),))
        reading = Paragraph(sentence("bench_reading"), "small")
        first = (*choices.verdicts(groups), widget(groups, labels), reading, as_figures)
        methods = method_section(groups, bench.document["methods"], noise_share(bench))
        sections += [choices.section(groups, noise_note(bench)), methods]
    if failed := _failures(every):
        sections.append(Section("failed", "What gave nothing", (Fold(f"Failures: {len(failed)}", (Bullets(failed),)),)))
    if bench.costs:
        sections.append(cost_section(bench.costs))
    heading, about = "How accurate is an engine for its cost?", sentence("bench_subtitle")
    sections.append(_measured(bench))
    return Page(FILE_NAME, "Work-precision", heading, about, first, tuple(sections), charts=bool(groups))


def _failures(every: Sequence[PlaceFacts]) -> tuple[str, ...]:
    """Runs without a result: each reason once, with its places."""
    groups = grouped(
        (f"{label_of(facts)}, {reason}", f"{place.mechanism} in {place.regime}")
        for place in every
        for facts in place.engines(place.foremost)
        for reason in failed_methods(facts)
    )
    where = {reason: ", ".join(met) if len(met) < len(every) else "everywhere" for reason, met in groups.items()}
    return tuple(f"{reason} ({place})" for reason, place in where.items())


def _measured(bench: Bench) -> Section:
    """The conditions of the measurement, in sentences."""
    document, repeats = bench.document, sum(len(point.repeats) for point in bench.points)
    work, share = document["noise"]["work"], noise_share(bench)
    sentences = lines("measurement", extent=document["extent"], noise=bench.noise, work=work, share=share)
    known = {entry["engine"]: entry["seconds"] for entry in document["first_use"] if entry["seconds"]}
    first = ", ".join(f"{name} {seconds(min(times))}" for name, times in known.items()) or "not measured"
    facts = Facts((
        ("Conditions", document["conditions"]),
        *environment_facts(document["environment"]),
        ("Points", f"{len(bench.points)}, timed {repeats} times in all"),
        ("First use", f"{first}: the first run of a process beyond the second, import included"),
        ("Records", Mono(f"{KIND}/{RECORDS}")),
    ))  # fmt: skip
    rounds = Fold("Rounds, times, errors and orders", (Bullets(tuple(sentences)),))
    return Section("measured", "How it was measured", (rounds, facts, Command(document["command"])))
