"""A stress map: one axis, a panel for each engine, a line for each row and usage, a cell for each value.

Every cell carries its verdict as a colour and as a sign, so that it reads without colour.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.transforms import Affine2D

from comparisons.stress.axes import axes as axes_table
from comparisons.stress.border import Border
from comparisons.stress.cells import CellResult
from comparisons.stress.verdict import StressVerdict
from reports.charts.style import FULL_WIDTH, INK, MUTED, drawn
from reports.stress.facts import SIGNS, Stress, value_words

# Inches: height of a line, widest cell, gaps between engines and between rows, room for labels, title and values.
LINE, WIDEST, GAP, ROW_GAP = 0.165, 0.42, 0.16, 0.07
ROW_LETTER, USAGE_LETTER, TOP, BOTTOM = 0.066, 0.062, 0.3, 0.5
WRAPPED = 25  # letters of a row's label to a line
SHORTEST = 17  # letters that the name of the values has room for, with that of the usages
LINES_OF_LABEL = 0.13
BOX = Outline.unit_rectangle().transformed(Affine2D().scale(1.0, LINE))


@dataclass(frozen=True)
class MapLayout:
    """Where everything of one map stands: ``tops`` is each row's upper edge, in, measured downwards."""

    values: tuple[float, ...]
    rows: tuple[str, ...]
    usages: Mapping[str, tuple[str, ...]]  # of each engine
    tops: tuple[float, ...]
    depth: float

    @property
    def shared(self) -> bool:
        """Whether all engines have the same usages, so that one list of them will do."""
        return len(set(self.usages.values())) == 1


def layout(stress: Stress, axis: str) -> MapLayout:
    """Columns, rows and lines of an axis, in the order of the table of axes."""
    results = [one for one in stress.results if one.cell.axis == axis]
    usages: dict[str, dict[str, None]] = {}
    for one in results:
        usages.setdefault(one.cell.engine, {})[one.cell.usage] = None
    rows = tuple(dict.fromkeys(one.cell.row for one in results))
    deep = max(map(len, usages.values())) * LINE
    tops, depth = [], 0.0
    for row in rows:
        tops.append(depth)
        depth += max(deep, len(_wrapped(row)) * LINES_OF_LABEL) + ROW_GAP
    return MapLayout(
        columns(axis, results, quick=bool(stress.document["quick"])),
        rows,
        {name: tuple(found) for name, found in usages.items()},
        tuple(tops),
        depth,
    )


def columns(axis: str, results: Sequence[CellResult], *, quick: bool) -> tuple[float, ...]:
    """The listed values that were run, without those of the bisection; all that were, where none is listed."""
    seen = dict.fromkeys(one.cell.value for one in results)
    known = axes_table().get(axis)
    listed = tuple(value for value in (known.quick if quick else known.values) if value in seen) if known else ()
    if not known or not listed:
        return tuple(sorted(seen))
    return tuple(sorted(set(listed), reverse=known.values[0] > known.values[-1]))


def stress_figure(stress: Stress, axis: str) -> Figure:
    """The map of one axis."""
    plan = layout(stress, axis)
    room = [_room(plan, engine, first=n == 0) for n, engine in enumerate(plan.usages)]
    cells = len(plan.values) * len(room)
    cell = min(WIDEST, (FULL_WIDTH - sum(room) - 0.05) / cells)
    width, height = FULL_WIDTH, plan.depth + TOP + BOTTOM
    span = cell * len(plan.values)

    def draw(figure: Figure) -> None:
        left = 0.0
        figure.text(0.0, (BOTTOM - 0.06) / height, _value_label(axis), va="top", fontsize=7.0, color=MUTED)
        for number, engine in enumerate(plan.usages):
            left += room[number]
            panel = figure.add_axes((left / width, BOTTOM / height, span / width, plan.depth / height))
            _panel(panel, stress, axis, engine, plan, first=number == 0)
            left += span

    return drawn(width, height, draw)


def _room(plan: MapLayout, engine: str, *, first: bool) -> float:
    """What the labels left of a panel take, in."""
    letters = max(map(len, plan.usages[engine])) * USAGE_LETTER + 0.1
    label = max(SHORTEST, *(len(line) for row in plan.rows for line in _wrapped(row))) * ROW_LETTER + 0.15
    return (label if first else GAP) + (letters if first or not plan.shared else 0.0)


