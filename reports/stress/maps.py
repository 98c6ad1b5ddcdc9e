"""A stability map as data: a block to each row of an axis, a line to each engine and usage, a cell to each value."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from comparisons.judging.limits import grouped
from comparisons.judging.records import QuantityRecord
from comparisons.stress.campaign import Border, Line, Stress
from comparisons.stress.cells import axes
from comparisons.stress.verdict import CellResult, StressVerdict
from reports.document.numbers import ABSENT, bound, error, printed, seconds
from reports.document.parts import TABLES
from reports.document.templates import plain, worded

# The display of a stress test: signs of verdicts, values of axes, borders, errors beside their limits.


# An outcome that says nothing of how far an engine goes.
NOT_JUDGED = (StressVerdict.UNSUPPORTED, StressVerdict.UNAVAILABLE, StressVerdict.SUITE_ERROR)
WRONG_MOTIONS = (StressVerdict.CAUGHT, StressVerdict.MISSED)


class StressSign(NamedTuple):
    """The sign of a verdict, from ``signs.toml``, and its meaning."""

    symbol: str
    fill: str
    ink: str
    meaning: str
    terminal: str = ""


SIGNS: Mapping[StressVerdict, StressSign] = {
    StressVerdict(verdict): StressSign(*row) for verdict, row in TABLES["stress"].items()
}


def axis_title(name: str) -> str:
    """An axis in words."""
    return axes()[name].title


def value_words(value: float | None) -> str:
    """A value of an axis to three digits: 1e-6, 0.0123, 200, 1e4."""
    if value is None:
        return ABSENT
    plain, short = printed(float(f"{value:.3g}")), bound(value)
    return short if len(short) + 1 < len(plain) and float(short) == float(plain) else plain


def border_words(border: Border) -> str:
    """``0.001, over limit at 7.2e-4``."""
    return f"{value_words(border.inside)}, {border.verdict.value} at {value_words(border.outside)}"


def shown_verdicts(stress: Stress) -> tuple[StressVerdict, ...]:
    """The verdicts with a column: all that occur, and always "missed"."""
    count = stress.count()
    return tuple(verdict for verdict in StressVerdict if count[verdict] or verdict in WRONG_MOTIONS)


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
    return {"verdict": sign, "story": cell_facts(result), "command": result.cell.command}


def border_place(border: Border, values: Sequence[float]) -> int:
    """The column that a border stands left of."""
    low, high = sorted((border.inside, border.outside))
    between = math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high)
    rising = list(values) == sorted(values)
    return sum(value < between if rising else value > between for value in values)


def cell_facts(result: CellResult) -> dict[str, str]:
    """The facts of a cell by heading: why it is wrong, what the checks flag, deviation, invariant, work, conditions."""
    wrong, _, flagged = result.reason.partition(FLAGGED)
    parts = {
        "Wrong" if result.wrong else "Reason": wrong.rstrip(". "),
        "Flagged by the checks": flagged,
        "Worst deviation, over the peak": _error_and_limit(result.nearest),
        "Worst invariant": _error_and_limit(result.worst_check),
        "Work": f"{result.steps} steps in {seconds(result.seconds)}" if result.steps else "",
        "Conditions": "; ".join(f"{plain(name)} {_condition_text(value)}" for name, value in result.differing.items()),
    }
    return {name: words for name, words in parts.items() if words}


def _error_and_limit(record: QuantityRecord | None) -> str:
    """An error and its limit, both over the peak, with the name of its quantity; empty without a record."""
    if record is None:
        return ""
    return f"{worded(record.quantity)} {error(record.error_max)}, limit {bound(record.limit)}"


def _condition_text(value: object) -> str:
    return value_words(value) if isinstance(value, float) else str(value)


def verdict_symbols(stress: Stress) -> list[dict[str, Any]]:
    """Symbol, colours and word of every verdict, whether it ``occurs``, and dark pages leave it ``fixed``."""
    seen = stress.count()
    return [
        {**sign._asdict(), "word": verdict.value, "fixed": sign.ink == WHITE, "occurs": bool(seen[verdict])}
        for verdict, sign in SIGNS.items()
    ]
