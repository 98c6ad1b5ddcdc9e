"""Where the panels of a chart stand: found from its words alone, so that none of them touches another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from reports.charts import labels, scales, surfaces
from reports.charts.scales import Scale
from reports.charts.style import ink
from reports.document.chart import Chart, Curve, Hatch, Mark, Panel

Array = NDArray[np.float64]
# An end of a curve: its place as a share of the panel's height, its name and colour.
End = tuple[float, str, str]
Entry = TypeVar("Entry", bound=Curve | Hatch)

# Inches: around a chart, of a tick with its pad, between panels, of a sample of a line in the key, between its entries.
EDGE, TICK, BETWEEN, SAMPLE, APART = 0.06, 0.08, 0.1, 0.3, 0.2
LEAST = 0.9  # of the axes of a panel
MOST = 8  # curves that are named in the key where there is no room for all at their ends
SPACED = {"x": 0.75, "y": 0.22, "equal": 0.42}  # inches from tick to tick, at least


@dataclass(frozen=True)
class ChartLayout:
    """Panels, their scales and words within ``size``, width and height in inches."""

    chart: Chart
    size: tuple[float, float]

    @property
    def columns(self) -> int:
        """How many columns there are."""
        return min(self.chart.columns, len(self.chart.panels))

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return -(-len(self.chart.panels) // self.columns)

    @property
    def shares_x(self) -> bool:
        """Whether the panels of a column have one x axis, named below the last."""
        return self.chart.panels[0].scale != "equal" and not self.chart.own_x

    def names_x(self, number: int) -> bool:
        """Whether words stand below a panel: it is the last of its column, or has an axis of its own."""
        return not self.shares_x or number + self.columns >= len(self.chart.panels)

    @cached_property
    def scales(self) -> list[tuple[Scale, Scale]]:
        """The x and y axis of every panel, before those to one scale are widened to their box."""
        wide, tall = self.size[0] / self.columns - 0.9, self.size[1] / self.rows - 0.5
        found = []
        for number, panel in enumerate(self.chart.panels):
            group = self.chart.panels[number % self.columns :: self.columns] if self.shares_x else [panel]
            x = scales.across(group, max(2, int(wide / SPACED["x"])))
            found.append((x, scales.upward(panel, max(2, int(tall / SPACED["y"])))))
        return found

    def fitted(self, number: int) -> tuple[Scale, Scale]:
        """The x and y axis of a panel."""
        panel, both = self.chart.panels[number], self.scales[number]
        if panel.scale != "equal":
            most = max(1, min(len(both[1].ticks), int(self.height / SPACED["y"])))
            tried = [scales.upward(panel, count) for count in (most, *range(most - 1, 1, -1))]
            return both[0], next(
                (y for y in tried if max(map(labels.width, y.words), default=0.0) <= self.widest), tried[0]
            )
        return scales.to_scale(panel, both, (self.width, self.height), max(2, int(self.width / SPACED["equal"])))

    @cached_property
    def ends(self) -> list[list[End]]:
        """The names at the right of every panel: of its curves, unless they stand in the key, and of its levels."""
        return [_ends(panel, y, with_curves=not self.has_key(n))
                for n, (panel, (_, y)) in enumerate(zip(self.chart.panels, self.scales, strict=True))]  # fmt: skip

    def has_key(self, number: int) -> bool:
        """Whether the curves' names stand above the panel: as requested, or where there are too many for the end."""
        panel = self.chart.panels[number]
        names = [labels.wrapped(curve.name) for curve in panel.curves if curve.name]
        tall = self.chart.height / self.rows - 0.4
        return panel.names == "key" or (panel.names == "ends" and sum(map(labels.height, names)) > tall)

    @property
    def widest(self) -> float:
        """Width of the widest words at ticks on the left, for which there is room."""
        return max((labels.width(word) for _, y in self.scales for word in y.words), default=0.0)

    @cached_property
    def margins(self) -> tuple[float, float]:
        """Room on the left and right of the axes of every panel."""
        last = [0.5 * labels.width(x.words[-1]) for x, _ in self.scales if x.words]
        names = [labels.width(end[1]) + labels.GAP for ends in self.ends for end in ends]
        beside = (labels.LINE + 0.05) * any(y.label for _, y in self.scales)
        bars = [surfaces.bar_room(panel.surface) for panel in self.chart.panels if panel.surface]
        return EDGE + TICK + self.widest + beside, EDGE + max([0.0, *last, *names, *bars])

    @property
    def width(self) -> float:
        """Of the axes of a panel."""
        return (self.size[0] + BETWEEN) / self.columns - BETWEEN - sum(self.margins)

    @cached_property
    def keys(self) -> list[list[list[Curve]]]:
        """The rows of every panel's key."""
        return [_key_rows(panel, self.width) if self.has_key(n) else [] for n, panel in enumerate(self.chart.panels)]

    @cached_property
    def uprights(self) -> list[list[int]]:
        """The row above a panel in which each of its named uprights has its name."""
        return [labels.rows_above([self.upright(n, mark.place, mark.name) for mark in named_uprights(panel)])
                for n, panel in enumerate(self.chart.panels)]  # fmt: skip

    def upright(self, number: int, place: float, name: str) -> tuple[float, float]:
        """Left and right end of an upright's name above a panel, in, kept within the panel."""
        half = 0.5 * labels.width(name)
        middle = float(np.clip(self.width * self.scales[number][0].share(place), half, max(self.width - half, half)))
        return middle - half, middle + half

    def above(self, number: int) -> float:
        """Room above a panel."""
        named = max(self.uprights[number], default=-1) + 1
        rows = named + len(self.keys[number]) + labels.lines(self.chart.panels[number].title)
        return EDGE + labels.LINE * (0.5 + rows)

    def below(self, number: int) -> float:
        """Room below a panel."""
        if not self.names_x(number):
            return 0.0
        return (
            TICK + labels.LINE * (1.2 + labels.lines(self.scales[number][0].label)) + (0.04 if self.rows > 1 else 0.0)
        )

    @cached_property
    def heights(self) -> list[tuple[float, float]]:
        """Room above and below the axes of every row."""
        rows = [range(r * self.columns, min((r + 1) * self.columns, len(self.chart.panels))) for r in range(self.rows)]
        return [(max(map(self.above, row)), max(map(self.below, row))) for row in rows]

    @property
    def height(self) -> float:
        """Of the axes of a panel, in."""
        return (self.size[1] - EDGE - sum(map(sum, self.heights))) / self.rows

    def box(self, number: int) -> tuple[float, float, float, float]:
        """Left, bottom, width and height of a panel's axes, in."""
        row, column = divmod(number, self.columns)
        left = column * (self.size[0] + BETWEEN) / self.columns + self.margins[0]
        top = sum(map(sum, self.heights[:row])) + row * self.height + self.heights[row][0]
        return left, self.size[1] - top - self.height, self.width, self.height


