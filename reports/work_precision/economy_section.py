"""The cost of a whole scene beside those of scenes with less in them: for the page, RESULTS.md and the terminal."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from pathlib import Path

import jinja2
from markupsafe import Markup
from rich.console import Group
from rich.table import Table
from rich.text import Text

from comparisons.work_precision.records import Cost
from engines.contract import Outcome
from reports.text.numbers import figure, seconds

TEMPLATES = Path(__file__).parents[1] / "templates"
TITLE = "What each output and load costs"
ABOUT = (
    "Nothing is built, recorded or worked out that a scene does not need, and the suite's tests count it. Here is what "
    "that is worth: whole scenes beside the same scenes with less in them."
)
RUNS = ("engine", "scene", "least", "median", "of whole", "stepping", "steps")
PATHS = {"numpy": "by NumPy", "compiled": "by the compiled path"}
ANGLES = ("asked for", "least", "median", "of whole")


@dataclass(frozen=True)
class CostTable:
    """A table ready to be printed; its first ``words`` columns are words, the others figures.

    ``lead`` stands before it, ``note`` in small print after it.
    """

    lead: str
    note: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: int


def cost_tables(costs: Sequence[Cost]) -> tuple[CostTable, ...]:
    """One table for the engines, then one for the closed form by each path, as measured."""
    runs = [cost for cost in costs if not cost.angles]
    queries = groupby([cost for cost in costs if cost.angles], key=lambda cost: cost.solver)
    return (*([_run_table(runs)] if runs else []), *(_query_table(list(part)) for _, part in queries))


def _run_table(costs: Sequence[Cost]) -> CostTable:
    first, whole = costs[0], {cost.solver: cost for cost in reversed(costs)}
    lead = (
        f"Time of {first.mechanism} ({first.variant}) brought to speed, tuned, from checking the scene to "
        f"reading the motion out: least and median of {len(first.seconds)} runs of every scene made in turn, the least "
        "over that of the whole scene, and the least that stepping alone took."
    )
    told = dict.fromkeys(f"{cost.reduction}: {cost.about}" for cost in costs)
    failed = dict.fromkeys(f" {cost.solver}, {cost.reduction}: {cost.reason}." for cost in costs if cost.reason)
    note = f"{'; '.join(told)}.{''.join(failed)}"
    return CostTable(lead, note, RUNS, tuple(_run_row(cost, whole[cost.solver]) for cost in costs), words=2)


def _run_row(cost: Cost, whole: Cost) -> tuple[str, ...]:
    if cost.outcome != Outcome.FINISHED:
        return (cost.solver, cost.reduction, cost.outcome, "", "", "", "")
    times = (*map(seconds, _two(cost)), _share(cost, whole), seconds(min(cost.stepping)))
    return (cost.solver, cost.reduction, *times, str(cost.steps))


def _query_table(costs: Sequence[Cost]) -> CostTable:
    first = costs[0]
    lead = (
        f"Time of the closed form of {first.mechanism} ({first.variant}) per crank angle, {PATHS[first.solver]}: least "
        f"and median of {len(first.seconds)} evaluations at {first.angles} angles of every question put in turn, and "
        "the least over that of the first."
    )
    note = f"{first.reduction}: {first.about}."
    return CostTable(lead, note, ANGLES, tuple(_query_row(cost, first) for cost in costs), words=1)


def _query_row(cost: Cost, whole: Cost) -> tuple[str, ...]:
    each = (f"{figure(spent / cost.angles * 1e9, 3)} ns" for spent in _two(cost))
    return (cost.reduction, *each, _share(cost, whole))


def _two(cost: Cost) -> tuple[float, float]:
    return min(cost.seconds), statistics.median(cost.seconds)


def _share(cost: Cost, whole: Cost) -> str:
    return f"{100.0 * min(cost.seconds) / min(whole.seconds):.0f} %"


def fragment(costs: Sequence[Cost]) -> Markup:
    """The section's HTML, heading and tables, as the page has it."""
    return Markup(_template().render(title=TITLE, about=ABOUT, tables=cost_tables(costs)))


@cache
def _template() -> jinja2.Template:
    loader = jinja2.FileSystemLoader(TEMPLATES)
    environment = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("economy.html")


def markdown(costs: Sequence[Cost]) -> str:
    """The section in Markdown."""
    parts = [f"## {TITLE}", ABOUT]
    for table in cost_tables(costs):
        rule = ["---"] * table.words + ["---:"] * (len(table.head) - table.words)
        rows = "\n".join(f"| {' | '.join(line)} |" for line in (table.head, rule, *table.rows))
        parts += [table.lead, rows, table.note]
    return "\n\n".join(parts) + "\n"


def terminal(costs: Sequence[Cost]) -> Group:
    """The section for a terminal of 100 columns."""
    return Group(*(part for table in cost_tables(costs) for part in (Text(table.lead), _lines(table), Text(""))))


def _lines(table: CostTable) -> Table:
    shown = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0))
    for number, name in enumerate(table.head):
        shown.add_column(name, justify="left" if number < table.words else "right", no_wrap=True)
    for row in table.rows:
        shown.add_row(*map(Text, row))
    return shown
