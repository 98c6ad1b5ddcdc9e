"""Where every engine stops being right: what the stress maps come to, for pages, RESULTS.md and the terminal.

Needs no engine and draws nothing: a saved stress test is read and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import jinja2
from markupsafe import Markup

from comparisons.stress.cells import CellResult
from comparisons.stress.long_run import LEAST
from comparisons.stress.verdict import StressVerdict
from reports.stress.facts import (
    APART,
    FILE,
    SILENT,
    SYMBOLS,
    Border,
    Line,
    Stress,
    axis_title,
    load,
    shown_verdicts,
    value_words,
)
from reports.text.numbers import ABSENT, error, figure

__all__ = ["FILE", "TITLE", "Stress", "fragment", "load", "markdown", "summary"]
TEMPLATES = Path(__file__).parents[1] / "templates"
TITLE = "Where every engine stops being right"


@dataclass(frozen=True)
class Table:
    """A table ready to be printed: ``words`` columns of words, then figures; the column ``loud`` is bold."""

    lead: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: int
    loud: int | None = None


def summary(stress: Stress) -> str:
    """What it all comes to, in one paragraph."""
    count = stress.count()
    wrong = sum(count[verdict] for verdict in SILENT)
    kind = "a quick map" if stress.document.get("quick") else "full maps"
    return (
        f"Each engine is driven from where a problem is easy to where it gives way: {_of(len(stress.results), 'cell')} "
        f"on {_of(len(stress.axes), 'axis', 'axes')}, {kind}, each run in a process of its own and held against the "
        f"closed form. {_of(wrong, 'run')} said finished with a wrong motion; invariants that know no closed form "
        f"caught {count[StressVerdict.CAUGHT]} and missed {count[StressVerdict.MISSED]}. They raised "
        f"{_of(count[StressVerdict.ALARM], 'alarm')} at a motion within every limit."
    )


def _of(count: int, name: str, many: str = "") -> str:
    return f"{count} {name if count == 1 else many or name + 's'}"


def verdict_table(stress: Stress) -> Table:
    """Cells by engine and verdict; that none is missed is the claim."""
    shown = shown_verdicts(stress)
    names = [*stress.engines, *([""] if len(stress.engines) > 1 else [])]
    counts = [(name or "all", stress.count(name)) for name in names]
    return Table(
        "Cells of every engine by verdict. Missed is a wrong motion that nothing of ours saw: none may be.",
        ("engine", *(f"{SYMBOLS[verdict]} {verdict.value}" for verdict in shown), "cells"),
        tuple((name, *(str(count[one]) for one in shown), str(count.total())) for name, count in counts),
        words=1,
        loud=1 + shown.index(StressVerdict.MISSED),
    )


def border_table(stress: Stress, names: Iterable[str] = ()) -> Table:
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
    return Table(
        "The last value within the limit, then the first beyond it and what it is there; found by bisection.",
        head,
        tuple(row[first:] for row in rows),
        words=len(head),
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
    beyond = f"{border.verdict.value} at {value_words(border.outside)}"
    return beyond if border.inside is None else f"{value_words(border.inside)}, {beyond}"


def long_run_table(stress: Stress) -> Table | None:
    """First against last turn, if it was measured."""
    if not stress.long_runs:
        return None
    return Table(
        "Long driven runs, first turn against last: the widest joint gap over the shortest link, the torque's largest "
        "error over its peak.",
        ("mechanism", "engine", "setting", "outcome", "turns",
         "gap, first", "last", "ratio", "torque error, first", "last", "ratio"),
        tuple(
            (run.mechanism, run.engine, run.setting, run.outcome, value_words(run.turns),
             error(run.gap_first), error(run.gap_last), _ratio(run.gap_last, run.gap_first),
             error(run.torque_first), error(run.torque_last), _ratio(run.torque_last, run.torque_first))
            for run in stress.long_runs
        ),
        words=4,
    )  # fmt: skip


def _ratio(last: float | None, first: float | None) -> str:
    """Growth; an error below rounding counts as rounding."""
    if last is None or first is None:
        return ABSENT
    return figure(max(last, LEAST) / max(first, LEAST), 2)


def fragment(stress: Stress, *, with_borders: bool = True) -> Markup:
    """The section's HTML, heading and tables, as a page has it; the long table of borders folded away."""
    return Markup(
        templates()
        .get_template("stress_section.html")
        .render(
            title=TITLE,
            about=summary(stress),
            verdicts=verdict_table(stress),
            long_runs=long_run_table(stress),
            borders=border_table(stress) if with_borders else None,
        )
    )


@cache
def templates() -> jinja2.Environment:
    """The templates of the stress maps."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def markdown(stress: Stress) -> str:
    """The section in Markdown."""
    parts = [f"## {TITLE}", summary(stress)]
    for table in (verdict_table(stress), long_run_table(stress), border_table(stress)):
        parts += [table.lead, _markdown_table(table)] if table else []
    return "\n\n".join(parts) + "\n"


def _markdown_table(table: Table) -> str:
    rule = ["---" if number < table.words else "---:" for number in range(len(table.head))]
    rows = [[f"**{cell}**" if n == table.loud else cell for n, cell in enumerate(row)] for row in table.rows]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |" for cells in (table.head, rule, *rows)
    )
