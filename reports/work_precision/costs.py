"""The cost of a whole scene beside those of scenes with less in them."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from itertools import groupby

from comparisons.work_precision.records import MeasuredCost
from engines.contract import Outcome
from reports.document.numbers import figure, seconds
from reports.document.parts import Paragraph, Section, Table, TableCell
from reports.document.templates import sentence
from reports.work_precision.words import engine_label

RUNS = ("engine", "scene", "least", "median", "of whole", "stepping", "steps")
ANGLES = ("requested", "least", "median", "of whole")
PATHS = {"numpy": "by NumPy", "compiled": "by the compiled path"}


def cost_tables(costs: Sequence[MeasuredCost]) -> tuple[Table, ...]:
    """One table for the engines, then one for the closed form by each path, as measured: for a terminal."""
    tables = [_run_table(runs)] if (runs := _runs(costs)) else []
    for _, queries in groupby((cost for cost in costs if cost.angles), key=lambda cost: cost.solver):
        tables.append(_query_table(list(queries)))
    return tuple(tables)


def _runs(costs: Sequence[MeasuredCost]) -> list[MeasuredCost]:
    """Runs of engines, the control's last."""
    return sorted((cost for cost in costs if not cost.angles), key=lambda cost: cost.is_control)


def _label(cost: MeasuredCost) -> str:
    return PATHS.get(cost.solver) or engine_label(cost.solver, cost.is_control)


def _run_table(costs: Sequence[MeasuredCost]) -> Table:
    rows = tuple(
        (_label(cost), cost.reduction, *_times(cost, costs), seconds(min(cost.stepping, default=0.0)), str(cost.steps))
        if cost.outcome == Outcome.FINISHED
        else (_label(cost), cost.reduction, cost.outcome, "", "", "", "")
        for cost in costs
    )
    return Table(sentence("cost_of_runs", first=costs[0]), RUNS, rows, "llr", sentence("cost_notes", costs=costs))


def _query_table(costs: Sequence[MeasuredCost]) -> Table:
    rows = tuple((cost.reduction, *_times(cost, costs)) for cost in costs)
    return Table(_lead(costs), ANGLES, rows, "lr", sentence("cost_notes", costs=costs[:1]))


def _lead(costs: Sequence[MeasuredCost]) -> str:
    return sentence("cost_of_queries", costs=costs, path=" and ".join(dict.fromkeys(map(_label, costs))))


def _times(cost: MeasuredCost, costs: Sequence[MeasuredCost]) -> tuple[str, str, str]:
    """Least and median, of an evaluation per crank angle, and the share of the whole, its solver's first."""
    whole = next(one for one in costs if one.solver == cost.solver)
    least, median = (
        f"{figure(one / cost.angles * 1e9, 3)} ns" if cost.angles else seconds(one)
        for one in (min(cost.seconds), statistics.median(cost.seconds))
    )
    return least, median, f"{100.0 * min(cost.seconds) / min(whole.seconds):.0f} %"


def cost_section(costs: Sequence[MeasuredCost]) -> Section:
    """The section of a page: scenes and queries down, engines and paths across."""
    tables = []
    if runs := _runs(costs):
        tables.append(_across("scene", sentence("cost_of_runs", first=runs[0]), runs, runs))
    if queries := [cost for cost in costs if cost.angles]:
        tables.append(_across("requested", _lead(queries), queries, queries[:1]))
    return Section("costs", "What each output and load costs", (Paragraph(sentence("bench_costs")), *tables))


def _across(corner: str, lead: str, costs: Sequence[MeasuredCost], noted: Sequence[MeasuredCost]) -> Table:
    """Least times with their share of the whole."""
    solvers, scenes = dict.fromkeys(map(_label, costs)), dict.fromkeys(cost.reduction for cost in costs)
    cells = {(cost.reduction, _label(cost)): _cell(cost, costs) for cost in costs}
    rows = tuple((scene, *(cells.get((scene, name), "") for name in solvers)) for scene in scenes)
    return Table(lead, (corner, *solvers), rows, "lr", sentence("cost_notes", costs=noted))


def _cell(cost: MeasuredCost, costs: Sequence[MeasuredCost]) -> TableCell:
    if cost.outcome != Outcome.FINISHED:
        return TableCell(cost.outcome, "failed", told=cost.reason)
    least, median, share = _times(cost, costs)
    return TableCell(least, note=share, told=f"median {median}")
