"""A stress test in words and tables, for the terminal, and as a page of stability maps."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from comparisons.trials.judging.limits import grouped
from comparisons.trials.judging.records import Error
from comparisons.trials.runs.files import STORE
from comparisons.trials.stress.campaign import Border, Line, Stress
from comparisons.trials.stress.cells import Cell, StressVerdict, axes
from reports.document.numbers import ABSENT, bound, error, printed, seconds
from reports.document.parts import (
    TABLES,
    Command,
    Facts,
    Fold,
    Mono,
    Page,
    PageLink,
    Paragraph,
    Part,
    Section,
    Table,
    TableCell,
    Widget,
    Words,
)
from reports.document.templates import plain, sentence, worded
from reports.document.terminal import Printed, Printout
from reports.records import blank_repeats, environment_facts

# The display of a stress test: signs of verdicts, values of axes, borders, errors beside their limits.


# An outcome that says nothing of how far an engine goes.
NOT_JUDGED = (StressVerdict.UNSUPPORTED, StressVerdict.UNAVAILABLE, StressVerdict.SUITE_ERROR)
WRONG_MOTIONS = (StressVerdict.CAUGHT, StressVerdict.MISSED)


class StressSign(NamedTuple):
    """The sign of a verdict, from ``signs.toml``, and its meaning in words.

    ``fill`` and ``ink`` are its colours on a page, ``terminal`` is a style of the terminal, "" for none.
    """

    symbol: str
    fill: str
    ink: str
    meaning: str
    terminal: str = ""


SIGNS: Mapping[StressVerdict, StressSign] = {
    StressVerdict(verdict): StressSign(*row) for verdict, row in TABLES["stress"].items()
}


def axis_title(name: str) -> str:
    """The title of an axis in words; raises KeyError for an unknown name."""
    return axes()[name].title


def value_words(value: float | None) -> str:
    """A value of an axis as text, to three digits: 1e-6, 0.0123, 200, 1e4; a dash for None."""
    if value is None:
        return ABSENT
    plain, short = printed(float(f"{value:.3g}")), bound(value)
    return short if len(short) + 1 < len(plain) and float(short) == float(plain) else plain


def border_words(border: Border) -> str:
    """The values beside a border, and what is beyond it, as text: "0.001, over limit at 7.2e-4"."""
    return f"{value_words(border.inside.value)}, {border.outside.verdict.value} at {value_words(border.outside.value)}"


def shown_verdicts(stress: Stress) -> tuple[StressVerdict, ...]:
    """The verdicts with a column, in their own order: all that occur, and always "caught" and "missed"."""
    count = stress.count()
    return tuple(verdict for verdict in StressVerdict if count[verdict] or verdict in WRONG_MOTIONS)


WHITE = "#fdfdfd"  # ink of a sign that looks the same in the dark
FLAGGED = "Flagged: "  # separates the fault from the checks' messages in a reason


def map_data(stress: Stress, axis: str) -> dict[str, Any]:
    """The map of one axis, by its name, JSON-ready, for its script and its figure.

    "values" are the columns' as texts, "blocks" the lines of each row; an empty one for an axis without cells.
    """
    known, values = axes()[axis], stress.columns[axis]
    rows = grouped((line[1], _line_data(stress, line, values)) for line in stress.lines if line[0] == axis)
    return {
        "axis": axis,
        "title": known.title,
        "about": known.about,
        "label": known.label,
        "easy": value_words(known.good),
        "values": [value_words(value) for value in values],
        "blocks": [{"row": row, "lines": lines} for row, lines in rows.items()],
    }


def _line_data(stress: Stress, line: Line, values: Sequence[float]) -> dict[str, Any]:
    """A line of the map, JSON-ready: engine, usage, cells (None without a run) at ``values``, and its borders.

    "bars" are the borders' columns, "border" has them in words.
    """
    cells = {result.value: _cell_data(result) for result in stress.lines[line]}
    borders = [border for border in stress.borders if border.inside.line == line]
    return {
        "engine": line[2],
        "usage": line[3],
        "cells": [cells.get(value) for value in values],
        "bars": [border_place(border, values) for border in borders],
        "border": "; ".join(map(border_words, borders)),
    }


def _cell_data(result: Cell) -> dict[str, Any]:
    """A cell of the map, JSON-ready: the index of its verdict in ``SIGNS``, its facts and its command."""
    sign = list(SIGNS).index(result.verdict)
    return {"verdict": sign, "story": cell_facts(result), "command": result.command}


def border_place(border: Border, values: Sequence[float]) -> int:
    """The index of the column, of those with these ``values``, rising or falling, whose left edge is the border."""
    low, high = border.ends
    between = math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high)
    rising = list(values) == sorted(values)
    return sum(value < between if rising else value > between for value in values)


def cell_facts(result: Cell) -> dict[str, str]:
    """The facts of a cell by heading: why it is wrong, what the checks flag, deviation, invariant, work, conditions.

    They are texts. Of a cell that is not wrong the first is "Reason", that of its verdict. Those without words are left
    out.
    """
    wrong, _, flagged = result.reason.partition(FLAGGED)
    parts = {
        "Wrong" if result.wrong else "Reason": wrong.rstrip(". "),
        "Flagged by the checks": flagged,
        "Worst deviation, over the peak": _error_and_limit(result.errors),
        "Worst invariant": _error_and_limit(result.invariants),
        "Work": f"{result.steps} steps in {seconds(result.seconds)}" if result.steps else "",
        "Conditions": "; ".join(f"{plain(name)} {_condition_text(value)}" for name, value in result.differing.items()),
    }
    return {name: words for name, words in parts.items() if words}


def _error_and_limit(errors: Sequence[Error]) -> str:
    """The first of the errors and its limit, over the peak, with the quantity's name, as text; "" without any."""
    return "".join(f"{worded(row.quantity)} {error(row.error_max)}, limit {bound(row.limit)}" for row in errors[:1])


