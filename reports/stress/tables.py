"""Where each engine fails: the summary and the tables of a stress test, for pages and the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from comparisons.stress.cells import CellResult
from comparisons.stress.saved import Line, Stress
from comparisons.stress.verdict import StressVerdict
from reports.document.numbers import ABSENT
from reports.document.parts import Cell, Mono, Table, Words
from reports.document.templates import sentence
from reports.stress.facts import (
    APART,
    SIGNS,
    SILENT,
    axis_title,
    border_words,
    shown_verdicts,
    value_words,
)

LOUD = (StressVerdict.MISSED, StressVerdict.ALARM)
FAULTS = [verdict for verdict in StressVerdict if verdict not in (StressVerdict.WITHIN, *APART)]
MOST_ALONE = 40  # incidents of one verdict that a table has row by row
RANKED = "tuned"  # the setting by which engines are ranked


def summary(stress: Stress) -> str:
    """What it all comes to, in one paragraph."""
    return f"{scope(stress)} {sentence('stress_outcome', **_wrong(stress))}"


def scope(stress: Stress) -> str:
    """What was run, in a sentence."""
    quick, sizes = stress.document.get("quick"), {"cells": len(stress.results), "axes": len(stress.axes)}
    return sentence("stress_scope", **sizes, quick=quick)


def verdict(stress: Stress) -> str:
    """The test in a sentence: wrong motions that were flagged and missed, and false alarms."""
    return sentence("stress_verdict", **_wrong(stress))


def _wrong(stress: Stress) -> dict[str, int]:
    caught, missed, alarms = (stress.count()[verdict] for verdict in (*SILENT, StressVerdict.ALARM))
    return {"wrong": caught + missed, "caught": caught, "missed": missed, "alarms": alarms}


def ranking(stress: Stress) -> str:
    """How many cells are within limit, the best engine first, in a sentence.

    These are cells of the tuned setting where there are any, without those of the bisections, which all lie where an
    engine fails.
    """
    listed = [one for one in stress.results if one.cell.value in stress.columns[one.cell.axis]]
    tuned = [one for one in listed if one.cell.usage == RANKED]
    engines = [(name, *_within(tuned or listed, name)) for name in stress.engines]
    ranked = sorted((one for one in engines if one[2]), key=lambda one: -one[1] / one[2])
    return sentence("stress_ranking", engines=ranked, setting=RANKED if tuned else "") if ranked else ""


def _within(results: Iterable[CellResult], engine: str) -> tuple[int, int]:
    """How many cells of an engine are within limit, of how many that it accepts."""
    own = [one.verdict for one in results if one.cell.engine == engine and one.verdict not in APART]
    return own.count(StressVerdict.WITHIN), len(own)


def verdict_table(stress: Stress) -> Table:
    """Cells by verdict and engine; that none is missed is the claim."""
    counts = [stress.count(name) for name in (*stress.engines, *([""] if len(stress.engines) > 1 else []))]
    rows: tuple[tuple[Cell | Words, ...], ...] = tuple(
        (Cell(f"{SIGNS[verdict].symbol} {verdict.value}", note=SIGNS[verdict].meaning),
         *(str(count[verdict]) for count in counts))
        for verdict in shown_verdicts(stress)
    )  # fmt: skip
    head = ("verdict", *stress.engines, *(["all"] if len(stress.engines) > 1 else []))
    total = ("cells", *(str(count.total()) for count in counts))
    return Table("Cells of every engine by verdict; none may be missed.", head, (*rows, total))


def count_table(stress: Stress, name: Callable[[str], Words], caption: str = "") -> Table:
    """A row to an axis, a column to an engine: how many cells came to what; ``name`` is how an axis is named."""
    rows: list[tuple[Words | Cell, ...]] = [
        (name(axis), *(_compact(stress.count(engine, axis)) for engine in stress.engines)) for axis in stress.axes
    ]
    if len(stress.axes) > 1:
        rows.append(("all", *(_compact(stress.count(engine)) for engine in stress.engines)))
    return Table(caption, ("axis", *stress.engines), tuple(rows), align="l")


def _compact(count: Counter[StressVerdict]) -> Cell:
    """``12✓ 3○ 2!``, in the colour of the worst."""
    text = " ".join(f"{count[verdict]}{SIGNS[verdict].symbol}" for verdict in StressVerdict if count[verdict])
    loud = next((SIGNS[verdict].terminal for verdict in LOUD if count[verdict]), "")
    fine = count[StressVerdict.WITHIN] and not any(count[one] for one in FAULTS)
    return Cell(text, style="failed" if loud else ("pass" if fine else ""), colour=loud)


def border_table(stress: Stress) -> Table:
    """How far each line goes, engines side by side."""
    places = dict.fromkeys((axis, row) for axis, row, _, _ in stress.lines)
    usages = {place: dict.fromkeys(line[3] for line in stress.lines if line[:2] == place) for place in places}
    rows = tuple(
        (axis_title(axis), row, usage, *(reach(stress, (axis, row, engine, usage)) for engine in stress.engines))
        for (axis, row), found in usages.items()
        for usage in found
    )
    caption = "The last value within the limit, then the first beyond it and what it is there; found by bisection."
    return Table(caption, ("axis", "row", "usage", *stress.engines), rows, align="l")


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


def incident_table(results: Iterable[CellResult]) -> Table:
    """A row per cell, with its reason and command; of many, the first of each axis and engine, with their number."""
    found = sorted(results, key=lambda one: one.cell.engine)
    groups: dict[object, list[CellResult]] = {}
    for one in found:
        key = one.cell if len(found) <= MOST_ALONE else (one.cell.engine, one.cell.axis)
        groups.setdefault(key, []).append(one)
    rows = tuple(_incident(group) for group in groups.values())
    return Table(
        "", ("engine", "axis: row", "value", "usage", "reason", "command"), rows, align="llrl", style="incidents"
    )


def _incident(group: Sequence[CellResult]) -> tuple[Cell | Words, ...]:
    cell = group[0].cell
    more = f"and {len(group) - 1} more on this axis" if len(group) > 1 else ""
    place = Cell(f"{axis_title(cell.axis)}: {cell.row}", note=more)
    reason = group[0].judgement.reason
    return (cell.engine, place, value_words(cell.value), cell.usage, reason, Mono(group[0].document["command"]))
