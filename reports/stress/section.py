"""Where each engine fails: the tables and the summary of a stress test, for pages and the terminal; draws nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from markupsafe import Markup

from comparisons.stress.border import Border
from comparisons.stress.cells import CellResult
from comparisons.stress.verdict import StressVerdict
from reports.document.numbers import ABSENT
from reports.document.tables import ReportTable
from reports.document.templates import render, sentence
from reports.stress.facts import (
    APART,
    SIGNS,
    SILENT,
    Line,
    Stress,
    axis_title,
    shown_verdicts,
    value_words,
)

TITLE = "Where each engine fails"


def summary(stress: Stress) -> str:
    """What it all comes to, in one paragraph."""
    caught, missed, alarms = (stress.count()[verdict] for verdict in (*SILENT, StressVerdict.ALARM))
    quick, sizes = stress.document.get("quick"), {"cells": len(stress.results), "axes": len(stress.axes)}
    wrong = caught + missed
    return sentence("stress_summary", **sizes, wrong=wrong, caught=caught, missed=missed, alarms=alarms, quick=quick)


def verdict_table(stress: Stress) -> ReportTable:
    """Cells by engine and verdict; that none is missed is the claim."""
    shown = shown_verdicts(stress)
    names = [*stress.engines, *([""] if len(stress.engines) > 1 else [])]
    counts = [(name or "all", stress.count(name)) for name in names]
    return ReportTable(
        "Cells of every engine by verdict. Missed: a wrong motion that no check flagged; there must be none.",
        ("engine", *(f"{SIGNS[verdict].symbol} {verdict.value}" for verdict in shown), "cells"),
        tuple((name, *(str(count[one]) for one in shown), str(count.total())) for name, count in counts),
        bold=1 + shown.index(StressVerdict.MISSED),
    )


def border_table(stress: Stress, names: Iterable[str] = ()) -> ReportTable:
    """How far each line goes, engines side by side; of these axes, of all if none is named."""
    chosen = tuple(names)
    kept = [line for line in stress.lines if not chosen or line[0] in chosen]
    engines = [name for name in stress.engines if any(line[2] == name for line in kept)]
    places = list(dict.fromkeys((axis, row, usage) for axis, row, _, usage in kept))
    rows = [
        (axis_title(axis), row, usage, *(reach(stress, (axis, row, engine, usage)) for engine in engines))
        for axis, row, usage in sorted(places, key=lambda one: (stress.axes.index(one[0]), _order(kept, one)))
    ]
    first = 1 if len(chosen) == 1 else 0  # the axis goes without saying
    head = ("axis", "row", "usage", *engines)[first:]
    return ReportTable(
        "The last value within the limit, then the first beyond it and what it is there; found by bisection.",
        head,
        tuple(row[first:] for row in rows),
        align="l",
    )


def _order(lines: Sequence[Line], place: tuple[str, str, str]) -> tuple[int, int]:
    """Rows in their order, usages in theirs within a row, whichever engine has them."""
    rows = list(dict.fromkeys(line[1] for line in lines if line[0] == place[0]))
    usages = list(dict.fromkeys(line[3] for line in lines if line[0] == place[0]))
    return rows.index(place[1]), usages.index(place[2])


def reach(stress: Stress, line: Line) -> str:
    """How far a line goes: its borders, or that it has none."""
    cells = [one for one in stress.lines.get(line, ()) if one.verdict not in APART]
    if not cells:
        return ABSENT
    borders = stress.line_borders.get(line, ())
    if borders:
        return "; ".join(border_words(border) for border in borders)
    within = [one.verdict is StressVerdict.WITHIN for one in cells]
    return "all within" if all(within) else ("not narrowed down" if any(within) else _nowhere(cells))


def _nowhere(cells: Sequence[CellResult]) -> str:
    seen = list(dict.fromkeys(one.verdict.value for one in cells))
    return f"none within: {', '.join(seen)}"


def border_words(border: Border) -> str:
    """``0.001, over limit at 7.2e-4``."""
    return f"{value_words(border.inside)}, {border.verdict.value} at {value_words(border.outside)}"


def section(stress: Stress, *, with_borders: bool = True) -> Markup:
    """The section's HTML, heading and tables, as a page has it; the long table of borders folded away."""
    return render(
        "study_section.html",
        title=TITLE,
        about=summary(stress),
        tables=[verdict_table(stress)],
        borders=border_table(stress) if with_borders else None,
    )
