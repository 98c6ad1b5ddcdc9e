"""A stability map as a static figure: a panel to each row of its axis, as its script draws it.

Every cell carries its verdict as a colour and as a sign, so that it reads without colour.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath

from comparisons.stress.verdict import StressVerdict
from reports.charts.style import FULL_WIDTH, INK, drawn
from reports.document.parts import Figure as FigurePart
from reports.document.templates import sentence
from reports.stress.facts import SIGNS, Stress, value_words
from reports.stress.maps import MapBlock, StressMap, border_place, stress_map

# Inches: height of a line, widest cell, room of a letter, for a panel's title and for its values.
LINE, WIDEST, LETTER, TITLE, VALUES = 0.2, 0.42, 0.082, 0.3, 0.75
POINTS = 72.0  # to an inch


def map_figure(stress: Stress, axis: str) -> FigurePart:
    """The map of one axis as a part of a page; drawn when it is written."""
    found = stress_map(stress, axis)
    seen = stress.count(axis=axis)
    signs = [(sign.symbol, verdict.value) for verdict, sign in SIGNS.items() if seen[verdict]]
    caption = sentence("stress_caption", title=found.title, label=found.label, easy=found.easy, signs=signs)
    alt = f"Verdicts over {found.label} for every engine and usage"
    return FigurePart(f"map-{axis}", caption, alt, lambda: draw_map(found), wide=True)


def draw_map(found: StressMap) -> Figure:
    """The map, its panels in two columns where it has several rows."""
    names = max(len(f"{line.engine} {line.usage}") for block in found.blocks for line in block.lines)
    room, across = names * LETTER + 0.2, min(len(found.blocks), 2)
    cell = min(WIDEST, (FULL_WIDTH / across - room - 0.1) / len(found.values))
    wide = room + cell * len(found.values) + 0.1
    depth = max(len(block.lines) for block in found.blocks) * LINE
    tall = TITLE + depth + VALUES
    width, height = max(across * wide, 3.0), -(-len(found.blocks) // across) * tall

    def draw(figure: Figure) -> None:
        for number, block in enumerate(found.blocks):
            down, right = divmod(number, across)
            own = len(block.lines) * LINE
            left, bottom = right * wide + room, height - down * tall - TITLE - own
            box = left / width, bottom / height, cell * len(found.values) / width, own / height
            _panel(figure.add_axes(box), block, found, cell)

    return drawn(width, height, draw)


def _panel(panel: Axes, block: MapBlock, found: StressMap, cell: float) -> None:
    panel.set(xlim=(0.0, len(found.values)), ylim=(len(block.lines), 0.0))
    panel.grid(visible=False)
    panel.spines[:].set_visible(False)
    panel.set_title(block.row, fontsize=9.5, fontweight="bold")
    _cells(panel, block, cell)
    for top, line in enumerate(block.lines):
        for border in line.borders:
            place = border_place(border, found.values)
            panel.plot([place, place], [top, top + 1], color=INK, linewidth=2.4, solid_capstyle="butt", clip_on=False)
    middles = [n + 0.5 for n in range(len(found.values))]
    panel.set_xticks(middles, [value_words(value) for value in found.values], rotation=90, fontsize=9.0)
    names = [f"{line.engine} {line.usage}" for line in block.lines]
    panel.set_yticks([n + 0.5 for n in range(len(names))], names, fontsize=9.0)
    panel.tick_params(length=0.0, pad=2.5)


def _cells(panel: Axes, block: MapBlock, cell: float) -> None:
    """Boxes and signs are markers, one set to a verdict: an element for every cell takes ten times as long."""
    places: dict[StressVerdict, list[tuple[int, int]]] = {}
    for y, line in enumerate(block.lines):
        for x, one in enumerate(line.cells):
            if one:
                places.setdefault(one.verdict, []).append((x, y))
    half = np.array([0.5 * cell * POINTS - 0.6, 0.5 * LINE * POINTS - 0.5])
    box = Outline(half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]), closed=True)
    for verdict, found in places.items():
        sign, middles = SIGNS[verdict], (np.array(found) + 0.5).T
        for outline, ink in ((box, sign.fill), (_letter(sign.symbol), sign.ink)):
            size = 2.0 * float(np.max(np.abs(np.asarray(outline.vertices))))
            panel.plot(*middles, linestyle="", marker=outline, markersize=size, markeredgewidth=0.0, color=ink)


@cache
def _letter(symbol: str) -> Outline:
    """A sign of nine points around the origin."""
    path = TextPath((0.0, 0.0), symbol, size=9.0)
    corners = path.get_extents()
    return Outline(np.asarray(path.vertices) - 0.5 * (np.asarray(corners.min) + corners.max), path.codes)