def _panel(panel: Axes, stress: Stress, axis: str, engine: str, plan: MapLayout, *, first: bool) -> None:
    panel.set_xlim(0.0, len(plan.values))
    panel.set_ylim(plan.depth, 0.0)
    panel.grid(visible=False)
    for spine in panel.spines.values():
        spine.set_visible(False)
    panel.set_title(engine, fontweight="bold")
    at = {(row, usage): top + n * LINE for row, top in zip(plan.rows, plan.tops, strict=True)
          for n, usage in enumerate(plan.usages[engine])}  # fmt: skip
    _cells(
        panel, [one for one in stress.results if (one.cell.axis, one.cell.engine) == (axis, engine)], at, plan.values
    )
    for (row, usage), top in at.items():
        for border in stress.line_borders.get((axis, row, engine, usage), ()):
            _border(panel, border, top, plan.values)
    _labels(panel, at, plan, first=first)


def _cells(
    panel: Axes, results: Sequence[CellResult], at: Mapping[tuple[str, str], float], values: Sequence[float]
) -> None:
    """One outline to a verdict: an element for every cell would make the page ten times as large."""
    places: dict[StressVerdict, list[tuple[int, float]]] = {}
    for one in results:
        if one.cell.value in values:
            place = values.index(one.cell.value), at[one.cell.row, one.cell.usage]
            places.setdefault(one.verdict, []).append(place)
    for verdict, found in places.items():
        sign = SIGNS[verdict]
        boxes = [BOX.transformed(Affine2D().translate(x, y)) for x, y in found]
        panel.add_patch(
            PathPatch(Outline.make_compound_path(*boxes), facecolor=sign.fill, edgecolor="white", linewidth=0.8)
        )
        bold = "bold" if verdict in (StressVerdict.MISSED, StressVerdict.CAUGHT) else "normal"
        for x, y in found:
            panel.text(x + 0.5, y + 0.54 * LINE, sign.symbol, color=sign.ink, fontsize=7.0, fontweight=bold,
                       ha="center", va="center")  # fmt: skip


def _border(panel: Axes, border: Border, top: float, values: Sequence[float]) -> None:
    """A bar between the last column inside and the first one beyond."""
    place = border_place(border, values)
    panel.plot([place, place], [top, top + LINE], color=INK, linewidth=2.2, solid_capstyle="butt", clip_on=False)


def border_place(border: Border, values: Sequence[float]) -> int:
    """The column that a border stands left of."""
    low, high = sorted((border.inside, border.outside))
    between = math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high)
    rising = list(values) == sorted(values)
    return sum(value < between if rising else value > between for value in values)


def _labels(panel: Axes, at: Mapping[tuple[str, str], float], plan: MapLayout, *, first: bool) -> None:
    panel.set_xticks([n + 0.5 for n in range(len(plan.values))], [value_words(value) for value in plan.values],
                     rotation=90, fontsize=6.5)  # fmt: skip
    named = first or not plan.shared
    panel.set_yticks(
        [top + 0.5 * LINE for top in at.values()], [usage if named else "" for _, usage in at], fontsize=7.0
    )
    panel.tick_params(length=0.0, pad=2.5)
    for top in plan.tops[1:]:
        panel.axhline(top - 0.5 * ROW_GAP, color=MUTED, linewidth=0.3)
    if first:
        _row_labels(panel, plan)


def _row_labels(panel: Axes, plan: MapLayout) -> None:
    room = _room(plan, next(iter(plan.usages)), first=True)
    for row, top in zip(plan.rows, plan.tops, strict=True):
        panel.annotate("\n".join(_wrapped(row)), (0.0, top), xycoords=("axes fraction", "data"), fontsize=7.0,
                       xytext=(-room * 72.0, -1.0), textcoords="offset points", ha="left", va="top",
                       fontweight="bold", linespacing=1.15, annotation_clip=False)  # fmt: skip


def _value_label(axis: str) -> str:
    """What the values are: once, under the rows' labels, since panels may be narrower than it."""
    known = axes_table().get(axis)
    return "\n".join(_wrapped(f"{known.label if known else 'value'}\N{NO-BREAK SPACE}→"))


def _wrapped(label: str) -> list[str]:
    return textwrap.wrap(label, WRAPPED)
