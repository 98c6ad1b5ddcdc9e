"""The stability page: the verdict, the maps, their borders, and every incident with the command that repeats it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

from comparisons.runs.record_file import RECORDS
from comparisons.stress.cell_result import StressVerdict
from comparisons.stress.saved import KIND, Stress
from reports.document import parts
from reports.document.parts import FigureGroup, Fold, Page, PageFigure, Paragraph, Section, Widget
from reports.document.templates import sentence
from reports.records.environment import environment_facts
from reports.stress import tables
from reports.stress.facts import SIGNS, axis_title
from reports.stress.figure import draw_map
from reports.stress.maps import map_data, signs

PAGE = "stress.html"
# What stands open on the page unless its table is long; what was caught, as it should be, is folded away.
OPEN = (*tables.LOUD, StressVerdict.SUITE_ERROR, StressVerdict.CRASHED, StressVerdict.ADAPTER_ERROR)
MOST_OPEN = 12


def page(stress: Stress) -> Page:
    """The page of a saved stress test."""
    lead = (
        Paragraph(tables.summary(stress, "stress_verdict"), "verdict"),
        Paragraph(tables.ranking(stress), "lead"),
        Paragraph(tables.summary(stress, "stress_scope"), "small"),
    )
    caption = sentence("stress_counts")
    by_axis = tables.count_table(stress, lambda axis: parts.PageLink(axis_title(axis), f"#map-{axis}"), caption)
    return Page(
        PAGE,
        "Stability",
        "Where each engine fails",
        sentence("stress_subtitle"),
        lead,
        (
            Section("counts", "What the cells came to", (tables.verdict_facts(stress), by_axis)),
            _maps(stress),
            Section("incidents", "Incidents", (Paragraph(sentence("stress_incidents")), *_incidents(stress))),
            _run(stress),
        ),
    )


def _maps(stress: Stress) -> Section:
    maps = {axis: map_data(stress, axis) for axis in stress.axes}
    first, *others = maps
    data = {"axes": {axis: table["title"] for axis, table in maps.items()}, "signs": signs(stress), "map": maps[first]}
    widget = Widget("maps", "maps", "Stability map of one axis", data, {axis: maps[axis] for axis in others})
    figures = FigureGroup(tuple(_figure(stress, table) for table in maps.values()))
    borders = tables.border_table(stress, axis_title)
    folds = (
        Fold(f"Every map as a figure ({len(maps)})", (figures,)),
        Fold(f"Borders, found by bisection ({len(borders.rows)})", (borders,)),
    )
    return Section("maps", "Maps", (Paragraph(sentence("stress_maps")), widget, *folds[: 2 if borders.rows else 1]))


def _figure(stress: Stress, table: Mapping[str, Any]) -> PageFigure:
    seen = stress.count(axis=table["axis"])
    shown = [(sign.symbol, verdict.value) for verdict, sign in SIGNS.items() if seen[verdict]]
    caption = sentence("stress_caption", title=table["title"], label=table["label"], easy=table["easy"], signs=shown)
    alt = f"Verdicts over {table['label']} for every engine and usage"
    return PageFigure(f"map-{table['axis']}", caption, alt, partial(draw_map, table), wide=True)


def _incidents(stress: Stress) -> Iterator[parts.Part]:
    """A table to each verdict that occurs, and a sentence on those that do not."""
    cells = {stress_verdict: stress.of(stress_verdict) for stress_verdict in (*OPEN, StressVerdict.CAUGHT)}
    for verdict, results in cells.items():
        if results:
            table, words = (
                tables.incident_table(results),
                f"{verdict.value.capitalize()} ({len(results)}): {SIGNS[verdict].meaning}",
            )
            yield Fold(words, (table,), is_open=verdict in OPEN and len(table.rows) <= MOST_OPEN)
    if absent := [stress_verdict.value for stress_verdict, cell_results in cells.items() if not cell_results]:
        yield Paragraph(f"None: {', '.join(absent)}.")


def _run(stress: Stress) -> Section:
    spent = sum(result.spent for result in stress.results)
    cells = ("Cells", f"{len(stress.results)}, {spent:.0f} s of work in all, each a line of {KIND}/{RECORDS}")
    facts = parts.Facts((*environment_facts(stress.document["environment"]), cells))
    where = Fold("Where and with what", (facts,))
    return Section("run", "What was run", (parts.Command(stress.document["command"]), where))