def named_uprights(panel: Panel) -> list[Mark]:
    """The marks at places of a panel's x axis that have a name, from left to right."""
    return sorted((mark for mark in panel.marks if mark.along == "x" and mark.name), key=lambda mark: mark.place)


def _ends(panel: Panel, y: Scale, *, with_curves: bool) -> list[End]:
    found = []
    if with_curves and panel.names == "ends":
        below = np.zeros(1)
        for curve in panel.curves:
            height = _last(curve.y) if not curve.stacked else 0.5 * (_last(curve.y) + _last(below))
            below = curve.y
            found += [(y.share(height), labels.wrapped(curve.name), ink(curve.ink))] if curve.name else []
    levels = [mark for mark in panel.marks if mark.along == "y" and mark.name]
    return found + [(y.share(mark.place), labels.wrapped(mark.name), ink(mark.ink)) for mark in levels]


def _last(values: Array) -> float:
    return float(next((value for value in values[::-1] if np.isfinite(value)), 0.0))


def key_width(curve: Curve | Hatch) -> float:
    """Of a name in the key with its sample and the room behind it, in."""
    return SAMPLE + labels.width(curve.name) + APART


def _key_rows(panel: Panel, width: float) -> list[list[Curve]]:
    """Curves with a name, each once, in as many columns as fit; the largest of too many that had no room at the end."""
    named = list({curve.name: curve for curve in panel.curves if curve.name}.values())
    if panel.names == "ends" and len(named) > MOST:
        below = [curve.y if curve.stacked else np.zeros(1) for curve in named]
        sizes = [float(np.nanmax(np.abs(one.y - y))) for one, y in zip(named, [np.zeros(1), *below[:-1]], strict=True)]
        kept = sorted(np.argsort(sizes)[-MOST:])
        rest = Curve(np.zeros(0), np.zeros(0), f"and {len(named) - MOST} more", line="")
        named = [*(named[n] for n in kept), rest]
    return in_rows(named, width)


def in_rows(named: Sequence[Entry], width: float) -> list[list[Entry]]:
    """Entries of a key in as many columns as fit."""
    columns = max(1, int(width / max(map(key_width, named), default=width)))
    return [list(named[first : first + columns]) for first in range(0, len(named), columns)]
