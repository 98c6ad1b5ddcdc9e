"""Orders, steps, choices and standings of a benchmark in words."""

from __future__ import annotations

from collections.abc import Iterable

from markupsafe import Markup

from comparisons.work_precision.analysis import PointChoice, Standing, SweepFinding
from comparisons.work_precision.records import Bench, BenchRecord
from comparisons.work_precision.step_sweep import SATURATED
from engines.contract import Setting
from reports.document.numbers import ABSENT, error, figure, seconds
from reports.document.tables import ReportTable
from reports.document.templates import sentence
from reports.work_precision.facts import EngineFacts, effort_words, engine_labels

# Of points that are no extrapolation, and of those that are one.
KINDS = ("1 run", "several runs extrapolated")


def standing_words(facts: EngineFacts, noise: float) -> list[str]:
    """How far off the methods' front each setting is; what the machine's noise, a share, may explain is on it.

    ``best`` is held against all methods, the others against those of a single run.
    """
    return [f"{facts.engine} {one.record.setting}: {_standing(one, facts, noise)}" for one in facts.standings]


def _standing(standing: Standing, facts: EngineFacts, noise: float) -> str:
    record, ratio = standing.record, standing.ratio
    told = f"{error(record.error_max)} in {seconds(record.seconds_min or 0.0)}"
    if (record.error_max or 0.0) > SATURATED:
        return f"{told}: no solution"
    against_all = record.setting == Setting.BEST
    if ratio is None or standing.rival is None or standing.rival_seconds is None:
        return f"{told}; no {'method' if against_all else 'single run'} measured gets there"
    front = "the front" if against_all else "the front of single runs"
    beside = f"{facts.way(standing.rival)} takes {seconds(standing.rival_seconds)} to the same error"
    if ratio <= 1.0 / (1.0 + noise):
        return f"{told}; ahead of {front}: {beside}, {figure(1.0 / ratio, 2)} × as long"
    place = "on" if ratio <= 1.0 + noise else f"{figure(ratio, 2)} ×"
    return f"{told}; {place} {front}: {beside}"


def choice_words(choice: PointChoice, facts: EngineFacts) -> tuple[str, str, str, str]:
    """What to use for an error: its cost, its way, its steps a turn, and all else that is known of it.

    Where nothing gets there, the cost is empty and the way says what comes nearest.
    """
    record = choice.record or choice.closest
    reached, way, step = f"{error(record.error_max)}", facts.way(record), _per_turn(record)
    if choice.record is None:
        steps = f" {step} steps a turn" if step else ""
        return "", f"least {reached}", "", f"not reached; least {reached} by {way}{steps}"
    rms = record.error.error_rms if record.error else None
    set_up, read_out = seconds(record.setup_seconds or 0.0), seconds(record.readout_seconds or 0.0)
    told = f"{reached} (RMS {error(rms)}) in {record.steps} steps, set-up {set_up}, read-out {read_out}"
    return seconds(record.seconds_min or 0.0), way, step, told


def _per_turn(record: BenchRecord) -> str:
    """Steps a turn; nothing for a setting, whose adapter fixes them."""
    return "" if record.steps_per_turn is None else f"{record.steps_per_turn:.0f}"


def method_row(facts: EngineFacts, sweep: SweepFinding) -> tuple[str, ...]:
    """A method's order, its floor with the step and the time there, and what limits it."""
    least = sweep.points.records[sweep.points.numbers.best]
    order = ABSENT if sweep.order is None else f"{sweep.order:.1f}"
    floor, cost = error(sweep.floor.error), seconds(least.seconds_min or 0.0)
    return facts.label, facts.way(sweep.first), order, floor, _per_turn(least), cost, sweep.floor.cause.value


def floor_table(engines: Iterable[EngineFacts], caption: str) -> ReportTable:
    """Order, floor and cause of every method at every effort, for a page."""
    rows = tuple(
        (*cells, _with_note(cause, sweep.floor.evidence))
        for facts in engines
        for sweep in facts.sweeps
        for *cells, cause in [method_row(facts, sweep)]
    )
    head = ("Engine", "Method", "Order", "Floor", "at steps a turn", "in", "What limits the error")
    return ReportTable(caption, head, rows, align="llrrrrl")


def _with_note(words: str, note: str) -> str:
    return Markup('{}<small class="note">{}</small>').format(words, note) if note else words


def method_table(bench: Bench) -> ReportTable:
    """Engine, method, what it is, of how many runs, and the solver effort it comes with."""
    labels = engine_labels(bench)
    rows = tuple(
        (labels[told["engine"]], told["name"], told["about"], f"{told['runs']}",
         effort_words(told["effort"], told["effort_unit"]))
        for told in bench.document["methods"]
    )  # fmt: skip
    caption = (
        "What an engine offers for study, each taking the step it is asked for; several runs, at fractions of that "
        "step, are extrapolated. The steps per turn of a setting are fixed numbers in the adapter."
    )
    return ReportTable(caption, ("Engine", "Method", "What it is", "Runs", "Solver effort"), rows, align="lllrl")


# Times closer than this are the same time, however quiet the machine.
LEAST_NOISE = 0.05


def noise_share(bench: Bench) -> float:
    """The share by which two times of one thing may differ here."""
    return max(LEAST_NOISE, bench.noise.median_excess)


def noise_note(bench: Bench) -> str:
    """How the times were measured, in small print."""
    return sentence("machine_noise", noise=bench.noise, repeats=bench.document["extent"]["repeats"])
