"""The cost of a whole scene beside those of scenes with less in them."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from itertools import groupby

from comparisons.work_precision.records import MeasuredCost
from engines.contract import Outcome
from reports.document.numbers import figure, seconds
from reports.document.parts import Cell, Paragraph, Section, Table, Words
from reports.document.templates import sentence
from reports.work_precision.words import engine_label

TITLE = "What each output and load costs"
ABOUT = (
    "Nothing is built, recorded or worked out that a scene does not need, and the suite's tests count it. Here is what "
    "that is worth: whole scenes beside the same scenes with less in them."
)
RUNS = ("engine", "scene", "least", "median", "of whole", "stepping", "steps")
PATHS = {"numpy": "by NumPy", "compiled": "by the compiled path"}
ANGLES = ("asked for", "least", "median", "of whole")


def cost_tables(costs: Sequence[MeasuredCost]) -> tuple[Table, ...]:
    """One table for the engines, then one for the closed form by each path, as measured: for a terminal."""
    runs, queries = _apart(costs)
    tables = groupby(queries, key=lambda cost: cost.solver)
    return (*([_run_table(runs)] if runs else []), *(_query_table(list(part)) for _, part in tables))


def _apart(costs: Sequence[MeasuredCost]) -> tuple[list[MeasuredCost], list[MeasuredCost]]:
    """Runs of engines, the control's last, and queries of the closed form."""
    runs = sorted((cost for cost in costs if not cost.angles), key=lambda cost: cost.is_control)
    return runs, [cost for cost in costs if cost.angles]


def _run_table(costs: Sequence[MeasuredCost]) -> Table:
    whole = _wholes(costs)
    rows = tuple(_run_row(cost, whole[cost.solver]) for cost in costs)
    return Table(sentence("cost_of_runs", first=costs[0]), RUNS, rows, "llr", _run_note(costs))


def _wholes(costs: Sequence[MeasuredCost]) -> dict[str, MeasuredCost]:
    """The whole scene, or all queries, of every solver: the first of its rows."""
    found: dict[str, MeasuredCost] = {}
    for cost in costs:
        found.setdefault(cost.solver, cost)
    return found


def _run_note(costs: Sequence[MeasuredCost]) -> str:
    told = dict.fromkeys(f"{cost.reduction}: {cost.about}" for cost in costs)
    failed = dict.fromkeys(f" {cost.solver}, {cost.reduction}: {cost.reason}." for cost in costs if cost.reason)
    return f"{'; '.join(told)}.{''.join(failed)}"


def _run_row(cost: MeasuredCost, whole: MeasuredCost) -> tuple[str, ...]:
    name = engine_label(cost.solver, cost.is_control)
    if cost.outcome != Outcome.FINISHED:
        return (name, cost.reduction, cost.outcome, "", "", "", "")
    return (name, cost.reduction, *_times(cost, whole), seconds(min(cost.stepping, default=0.0)), str(cost.steps))


def _query_table(costs: Sequence[MeasuredCost]) -> Table:
    first = costs[0]
    lead = sentence("cost_of_queries", first=first, path=PATHS.get(first.solver, first.solver))
    rows = tuple((cost.reduction, *_times(cost, first)) for cost in costs)
    return Table(lead, ANGLES, rows, "lr", f"{first.reduction}: {first.about}.")


def _times(cost: MeasuredCost, whole: MeasuredCost) -> tuple[str, ...]:
    """Least and median, of an evaluation per crank angle, and the share of the whole."""
    least, median = min(cost.seconds), statistics.median(cost.seconds)
    words = (f"{figure(one / cost.angles * 1e9, 3)} ns" if cost.angles else seconds(one) for one in (least, median))
    return (*words, f"{100.0 * least / min(whole.seconds):.0f} %")


def cost_section(costs: Sequence[MeasuredCost]) -> Section:
    """The section of a page: scenes and queries down, engines and paths across."""
    tables = []
    runs, queries = _apart(costs)
    if runs:
        tables.append(_across("scene", runs, sentence("cost_of_runs", first=runs[0]), _run_note(runs)))
    if queries:
        paths = " and ".join(PATHS.get(name, name) for name in _wholes(queries))
        angles = " and ".join(str(cost.angles) for cost in _wholes(queries).values())
        lead = sentence("cost_of_queries", first=queries[0], path=paths, angles=angles)
        tables.append(_across("asked for", queries, lead, f"{queries[0].reduction}: {queries[0].about}."))
    return Section("costs", TITLE, (Paragraph(ABOUT), *tables))


def _across(corner: str, costs: Sequence[MeasuredCost], caption: str, note: str) -> Table:
    wholes = _wholes(costs)
    rows: dict[str, dict[str, Cell | Words]] = {}
    for cost in costs:
        rows.setdefault(cost.reduction, {})[cost.solver] = _cell(cost, wholes[cost.solver])
    filled = tuple((reduction, *(cells.get(name, "") for name in wholes)) for reduction, cells in rows.items())
    labels = (PATHS.get(name) or engine_label(name, cost.is_control) for name, cost in wholes.items())
    return Table(caption, (corner, *labels), filled, "lr", note)


def _cell(cost: MeasuredCost, whole: MeasuredCost) -> Cell:
    """The least time and its share of the whole."""
    if cost.outcome != Outcome.FINISHED:
        return Cell(cost.outcome, "failed", told=cost.reason)
    least, median, share = _times(cost, whole)
    return Cell(least, note=share, told=f"median {median}")
