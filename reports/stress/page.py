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
from reports.facts.views import anchor
from reports.stress.facts import FILE, SYMBOLS, Stress, axis_title, value_words
from reports.stress.figure import COLOURS, stress_figure
from reports.stress.section import TEMPLATES, Table, border_table, fragment, templates

PAGE = "stress.html"
MAP_WORDS = "A bar stands at the border of the limit, where bisection found it between two columns or beside one."


@dataclass(frozen=True)
class LegendEntry:
    """A verdict as the maps show it."""

    symbol: str
    fill: str
    ink: str
    name: str
    meaning: str
    cells: int


@dataclass(frozen=True)
class AxisPart:
    """One axis on the page; ``counts`` is what its cells came to, in words."""

    key: str
    title: str
    about: str
    cells: int
    counts: str
    drawing: Markup
    borders: Table


@dataclass(frozen=True)
class Incident:
    """A cell worth a reader's look, with the command that makes it again."""

    place: str
    value: str
    engine: str
    usage: str
    reason: str
    command: str


@dataclass(frozen=True)
class IncidentList:
    """All cells of one verdict; a long list is folded away."""

    key: str
    title: str
    meaning: str
    rows: tuple[Incident, ...]
    is_open: bool


def write(stress: Stress, folder: Path) -> Path:
    """Write the page into a folder; returns its path."""
    write_text(folder / PAGE, page(stress))
    return folder / PAGE


def page(stress: Stress) -> str:
    """The page's HTML."""
    return (
        templates()
        .get_template("stress.html")
        .render(
            style=Markup((TEMPLATES / "style.css").read_text(encoding="utf-8")),
            facts=facts(stress),
            section=fragment(stress, with_borders=False),
            legend=legend(stress),
            map_words=MAP_WORDS,
            axes=[axis_part(stress, name) for name in stress.axes],
            incidents=incidents(stress),
            command=stress.document["command"],
            file=FILE,
        )
    )


def facts(stress: Stress) -> list[tuple[str, str]]:
    """Name and value of everything that decides a cell."""
    told = dict(stress.document["environment"])
    first = [(name.capitalize(), told.pop(name)) for name in ("date", "machine", "commit") if name in told]
    spent = sum(one.spent for one in stress.results)
    return [
        ("Command", stress.document["command"]),
        *first,
        ("Versions", ", ".join(f"{name} {version}" for name, version in told.items())),
        ("Cells", f"{len(stress.results)}, {spent:.0f} s of work in all"),
    ]


def legend(stress: Stress) -> list[LegendEntry]:
    """Every verdict with its sign and meaning, those that did not occur too."""
    count = stress.count()
    return [
        LegendEntry(SYMBOLS[verdict], *COLOURS[verdict], verdict.value, MEANINGS[verdict], count[verdict])
        for verdict in StressVerdict
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
    """What was missed, what was a false alarm, what was caught, what crashed; the worst first."""
    folded: Mapping[StressVerdict, bool] = {
        StressVerdict.MISSED: False,
        StressVerdict.ALARM: False,
        StressVerdict.CRASHED: False,
        StressVerdict.CAUGHT: True,
    }
    return [
        IncidentList(anchor(verdict.value), verdict.value.capitalize(), MEANINGS[verdict],
                     tuple(map(incident, _ordered(stress.of(verdict)))), is_open=not fold)
        for verdict, fold in folded.items()
    ]  # fmt: skip


def _ordered(results: Iterable[CellResult]) -> list[CellResult]:
    """Engines together, each in the order of the maps."""
    return sorted(results, key=lambda one: one.cell.engine)


def incident(result: CellResult) -> Incident:
    """A cell in words."""
    cell = result.cell
    place = f"{axis_title(cell.axis)}: {cell.row}"
    command = str(result.document["command"])
    return Incident(place, value_words(cell.value), cell.engine, cell.usage, result.judgement.reason, command)
