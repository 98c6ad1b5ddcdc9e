"""The cost of a whole scene beside those of scenes with less in them: for the page and the terminal."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from itertools import groupby

from markupsafe import Markup

from comparisons.work_precision.records import MeasuredCost
from engines.contract import Outcome
from reports.text.numbers import figure, seconds
from reports.text.tables import ReportTable
from reports.text.templates import render

TITLE = "What each output and load costs"
ABOUT = (
    "Nothing is built, recorded or worked out that a scene does not need, and the suite's tests count it. Here is what "
    "that is worth: whole scenes beside the same scenes with less in them."
)
RUNS = ("engine", "scene", "least", "median", "of whole", "stepping", "steps")
PATHS = {"numpy": "by NumPy", "compiled": "by the compiled path"}
ANGLES = ("asked for", "least", "median", "of whole")


def cost_tables(costs: Sequence[MeasuredCost]) -> tuple[ReportTable, ...]:
    """One table for the engines, then one for the closed form by each path, as measured."""
    runs = [cost for cost in costs if not cost.angles]
    queries = groupby([cost for cost in costs if cost.angles], key=lambda cost: cost.solver)
    return (*([_run_table(runs)] if runs else []), *(_query_table(list(part)) for _, part in queries))


def _run_table(costs: Sequence[MeasuredCost]) -> ReportTable:
    first, whole = costs[0], {cost.solver: cost for cost in reversed(costs)}
    lead = (
        f"Time of {first.mechanism} ({first.variant}) brought to speed, tuned, from checking the scene to "
        f"reading the motion out: least and median of {len(first.seconds)} runs of every scene made in turn, the least "
        "over that of the whole scene, and the least that stepping alone took."
    )
    told = dict.fromkeys(f"{cost.reduction}: {cost.about}" for cost in costs)
    failed = dict.fromkeys(f" {cost.solver}, {cost.reduction}: {cost.reason}." for cost in costs if cost.reason)
    note = f"{'; '.join(told)}.{''.join(failed)}"
    return ReportTable(lead, RUNS, tuple(_run_row(cost, whole[cost.solver]) for cost in costs), "llr", note)


def _run_row(cost: MeasuredCost, whole: MeasuredCost) -> tuple[str, ...]:
    if cost.outcome != Outcome.FINISHED:
        return (cost.solver, cost.reduction, cost.outcome, "", "", "", "")
    times = (*map(seconds, _two(cost)), _share(cost, whole), seconds(min(cost.stepping)))
    return (cost.solver, cost.reduction, *times, str(cost.steps))


def _query_table(costs: Sequence[MeasuredCost]) -> ReportTable:
    first = costs[0]
    lead = (
        f"Time of the closed form of {first.mechanism} ({first.variant}) per crank angle, {PATHS[first.solver]}: least "
        f"and median of {len(first.seconds)} evaluations at {first.angles} angles of every question put in turn, and "
        "the least over that of the first."
    )
    note = f"{first.reduction}: {first.about}."
    return ReportTable(lead, ANGLES, tuple(_query_row(cost, first) for cost in costs), "lr", note)


def _query_row(cost: MeasuredCost, whole: MeasuredCost) -> tuple[str, ...]:
    each = (f"{figure(spent / cost.angles * 1e9, 3)} ns" for spent in _two(cost))
    return (cost.reduction, *each, _share(cost, whole))


def _two(cost: MeasuredCost) -> tuple[float, float]:
    return min(cost.seconds), statistics.median(cost.seconds)


def _share(cost: MeasuredCost, whole: MeasuredCost) -> str:
    return f"{100.0 * min(cost.seconds) / min(whole.seconds):.0f} %"


def section(costs: Sequence[MeasuredCost]) -> Markup:
    """The section's HTML, heading and tables, as the page has it."""
    return render("tables_section.html", title=TITLE, about=ABOUT, tables=cost_tables(costs))
