"""The cost of a whole scene beside those of scenes with less in them."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from comparisons.work_precision.records import MeasuredCost
from engines.contract import Outcome
from reports.document.numbers import seconds
from reports.document.parts import Paragraph, Section, Table, TableCell
from reports.document.templates import sentence
from reports.work_precision.words import engine_label


def cost_section(costs: Sequence[MeasuredCost]) -> Section:
    """The section of a page."""
    return Section("costs", "What each output and load costs", (Paragraph(sentence("bench_costs")), cost_table(costs)))


def cost_table(costs: Sequence[MeasuredCost]) -> Table:
    """Least times, with their shares of the whole scene's: scenes down, engines across, the control last."""
    ordered = sorted(costs, key=lambda cost: cost.is_control)
    solvers, scenes = dict.fromkeys(map(_label, ordered)), dict.fromkeys(cost.reduction for cost in costs)
    whole = {_label(cost): min(cost.seconds) for cost in costs if cost.reduction == next(iter(scenes))}
    cells = {(cost.reduction, _label(cost)): _cell(cost, whole[_label(cost)]) for cost in costs}
    rows = tuple((scene, *(cells.get((scene, name), "") for name in solvers)) for scene in scenes)
    notes = sentence("cost_notes", costs=costs)
    return Table(sentence("cost_of_runs", first=costs[0]), ("scene", *solvers), rows, "lr", notes)


def _label(cost: MeasuredCost) -> str:
    return engine_label(cost.solver, cost.is_control)


def _cell(cost: MeasuredCost, whole: float) -> TableCell:
    if cost.outcome != Outcome.FINISHED:
        return TableCell(cost.outcome, "failed", tooltip=cost.reason)
    least, median = min(cost.seconds), statistics.median(cost.seconds)
    more = f"median {seconds(median)}; stepping {seconds(min(cost.stepping, default=0.0))}, {cost.steps} steps"
    return TableCell(f"{seconds(least)} ({100.0 * least / whole:.0f} %)", tooltip=more)
