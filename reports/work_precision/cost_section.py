"""The cost of a whole scene beside those of scenes with less in them: for the page and the terminal."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from itertools import groupby

from markupsafe import Markup

from comparisons.work_precision.records import MeasuredCost
from engines.contract import Outcome
from reports.document.numbers import figure, seconds
from reports.document.tables import ReportTable
from reports.document.templates import render, sentence
from reports.work_precision.facts import engine_label

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
    costs = sorted(costs, key=lambda cost: cost.is_control)
    whole = {cost.solver: cost for cost in reversed(costs)}
    told = dict.fromkeys(f"{cost.reduction}: {cost.about}" for cost in costs)
    failed = dict.fromkeys(f" {cost.solver}, {cost.reduction}: {cost.reason}." for cost in costs if cost.reason)
    note = f"{'; '.join(told)}.{''.join(failed)}"
    rows = tuple(_run_row(cost, whole[cost.solver]) for cost in costs)
    return ReportTable(sentence("cost_of_runs", first=costs[0]), RUNS, rows, "llr", note)


def _run_row(cost: MeasuredCost, whole: MeasuredCost) -> tuple[str, ...]:
    name = engine_label(cost.solver, cost.is_control)
    if cost.outcome != Outcome.FINISHED:
        return (name, cost.reduction, cost.outcome, "", "", "", "")
    return (name, cost.reduction, *_times(cost, whole), seconds(min(cost.stepping)), str(cost.steps))


def _query_table(costs: Sequence[MeasuredCost]) -> ReportTable:
    first = costs[0]
    lead = sentence("cost_of_queries", first=first, path=PATHS[first.solver])
    rows = tuple((cost.reduction, *_times(cost, first)) for cost in costs)
    return ReportTable(lead, ANGLES, rows, "lr", f"{first.reduction}: {first.about}.")


def _times(cost: MeasuredCost, whole: MeasuredCost) -> tuple[str, ...]:
    """Least and median, of an evaluation per crank angle, and the share of the whole."""
    least, median = min(cost.seconds), statistics.median(cost.seconds)
    words = (f"{figure(one / cost.angles * 1e9, 3)} ns" if cost.angles else seconds(one) for one in (least, median))
    return (*words, f"{100.0 * least / min(whole.seconds):.0f} %")


def section(costs: Sequence[MeasuredCost]) -> Markup:
    """The section's HTML, heading and tables, as the page has it."""
    return render("study_section.html", title=TITLE, about=ABOUT, tables=cost_tables(costs))
