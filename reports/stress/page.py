"""The stress maps as one page: opens offline, and needs no engine."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from comparisons.runs.files import write_text
from comparisons.stress.axes import axes
from comparisons.stress.cells import CellResult
from comparisons.stress.verdict import MEANINGS, StressVerdict
from reports.drawing.style import picture
from reports.facts.environment import environment_facts
from reports.facts.views import anchor
from reports.stress.facts import FILE, SIGNS, Stress, axis_title, value_words
from reports.stress.figure import stress_figure
from reports.stress.section import border_table, section
from reports.text.tables import ReportTable
from reports.text.templates import render

PAGE = "stress.html"
MAP_WORDS = "A bar stands at the border of the limit, where bisection found it between two columns or beside one."


@dataclass(frozen=True)
class AxisPart:
    """One axis on the page; ``counts`` is what its cells came to, in words."""

    key: str
    title: str
    about: str
    cells: int
    counts: str
    drawing: Markup
    borders: ReportTable


@dataclass(frozen=True)
class IncidentList:
    """All cells of one verdict, each with the command that makes it again; a long list is folded away."""

    key: str
    title: str
    meaning: str
    table: ReportTable
    is_open: bool


def write(stress: Stress, folder: Path) -> Path:
    """Write the page into a folder; returns its path."""
    write_text(folder / PAGE, page(stress))
    return folder / PAGE


def page(stress: Stress) -> str:
    """The page's HTML."""
    return render(
        "stress.html",
        facts=facts(stress),
        section=section(stress, with_borders=False),
        signs=SIGNS,
        meanings=MEANINGS,
        count=stress.count(),
        map_words=MAP_WORDS,
        axes=[axis_part(stress, name) for name in stress.axes],
        incidents=incidents(stress),
        command=stress.document["command"],
        file=FILE,
    )


def facts(stress: Stress) -> list[tuple[str, str]]:
    """Name and value of everything that decides a cell."""
    spent = sum(one.spent for one in stress.results)
    return [
        ("Command", stress.document["command"]),
        *environment_facts(stress.document["environment"]),
        ("Cells", f"{len(stress.results)}, {spent:.0f} s of work in all"),
    ]


def axis_part(stress: Stress, name: str) -> AxisPart:
    """One axis: its map and its borders."""
    known, key = axes().get(name), anchor("stress", name)
    title = axis_title(name)
    count = stress.count(axis=name)
    return AxisPart(
        key=key,
        title=title,
        about=known.about if known else "",
        cells=count.total(),
        counts=", ".join(f"{count[verdict]} {verdict.value}" for verdict in StressVerdict if count[verdict]),
        drawing=picture(stress_figure(stress, name), f"{key}-map", f"verdicts over {title.lower()}, every engine"),
        borders=border_table(stress, [name]),
    )


def incidents(stress: Stress) -> list[IncidentList]:
    """What was missed, what was a false alarm, what crashed, what was caught; engines together."""
    folded: Mapping[StressVerdict, bool] = {
        StressVerdict.SUITE_ERROR: False,
        StressVerdict.MISSED: False,
        StressVerdict.ALARM: False,
        StressVerdict.CRASHED: False,
        StressVerdict.ADAPTER_ERROR: False,
        StressVerdict.CAUGHT: True,
    }
    return [
        IncidentList(anchor(verdict.value), verdict.value.capitalize(), MEANINGS[verdict],
                     incident_table(stress.of(verdict)), is_open=not fold)
        for verdict, fold in folded.items()
    ]  # fmt: skip


def incident_table(results: Iterable[CellResult]) -> ReportTable:
    """A row per cell, with its reason and its command."""
    rows = tuple(_incident(one) for one in sorted(results, key=lambda one: one.cell.engine))
    return ReportTable("", ("Engine", "Axis: row", "Value", "Usage", "Reason", "Again"), rows, align="llrl")


def _incident(result: CellResult) -> tuple[str, ...]:
    cell, command = result.cell, Markup("<code>{}</code>").format(result.document["command"])
    place = f"{axis_title(cell.axis)}: {cell.row}"
    return (cell.engine, place, value_words(cell.value), cell.usage, result.judgement.reason, command)
