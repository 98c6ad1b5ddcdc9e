"""The benchmark as one page: opens offline beside its script, and needs no engine."""

from __future__ import annotations

from pathlib import Path

from markupsafe import Markup

from comparisons.runs.files import write_text
from comparisons.work_precision.measure import JOINTS
from comparisons.work_precision.records import FILE, Bench
from reports.document.numbers import seconds
from reports.document.tables import ReportTable
from reports.document.templates import lines, render
from reports.records.environment import environment_facts
from reports.records.views import anchor
from reports.work_precision.facts import PlaceFacts, failed_methods, places
from reports.work_precision.figure import inks, save_figure
from reports.work_precision.interactive import SCRIPT, bench_html, script
from reports.work_precision.section import overview, regimes, section
from reports.work_precision.words import floor_table, method_table, noise_share, standing_words

PAGE = "bench.html"


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
        facts=_facts(bench),
        section=section(bench),
        parts=[_part(bench, place) for place in every],
        methods=method_table(bench),
        measured=lines(
            "measurement",
            extent=bench.document["extent"],
            noise=bench.noise,
            work=bench.document["noise"]["work"],
            share=noise_share(bench),
        ),
        command=bench.document["command"],
        file=FILE,
    )


def _facts(bench: Bench) -> list[tuple[str, str]]:
    """Name and value of everything that decides a figure or a time."""
    repeats = sum(len(point.repeats) for point in bench.points)
    first = [f"{one['engine']} {seconds(min(one['seconds']))}" for one in bench.document["first_use"] if one["seconds"]]
    first_use = "what the first run of a process costs beyond the second, import included"
    return [
        ("Command", bench.document["command"]),
        ("Conditions", bench.document["conditions"]),
        *environment_facts(bench.document["environment"]),
        ("Points", f"{len(bench.points)}, timed {repeats} times in all"),
        ("First use", f"{', '.join(first) or 'not measured'}: {first_use}"),
    ]


def _part(bench: Bench, place: PlaceFacts) -> dict[str, object]:
    """What the page shows of one mechanism and regime."""
    key = anchor("bench", place.mechanism, place.variant, place.regime)
    drawing = bench_html(place, inks(bench), f"{key}-plot") if place.quantities else ""
    ordered = sorted(place.quantities, key=lambda name: name != place.foremost)
    failures = [f"{facts.label}: {told}" for facts in place.engines(place.foremost) for told in failed_methods(facts)]
    return {
        "key": key,
        "place": place,
        "interactive": Markup(drawing),
        "quantities": [(name, *_quantity(place, name, noise_share(bench))) for name in ordered],
        "failures": failures,
    }


def _quantity(place: PlaceFacts, name: str, noise: float) -> tuple[ReportTable, list[str]]:
    """The methods in one quantity, and how the settings stand against them."""
    engines = place.engines(name)
    found = next((r.error for r in place.records if r.quantity == name and r.error), None)
    over = f" ({found.peak:.4g} {found.unit})" if found and found.peak else ""
    worst = "; of joint forces the worst joint's" if name == JOINTS else ""
    table = floor_table(engines, f"Largest error over the closed form's peak{over}{worst}.")
    return table, [words for facts in engines for words in standing_words(facts, noise)]
