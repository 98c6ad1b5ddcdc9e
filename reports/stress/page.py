"""The stress maps as one page: opens offline, and needs no engine."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from markupsafe import Markup

from comparisons.runs.files import write_text
from comparisons.stress.axes import axes
from comparisons.stress.cells import CellResult
from comparisons.stress.verdict import StressVerdict
from reports.charts.style import picture
from reports.document.tables import ReportTable
from reports.document.templates import render
from reports.records.environment import environment_facts
from reports.records.views import anchor
from reports.stress.facts import FILE, SIGNS, Stress, axis_title, value_words
from reports.stress.figure import stress_figure
from reports.stress.section import border_table, section

PAGE = "stress.html"
# Each with every cell and the command that makes it again; those that were caught are folded away.
INCIDENTS = (
    *(StressVerdict.SUITE_ERROR, StressVerdict.MISSED, StressVerdict.ALARM, StressVerdict.CRASHED),
    *(StressVerdict.ADAPTER_ERROR, StressVerdict.CAUGHT),
)


def write(stress: Stress, folder: Path) -> Path:
    """Write the page into a folder; returns its path."""
    write_text(folder / PAGE, page(stress))
    return folder / PAGE


def page(stress: Stress) -> str:
    """The page's HTML."""
    return render(
        "stress.html",
        facts=_facts(stress),
        section=section(stress, with_borders=False),
        signs=SIGNS,
        count=stress.count(),
        axes=[_axis_part(stress, name) for name in stress.axes],
        incidents=[(verdict, anchor(verdict.value), incident_table(stress.of(verdict))) for verdict in INCIDENTS],
        command=stress.document["command"],
        file=FILE,
    )


def _facts(stress: Stress) -> list[tuple[str, str]]:
    """Name and value of everything that decides a cell."""
    spent = sum(one.spent for one in stress.results)
    return [
        ("Command", stress.document["command"]),
        *environment_facts(stress.document["environment"]),
        ("Cells", f"{len(stress.results)}, {spent:.0f} s of work in all"),
    ]


def _axis_part(stress: Stress, name: str) -> dict[str, object]:
    """One axis: what its cells came to, its map and its borders."""
    known, key, title = axes().get(name), anchor("stress", name), axis_title(name)
    return {
        "key": key,
        "title": title,
        "about": known.about if known else "",
        "count": stress.count(axis=name),
        "drawing": picture(stress_figure(stress, name), f"{key}-map", f"verdicts over {title.lower()}, every engine"),
        "borders": border_table(stress, [name]),
    }


def incident_table(results: Iterable[CellResult]) -> ReportTable:
    """A row per cell, with its reason and its command."""
    rows = tuple(_incident(one) for one in sorted(results, key=lambda one: one.cell.engine))
    return ReportTable("", ("Engine", "Axis: row", "Value", "Usage", "Reason", "Again"), rows, align="llrl")


def _incident(result: CellResult) -> tuple[str, ...]:
    cell, command = result.cell, Markup("<code>{}</code>").format(result.document["command"])
    place = f"{axis_title(cell.axis)}: {cell.row}"
    return (cell.engine, place, value_words(cell.value), cell.usage, result.judgement.reason, command)