def _condition_text(value: object) -> str:
    """The value of a condition as text, a float to three digits."""
    return value_words(value) if isinstance(value, float) else str(value)


def verdict_symbols(stress: Stress) -> list[dict[str, Any]]:
    """The symbol, colours, meaning and word of every verdict for the map's script, JSON-ready.

    "fixed" is one whose ink stays in the dark, "occurs" one that a cell has.
    """
    seen = stress.count()
    return [
        {**sign._asdict(), "word": verdict.value, "fixed": sign.ink == WHITE, "occurs": bool(seen[verdict])}
        for verdict, sign in SIGNS.items()
    ]


# The summary and the tables of a stress test, for pages and the terminal.

LOUD = (StressVerdict.MISSED, StressVerdict.ALARM)
FAULTS = [verdict for verdict in StressVerdict if verdict not in (StressVerdict.WITHIN, *NOT_JUDGED)]
MOST_ALONE = 40  # incidents of one verdict that a table has row by row
INCIDENT = ("engine", "axis: row", "value", "usage", "reason", "command")
RANKED = "tuned"  # the setting by which engines are ranked


def summary(stress: Stress, macro: str) -> str:
    """The sentences of a ``macro`` of sentences.txt on runs, wrong motions flagged and missed, and false alarms."""
    count = stress.count()
    caught, missed, alarms = (count[verdict] for verdict in (*WRONG_MOTIONS, StressVerdict.ALARM))
    extent = {"cells": len(stress.results), "axes": len(stress.axes), "quick": stress.document["quick"]}
    counts = {"wrong": caught + missed, "caught": caught, "missed": missed, "alarms": alarms}
    return sentence(macro, facts={**extent, **counts})


def ranking(stress: Stress) -> str:
    """A sentence on how many cells of each engine are within limit, the best engine first; "" where none is judged.

    These are cells of the tuned setting where there are any, without those of the bisections, which all lie where an
    engine fails.
    """
    cells = [result for result in stress.results if result.value in stress.columns[result.axis]]
    tuned = [cell for cell in cells if cell.setting == RANKED]
    count = Counter((result.engine, result.verdict is StressVerdict.WITHIN) for result in tuned or cells
                    if result.verdict not in NOT_JUDGED)  # fmt: skip
    engines = [(name, count[name, True], count[name, True] + count[name, False]) for name in stress.engines]
    ranked = sorted((engine for engine in engines if engine[2]), key=lambda row: -row[1] / row[2])
    return sentence("stress_ranking", engines=ranked, setting=RANKED if tuned else "") if ranked else ""


