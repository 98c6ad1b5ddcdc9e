"""A stability map as data: a block to each row of an axis, a line to each engine and usage, a cell to each value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from comparisons.judging.verdicts import grouped
from comparisons.stress.axes import axes
from comparisons.stress.border import Border
from comparisons.stress.cell_result import CellResult
from comparisons.stress.saved import Line, Stress
from reports.document.numbers import seconds
from reports.document.templates import plain, worded
from reports.stress.facts import SIGNS, against, border_words, value_words

WHITE = "#fdfdfd"  # ink of a sign that looks the same in the dark
FLAGGED = "Flagged: "  # separates the fault from the checks' messages in a reason


def map_data(stress: Stress, axis: str) -> dict[str, Any]:
    """The map of one axis, JSON-ready: for its script and its figure."""
    known, values = axes()[axis], stress.columns[axis]
    rows = grouped((line[1], _line(stress, line, values)) for line in stress.lines if line[0] == axis)
    return {
        "axis": axis,
        "title": known.title,
        "about": known.about,
        "label": known.label,
        "easy": value_words(known.good),
        "values": [value_words(value) for value in values],
        "blocks": [{"row": row, "lines": lines} for row, lines in rows.items()],
    }


def _line(stress: Stress, line: Line, values: Sequence[float]) -> dict[str, Any]:
    """The cells of one engine and usage, None without a run; a border stands left of each of ``bars``."""
    cells = {result.cell.value: _cell(result) for result in stress.lines[line]}
    borders = stress.line_borders.get(line, ())
    return {
        "engine": line[2],
        "usage": line[3],
        "cells": [cells.get(value) for value in values],
        "bars": [border_place(border, values) for border in borders],
        "border": "; ".join(map(border_words, borders)),
    }


def _cell(result: CellResult) -> dict[str, Any]:
    """The number of its verdict, its story, and the command that repeats it."""
    sign = list(SIGNS).index(result.verdict)
    return {"verdict": sign, "story": story(result), "command": result.cell.command}


def border_place(border: Border, values: Sequence[float]) -> int:
    """The column that a border stands left of."""
    low, high = sorted((border.inside, border.outside))
    between = math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high)
    rising = list(values) == sorted(values)
    return sum(value < between if rising else value > between for value in values)


def story(result: CellResult) -> dict[str, str]:
    """The result of a cell and its reasons, as name and words, without empty ones."""
    wrong, _, flagged = result.reason.partition(FLAGGED)
    parts = {
        "Wrong" if result.wrong else "Reason": wrong.rstrip(". "),
        "Flagged by the checks": flagged,
        "Worst deviation, over the peak": against(result.nearest, worded),
        "Worst invariant": against(result.worst_check, plain),
        "Work": f"{result.steps} steps in {seconds(result.seconds)}" if result.steps else "",
        "Conditions": "; ".join(f"{plain(name)} {_condition(value)}" for name, value in result.differing.items()),
    }
    return {name: words for name, words in parts.items() if words}


def _condition(value: object) -> str:
    return value_words(value) if isinstance(value, float) else str(value)


def signs(stress: Stress) -> list[dict[str, Any]]:
    """The sign of every verdict and whether it occurs; ``fixed`` ones look the same in the dark."""
    seen = stress.count()
    return [
        {**sign._asdict(), "word": verdict.value, "fixed": sign.ink == WHITE, "occurs": bool(seen[verdict])}
        for verdict, sign in SIGNS.items()
    ]
