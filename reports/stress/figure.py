"""A stability map as a static figure: a panel to each row of its axis, as its script draws it.

Every cell carries its verdict as a colour and as a sign, so that it reads without colour.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath

from reports.charts.draw import drawn
from reports.charts.style import FULL_WIDTH, LIMIT_COLOUR
from reports.stress.facts import SIGNS

# Inches: height of a line, widest cell, width of a letter, room for a panel's title and for its values.
LINE, WIDEST, LETTER, TITLE, VALUES = 0.2, 0.3, 0.082, 0.3, 0.75
BOX = 13.4  # points
BAR: dict[str, Any] = {"color": LIMIT_COLOUR, "linewidth": 2.4, "solid_capstyle": "butt", "clip_on": False}
Data = Mapping[str, Any]


def draw_map(data: Data) -> Figure:
    """The map that ``maps.map_data`` describes, its panels in two columns where it has several rows."""
    blocks, columns = data["blocks"], len(data["values"])
    room = max(len(_name(line)) for block in blocks for line in block["lines"]) * LETTER + 0.2
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


def _name(line: Data) -> str:
    return f"{line['engine']} {line['usage']}"


def _panel(panel: Axes, block: Data, values: list[str]) -> None:
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
    panel.set_yticks(np.arange(len(lines)) + 0.5, [_name(line) for line in lines], fontsize=9.0)
    panel.tick_params(length=0.0, pad=2.5)


def _cells(panel: Axes, lines: list[Data]) -> None:
    """Boxes and signs are markers, one set to a verdict: an element for every cell takes ten times as long."""
    shown = np.array([[-1 if entry is None else entry["verdict"] for entry in line["cells"]] for line in lines])
    for number, sign in enumerate(SIGNS.values()):
        y, x = np.nonzero(shown == number)
        letter = _letter(sign.symbol)
        wide = 2.0 * float(np.max(np.abs(np.asarray(letter.vertices))))
        for marker, size, ink in (("s", BOX, sign.fill), (letter, wide, sign.ink)) if len(x) else ():
            panel.plot(x + 0.5, y + 0.5, linestyle="", marker=marker, markersize=size, markeredgewidth=0.0, color=ink)


@cache
def _letter(symbol: str) -> Outline:
    """A sign of nine points around the origin."""
    path = TextPath((0.0, 0.0), symbol, size=9.0)
    corners = path.get_extents()
    return Outline(np.asarray(path.vertices) - 0.5 * (np.asarray(corners.min) + corners.max), path.codes)