def verdict_facts(stress: Stress) -> Facts:
    """The number of cells and its meaning, in words, by verdict: those that occur, and always "caught" and "missed"."""
    count = stress.count()
    return Facts(
        tuple(
            (f"{SIGNS[verdict].symbol} {verdict.value}", f"{count[verdict]}: {SIGNS[verdict].meaning}")
            for verdict in shown_verdicts(stress)
        )
    )


def count_table(stress: Stress, name: Callable[[str], Words], caption: str = "") -> Table:
    """A table of verdict counts: axes, called by ``name``, down and engines across, with a row for all of several axes.

    ``name`` gets an axis's name and returns its words.
    """
    rows: list[tuple[Words | TableCell, ...]] = [
        (name(axis), *(_compact(stress.count(engine, axis)) for engine in stress.engines)) for axis in stress.axes
    ]
    if len(stress.axes) > 1:
        rows.append(("all", *(_compact(stress.count(engine)) for engine in stress.engines)))
    return Table(caption, ("axis", *stress.engines), tuple(rows), align="l")


def _compact(count: Counter[StressVerdict]) -> TableCell:
    """Counts of verdicts as one cell, ``12✓ 3○ 2!``; missed motions and false alarms give it their colour.

    Its style is "failed" for these, "pass" where some cells are within the limit and no engine or check was at fault,
    else "".
    """
    text = " ".join(f"{count[verdict]}{SIGNS[verdict].symbol}" for verdict in StressVerdict if count[verdict])
    loud = next((SIGNS[verdict].terminal for verdict in LOUD if count[verdict]), "")
    fine = count[StressVerdict.WITHIN] and not any(count[fault] for fault in FAULTS)
    return TableCell(text, style="failed" if loud else ("pass" if fine else ""), colour=loud)


def border_table(stress: Stress, name: Callable[[str], str]) -> Table:
    """A table with a row per border; repeated cells are blank. ``name`` makes of an axis's name its title."""
    rows = blank_repeats(
        ((name(border.inside.axis), *border.inside.line[1:],
          TableCell(border_words(border), colour=SIGNS[border.outside.verdict].terminal))
         for border in stress.borders), heads=4)  # fmt: skip
    return Table("", ("axis", "row", "engine", "usage", "last within, first beyond"), tuple(rows), align="l")


def incident_table(results: Iterable[Cell]) -> Table:
    """A table with a row per cell, its reason and its command, by engine.

    Of more than 40 cells only the first of each axis and engine is shown, with the number of the others.
    """
    cell_results = sorted(results, key=lambda result: result.engine)
    is_long = len(cell_results) > MOST_ALONE
    groups = grouped(((result.engine, result.axis) if is_long else result.key, result) for result in cell_results)
    rows = tuple(_incident_row(first, len(others)) for first, *others in groups.values())
    return Table("", INCIDENT, rows, align="llrl", style="incidents")


def _incident_row(cell: Cell, others: int) -> tuple[TableCell | Words, ...]:
    """The cells of a cell's row: engine, place, value, setting, reason, command.

    Its note has the number of ``others`` of its axis that are not listed.
    """
    place = TableCell(f"{axis_title(cell.axis)}: {cell.row}", note=f"and {others} more on this axis" if others else "")
    return (cell.engine, place, value_words(cell.value), cell.setting, cell.reason, Mono(cell.command))


# The stress maps for a terminal: verdicts by engine and axis, borders, and every cell that was missed or an alarm.


def printout(stress: Stress) -> Printout:
    """The printed maps: counts, borders, missed motions and false alarms, then the summary; each cell if verbose."""
    key = "  ".join(f"{SIGNS[verdict].symbol} {verdict.value}" for verdict in shown_verdicts(stress))
    parts: list[Printed] = [count_table(stress, str), Paragraph(key, colour="dim"), ""]
    parts += [border_table(stress, str), ""] if stress.borders else []
    parts += [_incident_line(result) for result in stress.of(*LOUD)]
    return Printout(
        parts,
        [f"{summary(stress, 'stress_scope')} {summary(stress, 'stress_outcome')}"],
        [*map(cell_details, stress.results), ""],
    )


