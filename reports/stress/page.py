"""The stability page: the verdict, the maps, their borders, and every incident with the command that repeats it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache, partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath

from comparisons.runs.files import RECORDS
from comparisons.stress.campaign import KIND, Stress
from comparisons.stress.verdict import StressVerdict
from reports.charts.draw import drawn
from reports.charts.scales import FULL_WIDTH, LIMIT_COLOUR
from reports.document import parts
from reports.document.parts import FigureGroup, Fold, Page, PageFigure, Paragraph, Section, Widget
from reports.document.templates import sentence
from reports.records.origins import environment_facts
from reports.stress import tables
from reports.stress.maps import SIGNS, axis_title, map_data, verdict_symbols

# A stability map as a static figure: a panel to each row of its axis, as its script draws it.
#
# Every cell carries its verdict as a colour and as a sign, so that it reads without colour.


# Inches: height of a line, widest cell, width of a letter, room for a panel's title and for its values.
LINE, WIDEST, LETTER, TITLE, VALUES = 0.2, 0.3, 0.082, 0.3, 0.75
BOX = 13.4  # points
BAR: dict[str, Any] = {"color": LIMIT_COLOUR, "linewidth": 2.4, "solid_capstyle": "butt", "clip_on": False}
Data = Mapping[str, Any]


def draw_map(data: Data) -> Figure:
    """The map that ``maps.map_data`` describes, its panels in two columns where it has several rows."""
    blocks, columns = data["blocks"], len(data["values"])
    room = max(len(_line_name(line)) for block in blocks for line in block["lines"]) * LETTER + 0.2
    across = min(len(blocks), 2)
    cell = min(WIDEST, (FULL_WIDTH / across - room - 0.1) / columns)
    wide, tall = room + cell * columns + 0.1, TITLE + VALUES + max(len(block["lines"]) for block in blocks) * LINE
    height = -(-len(blocks) // across) * tall

    def draw(figure: Figure) -> None:
        for number, block in enumerate(blocks):
            down, right = divmod(number, across)
            deep = len(block["lines"]) * LINE
            left, bottom = right * wide + room, height - down * tall - TITLE - deep
            box = left / FULL_WIDTH, bottom / height, cell * columns / FULL_WIDTH, deep / height
            _panel(figure.add_axes(box), block, data["values"])

    return drawn(FULL_WIDTH, height, draw, placed=False)


def _line_name(line: Data) -> str:
    return f"{line['engine']} {line['usage']}"


def _panel(panel: Axes, block: Data, values: list[str]) -> None:
    """Draw the lines of one row of an axis: cells, borders, names."""
    lines = block["lines"]
    panel.set(xlim=(0.0, len(values)), ylim=(len(lines), 0.0))
    panel.grid(visible=False)
    panel.spines[:].set_visible(False)
    panel.set_title(block["row"], fontsize=9.5, fontweight="bold")
    _cells(panel, lines)
    for top, line in enumerate(lines):
        for bar in line["bars"]:
            panel.plot([bar, bar], [top, top + 1], **BAR)
    panel.set_xticks(np.arange(len(values)) + 0.5, values, rotation=90, fontsize=9.0)
    panel.set_yticks(np.arange(len(lines)) + 0.5, [_line_name(line) for line in lines], fontsize=9.0)
    panel.tick_params(length=0.0, pad=2.5)


def _cells(panel: Axes, lines: list[Data]) -> None:
    """Boxes and signs are markers, one set to a verdict: an element for every cell takes ten times as long."""
    shown = np.array([[-1 if entry is None else entry["verdict"] for entry in line["cells"]] for line in lines])
    for number, sign in enumerate(SIGNS.values()):
        y, x = np.nonzero(shown == number)
        letter = _character_outline(sign.symbol)
        wide = 2.0 * float(np.max(np.abs(np.asarray(letter.vertices))))
        for marker, size, ink in (("s", BOX, sign.fill), (letter, wide, sign.ink)) if len(x) else ():
            panel.plot(x + 0.5, y + 0.5, linestyle="", marker=marker, markersize=size, markeredgewidth=0.0, color=ink)


@cache
def _character_outline(symbol: str) -> Outline:
    """The outline of a character, 9 points high, its middle in the origin: a mark of a plot."""
    path = TextPath((0.0, 0.0), symbol, size=9.0)
    corners = path.get_extents()
    return Outline(np.asarray(path.vertices) - 0.5 * (np.asarray(corners.min) + corners.max), path.codes)


# The stability page: the verdict, the maps, their borders, and every incident with the command that repeats it.

LINK = parts.PageLink("Stability", "stress.html")
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
        LINK.href,
        LINK.text,
        "Where each engine fails",
        sentence("stress_subtitle"),
        lead,
        (
            Section("counts", "What the cells came to", (tables.verdict_facts(stress), by_axis)),
            _maps(stress),
            Section("incidents", "Incidents", (Paragraph(sentence("stress_incidents")), *_incidents(stress))),
            _run_section(stress),
        ),
    )


def _maps(stress: Stress) -> Section:
    """The interactive map, every map as a figure, and the table of borders."""
    maps = {axis: map_data(stress, axis) for axis in stress.axes}
    first, *others = maps
    data = {
        "axes": {axis: table["title"] for axis, table in maps.items()},
        "signs": verdict_symbols(stress),
        "map": maps[first],
    }
    widget = Widget("maps", "maps", "Stability map of one axis", data, {axis: maps[axis] for axis in others})
    figures = FigureGroup(tuple(_map_figure(stress, table) for table in maps.values()))
    borders = tables.border_table(stress, axis_title)
    folds = (
        Fold(f"Every map as a figure ({len(maps)})", (figures,)),
        Fold(f"Borders, found by bisection ({len(borders.rows)})", (borders,)),
    )
    return Section("maps", "Maps", (Paragraph(sentence("stress_maps")), widget, *folds[: 2 if borders.rows else 1]))


def _map_figure(stress: Stress, table: Mapping[str, Any]) -> PageFigure:
    seen = stress.count(axis=table["axis"])
    shown = [(sign.symbol, verdict.value) for verdict, sign in SIGNS.items() if seen[verdict]]
    caption = sentence("stress_caption", title=table["title"], label=table["label"], easy=table["easy"], signs=shown)
    alt = f"Verdicts over {table['label']} for every engine and usage"
    return PageFigure(f"map-{table['axis']}", caption, alt, partial(draw_map, table))


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


def _run_section(stress: Stress) -> Section:
    spent = sum(result.spent for result in stress.results)
    cells = ("Cells", f"{len(stress.results)}, {spent:.0f} s of work in all, each a line of {KIND}/{RECORDS}")
    facts = parts.Facts((*environment_facts(stress.document["environment"]), cells))
    where = Fold("Where and with what", (facts,))
    return Section("run", "What was run", (parts.Command(stress.document["command"]), where))
