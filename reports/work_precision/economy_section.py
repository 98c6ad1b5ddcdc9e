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

from comparisons.work_precision.economy_records import AngleCost, Economy, RunCost
from engines.contract import Outcome
from reports.text.numbers import figure, seconds

TEMPLATES = Path(__file__).parents[1] / "templates"
TITLE = "What leaving things out saves"
ABOUT = (
    "Nothing is built, recorded or worked out that a scene does not need, and the suite's tests count it. Here is what "
    "that is worth: whole scenes beside the same scenes with less in them."
)
RUNS = (
    *("engine", "scene", "least", "median", "of whole", "stepping"),
    *("steps", "numbers", "bodies", "conditions", "loads"),
)
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


def cost_tables(economy: Economy) -> tuple[CostTable, ...]:
    """One table for the engines by mechanism, then one for the closed form by mechanism and path, as measured."""
    runs = [_run_table(list(part)) for _, part in groupby(economy.runs, key=_mechanism)]
    return (*runs, *(_angle_table(list(part)) for _, part in groupby(economy.angles, key=_evaluated)))


def _mechanism(cost: RunCost | AngleCost) -> tuple[str, str]:
    return cost.mechanism, cost.variant


def _evaluated(cost: AngleCost) -> tuple[str, str, str]:
    return (*_mechanism(cost), cost.path)


def _run_table(costs: Sequence[RunCost]) -> CostTable:
    first, whole = costs[0], {cost.engine: cost for cost in reversed(costs)}
    lead = (
        f"Time of {first.mechanism} ({first.variant}) brought to speed, {first.setting}, from checking the scene to "
        f"reading the motion out: least and median of {len(first.seconds)} runs of every scene made in turn, the least "
        "over that of the whole scene, and the least that stepping alone took."
    )
    told = dict.fromkeys(f"{cost.reduction}: {cost.about}" for cost in costs)
    failed = dict.fromkeys(f" {cost.engine}, {cost.reduction}: {cost.reason}." for cost in costs if cost.reason)
    note = (
        f"{'; '.join(told)}. Steps and numbers recorded are the engine's; bodies, conditions (equations of joints and "
        f"drive) and loads the scene's.{''.join(failed)}"
    )
    return CostTable(lead, note, RUNS, tuple(_run_row(cost, whole[cost.engine]) for cost in costs), words=2)


def _run_row(cost: RunCost, whole: RunCost) -> tuple[str, ...]:
    counts = (cost.bodies, cost.conditions, cost.loads)
    if cost.outcome != Outcome.FINISHED:
        return (cost.engine, cost.reduction, cost.outcome, *[""] * 5, *map(str, counts))
    times = (*map(seconds, _two(cost)), _share(cost, whole), seconds(min(cost.stepping)))
    return (cost.engine, cost.reduction, *times, *map(str, (cost.steps, cost.values, *counts)))


def _angle_table(costs: Sequence[AngleCost]) -> CostTable:
    first = costs[0]
    lead = (
        f"Time of the closed form of {first.mechanism} ({first.variant}) per crank angle, {PATHS[first.path]}: least "
        f"and median of {len(first.seconds)} evaluations at {first.angles} angles of every question put in turn, and "
        "the least over that of the first."
    )
    note = f"{first.reduction}: {', '.join(first.quantities)}."
    return CostTable(lead, note, ANGLES, tuple(_angle_row(cost, first) for cost in costs), words=1)


def _angle_row(cost: AngleCost, whole: AngleCost) -> tuple[str, ...]:
    each = (f"{figure(spent / cost.angles * 1e9, 3)} ns" for spent in _two(cost))
    return (cost.reduction, *each, _share(cost, whole))


def _two(cost: RunCost | AngleCost) -> tuple[float, float]:
    return min(cost.seconds), statistics.median(cost.seconds)


def _share(cost: RunCost | AngleCost, whole: RunCost | AngleCost) -> str:
    return f"{100.0 * min(cost.seconds) / min(whole.seconds):.0f} %"


def fragment(economy: Economy) -> Markup:
    """The section's HTML, heading and tables, as the page has it."""
    return Markup(_template().render(title=TITLE, about=ABOUT, tables=cost_tables(economy)))


@cache
def _template() -> jinja2.Template:
    loader = jinja2.FileSystemLoader(TEMPLATES)
    environment = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("economy.html")


def markdown(economy: Economy) -> str:
    """The section in Markdown."""
    parts = [f"## {TITLE}", ABOUT]
    for table in cost_tables(economy):
        rule = ["---"] * table.words + ["---:"] * (len(table.head) - table.words)
        rows = "\n".join(f"| {' | '.join(line)} |" for line in (table.head, rule, *table.rows))
        parts += [table.lead, rows, table.note]
    return "\n\n".join(parts) + "\n"


def terminal(economy: Economy) -> Group:
    """The section for a terminal of 100 columns."""
    return Group(*(part for table in cost_tables(economy) for part in (Text(table.lead), _lines(table), Text(""))))


def _lines(table: CostTable) -> Table:
    shown = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0))
    for number, name in enumerate(table.head):
        shown.add_column(name, justify="left" if number < table.words else "right", no_wrap=True)
    for row in table.rows:
        shown.add_row(*map(Text, row))
    return shown