def _incident_line(cell: Cell) -> Paragraph:
    """A cell's verdict, place and reason, and in a second line the command that repeats it, in the verdict's colour."""
    place = f"{axis_title(cell.axis)}, {cell.row}, {value_words(cell.value)}, {cell.engine} {cell.setting}"
    text = f"{cell.verdict.value}: {place}: {cell.reason}\n  {cell.command}"
    return Paragraph(text, colour=SIGNS[cell.verdict].terminal)


def cell_details(result: Cell) -> str:
    """The details of a cell as text: its key and verdict, then an indented line for each fact."""
    facts = (f"{name}: {words}" for name, words in cell_facts(result).items())
    return "\n  ".join([f"{result.key}: {result.verdict.value}", *facts])


# The stability page: the verdict, the maps, their borders, and every incident with the command that repeats it.

LINK = PageLink("Stability", "stress.html")
# What stands open on the page unless its table is long; what was caught, as it should be, is folded away.
OPEN = (*LOUD, StressVerdict.SUITE_ERROR, StressVerdict.CRASHED, StressVerdict.ADAPTER_ERROR)
MOST_OPEN = 12


def page(stress: Stress) -> Page:
    """The page of a stress test: verdict and ranking, counts, maps, incidents, what was run."""
    lead = (
        Paragraph(summary(stress, "stress_verdict"), "verdict"),
        Paragraph(ranking(stress), "lead"),
        Paragraph(summary(stress, "stress_scope"), "small"),
    )
    caption = sentence("stress_counts")
    by_axis = count_table(stress, lambda axis: PageLink(axis_title(axis), f"#map-{axis}"), caption)
    return Page(
        LINK.href,
        LINK.text,
        "Where each engine fails",
        sentence("stress_subtitle"),
        lead,
        (
            Section("counts", "What the cells came to", (verdict_facts(stress), by_axis)),
            _maps(stress),
            Section("incidents", "Incidents", (Paragraph(sentence("stress_incidents")), *_incidents(stress))),
            _run_section(stress),
        ),
    )


def _maps(stress: Stress) -> Section:
    """The section of the maps: the interactive map of the axes and the table of borders, if there are any."""
    maps = {axis: map_data(stress, axis) for axis in stress.axes}
    first, *others = maps
    data = {
        "axes": {axis: table["title"] for axis, table in maps.items()},
        "signs": verdict_symbols(stress),
        "map": maps[first],
    }
    widget = Widget("maps", "maps", "Stability map of one axis", data, {axis: maps[axis] for axis in others})
    borders = border_table(stress, axis_title)
    fold = Fold(f"Borders, found by bisection ({len(borders.rows)})", (borders,))
    return Section("maps", "Maps", (Paragraph(sentence("stress_maps")), widget, *([fold] if borders.rows else [])))


def _incidents(stress: Stress) -> Iterator[Part]:
    """Yield a folded table of cells for each verdict of ``OPEN`` and for "caught", then a sentence on those with none.

    A table of a verdict of ``OPEN`` is unfolded if it has twelve rows at most.
    """
    cells = {stress_verdict: stress.of(stress_verdict) for stress_verdict in (*OPEN, StressVerdict.CAUGHT)}
    for verdict, results in cells.items():
        if results:
            table, words = (
                incident_table(results),
                f"{verdict.value.capitalize()} ({len(results)}): {SIGNS[verdict].meaning}",
            )
            yield Fold(words, (table,), is_open=verdict in OPEN and len(table.rows) <= MOST_OPEN)
    if absent := [stress_verdict.value for stress_verdict, cell_results in cells.items() if not cell_results]:
        yield Paragraph(f"None: {', '.join(absent)}.")


def _run_section(stress: Stress) -> Section:
    """The section on what was run, where and at what cost."""
    spent = sum(result.spent for result in stress.results)
    cells = ("Cells", f"{len(stress.results)}, {spent:.0f} s of work in all, each a run in {STORE}")
    facts = Facts((*environment_facts(stress.document["environment"]), cells))
    where = Fold("Where and with what", (facts,))
    return Section("run", "What was run", (Command(stress.document["command"]), where))
