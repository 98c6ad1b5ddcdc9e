"""Orders, steps, choices and standings of a benchmark in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from markupsafe import Markup

from comparisons.work_precision.analysis import PointChoice, Standing, SweepFinding
from comparisons.work_precision.records import Bench, BenchRecord
from comparisons.work_precision.step_sweep import SATURATED
from reports.text.numbers import ABSENT, error, figure, seconds
from reports.text.tables import ReportTable
from reports.work_precision.facts import EngineFacts, effort_words


def step_words(record: BenchRecord) -> str:
    """The step of a point: "96 steps a turn"; nothing for a setting, which finds its own."""
    return "" if record.steps_per_turn is None else f"{record.steps_per_turn:.0f} steps a turn"


def standing_words(standing: Standing, way: str, noise: float) -> str:
    """How far off the methods' front a setting is; what the machine's noise may explain is said to be on it.

    ``way`` is the rival's, ``noise`` a share.
    """
    record, ratio = standing.record, standing.ratio
    told = f"{record.setting}: {error(record.error_max)} in {seconds(record.seconds_min or 0.0)}"
    if (record.error_max or 0.0) > SATURATED:
        return f"{told}: no solution"
    if ratio is None or standing.rival is None or standing.rival_seconds is None:
        return f"{told}; no method measured gets there"
    beside = f"{way} takes {seconds(standing.rival_seconds)} to the same error"
    if ratio <= 1.0 / (1.0 + noise):
        return f"{told}; ahead of the front: {beside}, {figure(1.0 / ratio, 2)} × as long"
    if ratio <= 1.0 + noise:
        return f"{told}; on the front: {beside}"
    return f"{told}; {figure(ratio, 2)} × the front: {beside}"


@dataclass(frozen=True)
class ChoiceCell:
    """What to use for an error: the way, its step and cost; ``reached`` false where nothing gets there."""

    reached: bool
    way: str
    step: str
    cost: str
    title: str


def choice_cell(choice: PointChoice, facts: EngineFacts) -> ChoiceCell:
    """A choice in words."""
    record = choice.record
    if record is None:
        least = choice.closest
        words = f"not reached; least {error(least.error_max)} by {facts.way(least)} {step_words(least)}".strip()
        return ChoiceCell(False, f"least {error(least.error_max)}", "", "", words)
    rms = record.error.error_rms if record.error else None
    told = (
        f"{error(record.error_max)} (RMS {error(rms)}) in {record.steps} steps, set-up "
        f"{seconds(record.setup_seconds or 0.0)}, read-out {seconds(record.readout_seconds or 0.0)}"
    )
    per_turn = "" if record.steps_per_turn is None else f"{record.steps_per_turn:.0f}"
    return ChoiceCell(True, facts.way(record), per_turn, seconds(record.seconds_min or 0.0), told)


def order_words(order: float | None) -> str:
    """An observed order to one decimal."""
    return ABSENT if order is None else f"{order:.1f}"


@dataclass(frozen=True)
class MethodRow:
    """One method in one quantity: order, floor and cause."""

    engine: str
    way: str
    order: str
    floor: str
    step: str
    cost: str
    cause: str
    evidence: str


def method_row(facts: EngineFacts, sweep: SweepFinding) -> MethodRow:
    """A method's order and floor in words."""
    least = sweep.points.records[sweep.points.numbers.best]
    return MethodRow(
        engine=facts.engine,
        way=facts.way(sweep.first),
        order=order_words(sweep.order),
        floor=error(sweep.floor.error),
        step=f"{least.steps_per_turn:.0f}" if least.steps_per_turn else "",
        cost=seconds(least.seconds_min or 0.0),
        cause=sweep.floor.cause.value,
        evidence=sweep.floor.evidence,
    )


def floor_table(engines: Iterable[EngineFacts], caption: str) -> ReportTable:
    """Order, floor and cause of every method at every effort, for a page."""
    rows = [method_row(facts, sweep) for facts in engines for sweep in facts.sweeps]
    cells = tuple(
        (row.engine, row.way, row.order, row.floor, row.step, row.cost, _with_note(row.cause, row.evidence))
        for row in rows
    )
    head = ("Engine", "Method", "Order", "Floor", "at steps a turn", "in", "What limits the error")
    return ReportTable(caption, head, cells, align="llrrrrl")


def _with_note(words: str, note: str) -> str:
    return Markup('{}<small class="note">{}</small>').format(words, note) if note else words


def method_table(bench: Bench) -> ReportTable:
    """Engine, method, what it is, and the solver effort it comes with."""
    rows = tuple(
        (told["engine"], told["name"], told["about"], effort_words(told["effort"], told["effort_unit"]))
        for told in bench.document["methods"]
    )
    caption = (
        "What an engine offers for study, each taking the step it is asked for; the settings are made of these and "
        "find their steps themselves."
    )
    return ReportTable(caption, ("Engine", "Method", "What it is", "Solver effort"), rows, align="l")


# Times closer than this are the same time, however quiet the machine.
LEAST_NOISE = 0.05


def noise_share(bench: Bench) -> float:
    """The share by which two times of one thing may differ here."""
    return max(LEAST_NOISE, bench.noise.median_excess)
