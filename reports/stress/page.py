"""The stability page: the verdict, the maps, their borders, and every incident with the command that repeats it."""

from __future__ import annotations

from comparisons.stress.verdict import StressVerdict
from reports.document.parts import (
    Command,
    Facts,
    Figures,
    Fold,
    Link,
    Page,
    Paragraph,
    Part,
    Section,
    Widget,
)
from reports.document.templates import sentence
from reports.records.environment import environment_facts
from reports.stress.facts import FILE, SIGNS, Stress, axis_title
from reports.stress.figure import map_figure
from reports.stress.maps import map_data, stress_map, widget_data
from reports.stress.tables import border_table, count_table, incident_table, ranking, scope, verdict, verdict_table

PAGE = "stress.html"
TITLE = "Where each engine fails"
# What stands open on the page; what was caught is folded away.
INCIDENTS = (
    *(StressVerdict.SUITE_ERROR, StressVerdict.MISSED, StressVerdict.ALARM, StressVerdict.CRASHED),
    *(StressVerdict.ADAPTER_ERROR, StressVerdict.CAUGHT),
)


def page(stress: Stress) -> Page:
    """The page of a saved stress test."""
    return Page(
        file=PAGE,
        title="Stability",
        heading=TITLE,
        subtitle=sentence("stress_subtitle"),
        parts=(
            Paragraph(verdict(stress), "verdict"),
            Paragraph(ranking(stress), "lead"),
            Paragraph(scope(stress), "small"),
        ),
        sections=(_counts(stress), _maps(stress), _borders(stress), _incidents(stress), _run(stress)),
    )


def _counts(stress: Stress) -> Section:
    by_axis = count_table(stress, lambda axis: Link(axis_title(axis), f"#map-{axis}"), sentence("stress_counts"))
    return Section("counts", "What the cells came to", (verdict_table(stress), by_axis))


def _maps(stress: Stress) -> Section:
    first, *others = stress.axes
    figures = tuple(map_figure(stress, axis) for axis in stress.axes)
    widget = Widget(
        "maps",
        "maps",
        "Stability map of one axis",
        widget_data(stress, first),
        {axis: map_data(stress_map(stress, axis)) for axis in others},
    )
    every = Fold(f"Every map as a figure ({len(figures)})", (Figures(figures),))
    return Section("maps", "Maps", (Paragraph(sentence("stress_maps")), widget, every))


def _borders(stress: Stress) -> Section:
    table = border_table(stress)
    return Section("borders", "Borders", (Fold(f"How far each of {len(table.rows)} lines goes", (table,)),))


def _incidents(stress: Stress) -> Section:
    parts: list[Part] = [Paragraph(sentence("stress_incidents"))]
    for found in INCIDENTS:
        if cells := stress.of(found):
            words = f"{found.value.capitalize()} ({len(cells)}): {SIGNS[found].meaning}"
            parts.append(Fold(words, (incident_table(cells),), is_open=found is not StressVerdict.CAUGHT))
    none = ", ".join(found.value for found in INCIDENTS if not stress.of(found))
    return Section("incidents", "Incidents", (*parts, *([Paragraph(f"None: {none}.")] if none else [])))


def _run(stress: Stress) -> Section:
    spent = sum(one.spent for one in stress.results)
    cells = ("Cells", f"{len(stress.results)}, {spent:.0f} s of work in all, each in {FILE}")
    facts = Facts((*environment_facts(stress.document["environment"]), cells))
    return Section("run", "What was run", (Command(stress.document["command"]), Fold("Where and with what", (facts,))))
