"""A stability map as data: a block to each row of an axis, a line to each engine and usage, a cell to each value."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from comparisons.stress.axes import axes
from comparisons.stress.border import Border
from comparisons.stress.cells import CellResult
from reports.document.numbers import seconds
from reports.document.templates import plain, worded
from reports.stress.facts import SIGNS, Line, Stress, against, axis_title, border_words, value_words

WHITE = "#ffffff"  # ink of a sign that looks the same in the dark


@dataclass(frozen=True)
class MapLine:
    """The cells of one engine and usage, None where none was made; ``borders`` in the order of the columns."""

    engine: str
    usage: str
    cells: tuple[CellResult | None, ...]
    borders: tuple[Border, ...]


@dataclass(frozen=True)
class MapBlock:
    """The lines of one row of an axis."""

    row: str
    lines: tuple[MapLine, ...]


@dataclass(frozen=True)
class StressMap:
    """One axis: ``values`` are those of its columns, ``label`` what they are, ``easy`` the easiest in words."""

    axis: str
    title: str
    about: str
    label: str
    easy: str
    values: tuple[float, ...]
    blocks: tuple[MapBlock, ...]


def stress_map(stress: Stress, axis: str) -> StressMap:
    """The map of one axis; an axis that the table has no more is told by its name alone."""
    known = axes().get(axis)
    values = stress.columns[axis]
    label, easy = (known.label, value_words(known.good)) if known else ("value", "")
    blocks = tuple(
        MapBlock(row, tuple(_line(stress, line, values) for line in stress.lines if line[:2] == (axis, row)))
        for row in dict.fromkeys(line[1] for line in stress.lines if line[0] == axis)
    )
    return StressMap(axis, axis_title(axis), known.about if known else "", label, easy, values, blocks)


def _line(stress: Stress, line: Line, values: Sequence[float]) -> MapLine:
    by_value = {one.cell.value: one for one in stress.lines[line]}
    found = sorted(stress.line_borders.get(line, ()), key=lambda border: border_place(border, values))
    return MapLine(line[2], line[3], tuple(by_value.get(value) for value in values), tuple(found))


def border_place(border: Border, values: Sequence[float]) -> int:
    """The column that a border stands left of."""
    low, high = sorted((border.inside, border.outside))
    between = math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high)
    rising = list(values) == sorted(values)
    return sum(value < between if rising else value > between for value in values)


def story(result: CellResult) -> dict[str, str]:
    """What came of a cell and of what it rests on, as name and words; what there is nothing of is left out."""
    judgement = result.judgement
    parts = {
        "Reason": judgement.reason,
        "Worst deviation": against(worded(judgement.quantity), judgement.deviation, judgement.deviation_limit),
        "Worst invariant": against(plain(judgement.invariant), judgement.invariant_error, judgement.invariant_limit),
        "Work": f"{result.steps} steps in {seconds(result.seconds)}" if result.steps else "",
        "Conditions": ", ".join(f"{plain(name)} {_condition(value)}" for name, value in result.conditions.items()),
    }
    return {name: words for name, words in parts.items() if words}


def _condition(value: object) -> str:
    return value_words(value) if isinstance(value, float) else str(value)


def map_data(found: StressMap) -> dict[str, Any]:
    """The map for its script: a cell is the number of its verdict, its story and the command that repeats it."""
    order = list(SIGNS)

    def cell(one: CellResult | None) -> dict[str, Any] | None:
        if one is None:
            return None
        return {"verdict": order.index(one.verdict), "story": story(one), "command": one.document["command"]}

    def line(one: MapLine) -> dict[str, Any]:
        return {
            "engine": one.engine,
            "usage": one.usage,
            "cells": [cell(result) for result in one.cells],
            "bars": [border_place(border, found.values) for border in one.borders],
            "border": "; ".join(border_words(border) for border in one.borders),
        }

    return {
        "axis": found.axis,
        "about": found.about,
        "label": found.label,
        "easy": found.easy,
        "values": [value_words(value) for value in found.values],
        "blocks": [{"row": block.row, "lines": [line(one) for one in block.lines]} for block in found.blocks],
    }


def widget_data(stress: Stress, first: str) -> Mapping[str, Any]:
    """What the widget needs at once: names of the axes, signs of the verdicts that occur, the map of ``first``."""
    seen = stress.count()
    return {
        "axes": {name: axis_title(name) for name in stress.axes},
        "signs": [
            {"sign": sign.symbol, "word": verdict.value, "meaning": sign.meaning, "fill": sign.fill, "ink": sign.ink,
             "fixed": sign.ink == WHITE, "occurs": bool(seen[verdict])}
            for verdict, sign in SIGNS.items()
        ],
        "map": map_data(stress_map(stress, first)),
    }  # fmt: skip
